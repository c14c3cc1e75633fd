#include "study/work_precision.hpp"

#include <algorithm>
#include <cmath>

namespace pileus::study {

namespace {

std::vector<double> sorted_numbers(std::vector<double> values) {
  std::erase_if(values, [](double v) { return std::isnan(v); });
  std::sort(values.begin(), values.end());
  return values;
}

/// Slope of the least-squares line through (x, y); NaN for fewer than two different x.
double slope_of(const std::vector<double>& x, const std::vector<double>& y) {
  const auto n = static_cast<double>(x.size());
  double mean_x = 0, mean_y = 0, covariance = 0, variance = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    mean_x += x[i] / n;
    mean_y += y[i] / n;
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    covariance += (x[i] - mean_x) * (y[i] - mean_y);
    variance += (x[i] - mean_x) * (x[i] - mean_x);
  }
  return x.size() > 1 && variance > 0 ? covariance / variance : not_a_number;
}

bool matches(const Findings& findings, const std::vector<int>& rungs,
             const StudyExpectation& expectation, std::optional<std::size_t> except) {
  const std::vector<Knob>& knobs = findings.layout.knobs;
  for (std::size_t k = 0; k < knobs.size(); ++k) {
    const auto wanted = expectation.points.find(knobs[k].name);
    if (wanted == expectation.points.end() || except == k) continue;
    if (rungs[k] < 0 || knobs[k].ladder[static_cast<std::size_t>(rungs[k])].label != wanted->second)
      return false;
  }
  return true;
}

Verdict verdict_on(const StudyExpectation& e, std::string point, double value) {
  const bool passed =
      !std::isnan(value) && !(e.low && !(value >= *e.low)) && !(e.high && !(value <= *e.high));
  return {e, std::move(point), value, passed};
}

std::size_t index_of_norm(const Study& study, const std::string& name) {
  for (std::size_t n = 0; n < study.errors.size(); ++n)
    if (study.errors[n].name == name) return n;
  return 0;  // names were checked when the study was read
}

std::vector<Verdict> judge_points(const Findings& findings, const StudyExpectation& e) {
  std::vector<Verdict> verdicts;
  const std::size_t norm = index_of_norm(findings.study, e.norm);
  for (std::size_t p = 0; p < findings.points.size(); ++p) {
    const PointResult& point = findings.points[p];
    if (point.only_reference || !matches(findings, point.rungs, e, {})) continue;
    // The point that others are compared with has no error of its own.
    if (findings.study.errors[norm].needs_finest() && findings.layout.finest == p) continue;
    // A bound holds for every seed.
    const Spread& error = point.errors[norm];
    const bool high_decides = e.high && !(error.high <= *e.high);
    verdicts.push_back(verdict_on(e, point.label, high_decides || !e.low ? error.high : error.low));
  }
  return verdicts;
}

std::vector<Verdict> judge_curves(const Findings& findings, const StudyExpectation& e) {
  std::vector<Verdict> verdicts;
  const std::size_t norm = index_of_norm(findings.study, e.norm);
  for (std::size_t c = 0; c < findings.layout.curves.size(); ++c) {
    const KnobCurve& curve = findings.layout.curves[c];
    const Knob& knob = findings.layout.knobs[curve.knob];
    if (knob.name != e.along) continue;
    if (!matches(findings, findings.points[curve.points.front()].rungs, e, curve.knob)) continue;
    verdicts.push_back(verdict_on(e, curve.label.empty() ? knob.name : curve.label,
                                  findings.orders(c, norm).overall));
  }
  return verdicts;
}

}  // namespace

Spread mean_of(std::vector<double> values) {
  values = sorted_numbers(std::move(values));
  if (values.empty()) return {};
  double sum = 0;
  for (const double v : values) sum += v;
  return {sum / static_cast<double>(values.size()), values.front(), values.back()};
}

Spread median_of(std::vector<double> values) {
  values = sorted_numbers(std::move(values));
  if (values.empty()) return {};
  const std::size_t half = values.size() / 2;
  const double median =
      values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
  return {median, values.front(), values.back()};
}

double Findings::number(std::size_t point, std::size_t knob) const {
  const int rung = points[point].rungs[knob];
  return rung < 0 ? not_a_number : layout.knobs[knob].ladder[static_cast<std::size_t>(rung)].number;
}

Orders Findings::orders(std::size_t curve, std::size_t norm) const {
  const KnobCurve& along = layout.curves[curve];
  Orders orders;
  std::vector<double> x, y;
  double direction = 0;
  for (std::size_t i = 0; i < along.points.size(); ++i) {
    const std::size_t p = along.points[i];
    const double error = points[p].errors[norm].value, at = number(p, along.knob);
    orders.local.push_back(not_a_number);
    if (!(error > 0) || !(at > 0)) continue;
    if (!x.empty() && std::log(at) != x.back()) {
      direction = std::log(at) > x.back() ? 1 : -1;
      // Only between neighbours of the ladder: a gap is a point that failed.
      const std::size_t before = along.points[i - 1];
      const double e0 = points[before].errors[norm].value, n0 = number(before, along.knob);
      if (e0 > 0 && n0 > 0 && n0 != at)
        orders.local.back() = std::log(e0 / error) / std::abs(std::log(n0 / at));
    }
    x.push_back(std::log(at));
    y.push_back(std::log(error));
  }
  orders.overall = -direction * slope_of(x, y);
  return orders;
}

bool Findings::is_resolved(std::size_t before, std::size_t point, std::size_t norm) const {
  const Spread &a = points[before].errors[norm], &b = points[point].errors[norm];
  const double spread = 0.5 * ((a.high - a.low) + (b.high - b.low));
  return !(std::abs(a.value - b.value) < spread);
}

std::vector<std::size_t> Findings::front(std::size_t norm) const {
  std::vector<std::size_t> candidates;
  for (std::size_t p = 0; p < points.size(); ++p)
    if (!points[p].only_reference && points[p].cost.known() && points[p].errors[norm].known())
      candidates.push_back(p);
  const auto cost = [&](std::size_t p) { return points[p].cost.value; };
  const auto error = [&](std::size_t p) { return points[p].errors[norm].value; };
  std::vector<std::size_t> front;
  for (const std::size_t p : candidates) {
    const bool beaten = std::any_of(candidates.begin(), candidates.end(), [&](std::size_t q) {
      return (cost(q) < cost(p) && error(q) <= error(p)) ||
             (cost(q) <= cost(p) && error(q) < error(p));
    });
    if (!beaten) front.push_back(p);
  }
  std::stable_sort(front.begin(), front.end(),
                   [&](std::size_t a, std::size_t b) { return cost(a) < cost(b); });
  return front;
}

std::vector<Verdict> judge(const Findings& findings) {
  std::vector<Verdict> all;
  for (const StudyExpectation& e : findings.study.expect) {
    std::vector<Verdict> some =
        e.of == StudyExpectation::Of::error ? judge_points(findings, e) : judge_curves(findings, e);
    if (some.empty()) some.push_back({e, "no point", not_a_number, false});
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

}  // namespace pileus::study
