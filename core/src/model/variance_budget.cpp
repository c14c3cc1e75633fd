#include "model/variance_budget.hpp"

#include <fmt/format.h>

#include "base/error.hpp"
#include "base/parallel.hpp"

namespace pileus::model {
namespace {

/// Σ V x and Σ V x² of x = φ − centre.
struct Sums {
  double first = 0, second = 0;
};

Sums sums_about(const parcels::Store& store, int scalar, double centre) {
  const double *value = store.scalar(scalar), *volume = store.volume();
  return ordered_reduce(
      store.size(), Sums{},
      [&](std::size_t begin, std::size_t end) {
        Sums s;
        for (std::size_t p = begin; p < end; ++p) {
          const double x = value[p] - centre;
          s.first += volume[p] * x;
          s.second += volume[p] * x * x;
        }
        return s;
      },
      [](const Sums& a, const Sums& b) {
        return Sums{a.first + b.first, a.second + b.second};
      });
}

}  // namespace

VarianceBudget::VarianceBudget(const std::vector<scene::VarianceBudgetControl>& quantities,
                               const parcels::Store& store, double domain_volume)
    : domain_volume_(domain_volume) {
  for (const scene::VarianceBudgetControl& control : quantities) {
    const int scalar = store.find_scalar(control.variable);
    if (scalar < 0 ||
        store.scalars()[static_cast<std::size_t>(scalar)].nature != parcels::Nature::intensive)
      throw Error(ExitCode::usage,
                  fmt::format("{}:{}: error: variance budget: parcels carry no '{}' per volume in "
                              "this run.",
                              control.where.file, control.where.line, control.variable));
    entries_.push_back({scalar});
    const std::string& units = store.scalars()[static_cast<std::size_t>(scalar)].units;
    const std::string squared = units == "1" ? "1" : fmt::format("({})2", units);
    const std::string name = control.variable + "_variance";
    outputs_.push_back({name, squared, "variance over the domain"});
    outputs_.push_back({name + "_lost_to_operators", squared,
                        "variance that operators have mixed away since the start"});
    outputs_.push_back(
        {name + "_lost_to_mergers", squared, "variance lost in merging since the start"});
  }
}

std::vector<std::array<std::string, 3>> VarianceBudget::outputs() const {
  return outputs_;
}

double VarianceBudget::variance(const parcels::Store& store, const Entry& entry) const {
  const Sums sums = sums_about(store, entry.scalar, entry.centre);
  const double mean = sums.first / domain_volume_;
  return sums.second / domain_volume_ - mean * mean;
}

std::vector<double> VarianceBudget::measure(const parcels::Store& store) const {
  std::vector<double> values;
  for (Entry entry : entries_) {
    if (!started_) entry.centre = sums_about(store, entry.scalar, 0).first / domain_volume_;
    values.insert(values.end(), {variance(store, entry), entry.lost[0], entry.lost[1]});
  }
  return values;
}

void VarianceBudget::book(const parcels::Store& store, Sink sink) {
  for (Entry& entry : entries_) {
    if (!started_) entry.centre = sums_about(store, entry.scalar, 0).first / domain_volume_;
    const double now = variance(store, entry);
    if (started_) entry.lost[static_cast<int>(sink)] += entry.last - now;
    entry.last = now;
  }
  started_ = true;
}

void VarianceBudget::save(output::NamedData& data) const {
  if (!started_ || entries_.empty()) return;
  std::vector<double>& saved = data.arrays["variance_budget"];
  saved.clear();
  for (const Entry& e : entries_)
    saved.insert(saved.end(), {e.centre, e.last, e.lost[0], e.lost[1]});
}

void VarianceBudget::restore(const output::NamedData& data) {
  const auto found = data.arrays.find("variance_budget");
  if (found == data.arrays.end() || found->second.size() != 4 * entries_.size()) return;
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const double* saved = found->second.data() + 4 * i;
    entries_[i].centre = saved[0];
    entries_[i].last = saved[1];
    entries_[i].lost[0] = saved[2];
    entries_[i].lost[1] = saved[3];
  }
  started_ = true;
}

}  // namespace pileus::model
