#include "model/record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>

#include "base/error.hpp"
#include "base/nearest_word.hpp"

namespace pileus::model {

void Record::append(double time, const std::vector<double>& values) {
  times_.push_back(time);
  for (std::size_t i = 0; i < series_.size(); ++i) series_[i].push_back(values[i]);
}

double Record::at(std::size_t diagnostic, double time) const {
  const std::vector<double>& values = series_[diagnostic];
  const auto after = std::upper_bound(times_.begin(), times_.end(), time);
  if (after == times_.begin()) return values.front();
  if (after == times_.end()) return values.back();
  const auto i = static_cast<std::size_t>(after - times_.begin());
  const double fraction = (time - times_[i - 1]) / (times_[i] - times_[i - 1]);
  return values[i - 1] + fraction * (values[i] - values[i - 1]);
}

const std::vector<std::string>& known_statistics() {
  static const std::vector<std::string> words = {"initial",
                                                 "final",
                                                 "min",
                                                 "max",
                                                 "mean",
                                                 "relative_change",
                                                 "relative_rise",
                                                 "growth_rate",
                                                 "first_time_above",
                                                 "mean_deviation",
                                                 "first_value"};
  return words;
}

namespace {

/// Mean of what there is: a measure without a value at a time is not a number there.
double mean_of(std::span<const double> values) {
  double sum = 0;
  std::size_t count = 0;
  for (const double v : values) {
    if (std::isnan(v)) continue;
    sum += v;
    ++count;
  }
  return sum / static_cast<double>(count);
}

/// ⟨|1 − v/⟨v⟩|⟩, the measure of Frey et al. (2023) for what an invariant does over a run.
double mean_deviation(std::span<const double> values) {
  const double mean = mean_of(values);
  double sum = 0;
  for (const double v : values) sum += std::abs(1 - v / mean);
  return sum / static_cast<double>(values.size());
}

double first_number(std::span<const double> values) {
  const auto found =
      std::find_if(values.begin(), values.end(), [](double value) { return !std::isnan(value); });
  return found != values.end() ? *found : std::nan("");
}

double smallest(std::span<const double> values) {
  double low = first_number(values);
  for (const double v : values)
    if (v < low) low = v;
  return low;
}

double largest(std::span<const double> values) {
  double high = first_number(values);
  for (const double v : values)
    if (v > high) high = v;
  return high;
}

std::optional<double> growth_rate(std::span<const double> times, std::span<const double> values) {
  if (times.size() < 3) return std::nullopt;
  double mean_time = 0, mean_log = 0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (values[i] == 0) return std::nullopt;
    mean_time += times[i];
    mean_log += std::log(std::abs(values[i]));
  }
  const auto n = static_cast<double>(times.size());
  mean_time /= n;
  mean_log /= n;
  double covariance = 0, variance = 0;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double t = times[i] - mean_time;
    covariance += t * (std::log(std::abs(values[i])) - mean_log);
    variance += t * t;
  }
  if (!(variance > 0)) return std::nullopt;
  return covariance / variance;
}

}  // namespace

std::optional<double> Record::statistic(std::size_t diagnostic, const std::string& name,
                                        std::optional<double> time,
                                        std::optional<double> from) const {
  if (times_.empty()) return std::nullopt;
  const std::vector<double>& values = series_[diagnostic];
  const double end = time ? at(diagnostic, *time) : values.back();
  const auto last = time ? std::upper_bound(times_.begin(), times_.end(), *time) : times_.end();
  const auto first = from ? std::lower_bound(times_.begin(), times_.end(), *from) : times_.begin();
  const auto skipped = first - times_.begin();
  const auto count = std::max<std::ptrdiff_t>(from ? 0 : 1, last - first);
  if (count == 0) return std::nullopt;
  const auto begin = values.begin() + skipped, stop = begin + count;
  if (name == "initial") return *begin;
  if (name == "final") return end;
  if (name == "min") return smallest({begin, stop});
  if (name == "max") return largest({begin, stop});
  if (name == "first_value") {
    const double first_value = first_number({begin, stop});
    return std::isnan(first_value) ? std::nullopt : std::optional(first_value);
  }
  if (name == "mean") return mean_of({begin, stop});
  if (name == "mean_deviation") return mean_deviation({begin, stop});
  if (name == "relative_change")  // nothing that stays nothing has not changed
    return end == *begin ? 0.0 : (end - *begin) / std::abs(*begin);
  if (name == "relative_rise") return (largest({begin, stop}) - *begin) / std::abs(*begin);
  if (name == "growth_rate") {
    const auto at = static_cast<std::size_t>(skipped), n = static_cast<std::size_t>(count);
    return growth_rate(std::span(times_).subspan(at, n), std::span(values).subspan(at, n));
  }
  if (name == "first_time_above") {
    // Time at which the series first exceeds zero: when a first cloud appears.
    for (auto v = begin; v != stop; ++v)
      if (*v > 0) return times_[static_cast<std::size_t>(v - values.begin())];
    return std::nullopt;
  }
  return std::nullopt;
}

