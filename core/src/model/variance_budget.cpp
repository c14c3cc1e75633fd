#include "model/variance_budget.hpp"

#include <algorithm>

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
    entries_.push_back({scalar, control.variable});
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
    if (!entry.started) entry.centre = sums_about(store, entry.scalar, 0).first / domain_volume_;
    values.insert(values.end(), {variance(store, entry), entry.lost[0], entry.lost[1]});
  }
  return values;
}

void VarianceBudget::book(const parcels::Store& store, Sink sink) {
  for (Entry& entry : entries_) {
    if (!entry.started) entry.centre = sums_about(store, entry.scalar, 0).first / domain_volume_;
    const double now = variance(store, entry);
    if (entry.started) entry.lost[static_cast<int>(sink)] += entry.last - now;
    entry.last = now;
    entry.started = true;
  }
}

bool VarianceBudget::started() const {
  return std::all_of(entries_.begin(), entries_.end(), [](const Entry& e) { return e.started; });
}

void VarianceBudget::save(output::NamedData& data) const {
  for (const Entry& e : entries_)
    if (e.started)
      data.arrays["variance_budget/" + e.name] = {e.centre, e.last, e.lost[0], e.lost[1]};
}

/// A quantity that was not looked at before begins here.
void VarianceBudget::restore(const output::NamedData& data) {
  for (Entry& e : entries_) {
    const auto found = data.arrays.find("variance_budget/" + e.name);
    if (found == data.arrays.end() || found->second.size() != 4) continue;
    e.centre = found->second[0];
    e.last = found->second[1];
    e.lost[0] = found->second[2];
    e.lost[1] = found->second[3];
    e.started = true;
  }
}

}  // namespace pileus::model
