// What a study found: error and cost of every point, orders of convergence, the Pareto front.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "study/points.hpp"

namespace pileus::study {

/// A number from several runs.
struct Spread {
  double value = not_a_number, low = not_a_number, high = not_a_number;
  bool known() const { return value == value; }
};

/// The mean with the extremes; NaNs are left out.
Spread mean_of(std::vector<double> values);
/// The median with the extremes; NaNs are left out.
Spread median_of(std::vector<double> values);

struct PointResult {
  std::string label;
  std::vector<int> rungs;  // as in Point
  bool only_reference = false;
  std::vector<scene::Setting> settings;
  std::size_t runs = 0;         // that reached their end
  std::string failure;          // of the first that did not
  Spread cost;                  // in the study's measure
  Spread core_time, wall_time;  // s
  double parcels = not_a_number, steps = not_a_number;
  std::vector<Spread> errors;  // by norm, over seeds
  std::string commit, date;    // of the newest run
};

/// How an error falls along a curve.
struct Orders {
  /// Between each point and the one before it, NaN where there is none:
  /// ln(e₀/e₁)/|ln(n₀/n₁)|, positive when the error falls towards the finer end.
  std::vector<double> local;
  double overall = not_a_number;  // slope of the straight line through all points, logarithmic
};

struct Findings {
  Study study;
  Layout layout;
  std::vector<PointResult> points;  // as in the layout

  /// How the error of a norm falls along a curve.
  Orders orders(std::size_t curve, std::size_t norm) const;
  /// Whether the change from the point before is smaller than the spread over the seeds of both.
  bool is_resolved(std::size_t before, std::size_t point, std::size_t norm) const;
  /// The points for which nothing is both cheaper and at least as accurate, or as cheap and more
  /// accurate, by increasing cost.
  std::vector<std::size_t> front(std::size_t norm) const;
  /// The place of a point on a knob's axis; NaN when it has none.
  double number(std::size_t point, std::size_t knob) const;
};

struct Verdict {
  StudyExpectation expectation;
  std::string point;  // or curve
  double value = not_a_number;
  bool passed = false;
};

/// Every bound of the study against every point or curve it speaks of; a bound that speaks of none
/// fails.
std::vector<Verdict> judge(const Findings& findings);

}  // namespace pileus::study