std::vector<output::DiagnosticSummary> Record::summarise() const {
  std::vector<output::DiagnosticSummary> result;
  for (std::size_t i = 0; i < list_.size(); ++i) {
    output::DiagnosticSummary d;
    d.name = list_[i].name;
    d.units = list_[i].units;
    if (!times_.empty()) {
      d.initial = *statistic(i, "initial", {});
      d.final = *statistic(i, "final", {});
      d.min = *statistic(i, "min", {});
      d.max = *statistic(i, "max", {});
      d.mean = *statistic(i, "mean", {});
      if (list_[i].conserved) d.relative_change = statistic(i, "relative_change", {});
    }
    result.push_back(std::move(d));
  }
  return result;
}

void Record::save(output::NamedData& data) const {
  data.arrays["record/times"] = times_;
  for (std::size_t i = 0; i < list_.size(); ++i)
    data.arrays["record/" + list_[i].name] = series_[i];
}

void Record::restore(const output::NamedData& data, double time) {
  times_ = data.arrays.at("record/times");
  const std::size_t saved = times_.size();
  times_.erase(std::lower_bound(times_.begin(), times_.end(), time), times_.end());
  for (std::size_t i = 0; i < list_.size(); ++i) {
    const auto stored = data.arrays.find("record/" + list_[i].name);
    // A diagnostic that is new since the checkpoint has no past.
    series_[i] =
        stored != data.arrays.end() ? stored->second : std::vector<double>(saved, std::nan(""));
    series_[i].resize(times_.size());
  }
}

std::vector<output::ExpectSummary> judge(const std::vector<scene::Expectation>& expect,
                                         const Record& record) {
  std::vector<output::ExpectSummary> results;
  for (const scene::Expectation& e : expect) {
    output::ExpectSummary r;
    r.diagnostic = e.diagnostic;
    r.statistic = e.statistic;
    r.at = e.at;
    r.from = e.from;
    r.low = e.low;
    r.high = e.high;
    r.source = e.source;
    const auto& list = record.list();
    const auto found = std::find_if(
        list.begin(), list.end(), [&](const DiagnosticInfo& d) { return d.name == e.diagnostic; });
    if (found != list.end()) {
      const auto value = record.statistic(static_cast<std::size_t>(found - list.begin()),
                                          e.statistic, e.at, e.from);
      if (value) r.value = *value;
    }
    // Comparisons with a value that is not available are false: nothing unmeasured passes.
    r.passed = !std::isnan(r.value) && !(e.low && !(r.value >= *e.low)) &&
               !(e.high && !(r.value <= *e.high));
    results.push_back(std::move(r));
  }
  return results;
}

void check_expectations(const std::vector<scene::Expectation>& expect,
                        const std::vector<DiagnosticInfo>& list) {
  std::vector<std::string> names;
  for (const DiagnosticInfo& d : list) names.push_back(d.name);
  std::string errors;
  const auto complain = [&](const scene::Expectation& e, const std::string& what,
                            const std::string& word, const std::vector<std::string>& valid) {
    const std::string nearest = nearest_word(word, valid);
    errors += fmt::format("{}:{}:{}: error: this run has no {} '{}'; {}.\n", e.where.file,
                          e.where.line, e.where.column, what, word,
                          nearest.empty() ? fmt::format("it has {}", fmt::join(valid, ", "))
                                          : fmt::format("did you mean '{}'?", nearest));
  };
  for (const scene::Expectation& e : expect) {
    if (std::find(names.begin(), names.end(), e.diagnostic) == names.end())
      complain(e, "diagnostic", e.diagnostic, names);
    const auto& statistics = known_statistics();
    if (std::find(statistics.begin(), statistics.end(), e.statistic) == statistics.end())
      complain(e, "statistic", e.statistic, statistics);
  }
  if (errors.empty()) return;
  errors.pop_back();
  throw Error(ExitCode::usage, errors);
}

}  // namespace pileus::model
