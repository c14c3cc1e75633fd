// A function of one variable given at points: what a parameter over height or time means.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <span>
#include <vector>

#include "failure.hpp"

namespace pileus {

/// Linear between its points, constant beyond the first and the last.
class PiecewiseLinear {
 public:
  PiecewiseLinear() : points_{{0.0, 0.0}} {}
  /// From x_0, v_0, x_1, v_1, … with ascending x; as parameters of the type profile hold them.
  explicit PiecewiseLinear(std::span<const double> pairs) {
    for (std::size_t i = 0; i + 1 < pairs.size(); i += 2)
      points_.push_back({pairs[i], pairs[i + 1]});
    if (points_.empty()) points_.push_back({0.0, 0.0});
  }

  /// From ascending places and a value for each.
  PiecewiseLinear(std::span<const double> places, std::span<const double> values) {
    for (std::size_t i = 0; i < std::min(places.size(), values.size()); ++i)
      points_.push_back({places[i], values[i]});
    if (points_.empty()) points_.push_back({0.0, 0.0});
  }

  struct Point {
    double at, value;
  };
  std::span<const Point> points() const { return points_; }

  bool is_constant() const {
    return std::all_of(points_.begin(), points_.end(),
                       [&](const Point& p) { return p.value == points_.front().value; });
  }
  bool is_zero() const { return points_.front().value == 0 && is_constant(); }

  double operator()(double x) const {
    // What is not a number counts as the lower end: it must not lead outside the list.
    if (!(x > points_.front().at)) return points_.front().value;
    if (x >= points_.back().at) return points_.back().value;
    const std::size_t k = segment(x);
    const Point &a = points_[k], &b = points_[k + 1];
    return a.value + (x - a.at) / (b.at - a.at) * (b.value - a.value);
  }

  /// Slope at x; at a point that of what follows.
  double derivative(double x) const {
    if (!(x >= points_.front().at) || x >= points_.back().at) return 0;
    const std::size_t k = segment(x);
    const Point &a = points_[k], &b = points_[k + 1];
    return (b.value - a.value) / (b.at - a.at);
  }

  /// ∫ from a to b (a ≤ b), exact.
  double integral(double a, double b) const {
    return over_pieces(a, b, [this](double from, double to) {
      return 0.5 * ((*this)(from) + (*this)(to)) * (to - from);
    });
  }

  /// Sum of piece(from, to) over the parts of [a, b] in each of which the function is linear.
  template <class Piece>
  double over_pieces(double a, double b, Piece&& piece) const {
    double sum = 0, from = a;
    for (const Point& p : points_) {
      if (p.at <= from) continue;
      if (p.at >= b) break;
      sum += piece(from, p.at);
      from = p.at;
    }
    return b > from ? sum + piece(from, b) : sum;
  }

 private:
  /// The k with x_k ≤ x < x_{k+1}, for x within the points.
  std::size_t segment(double x) const {
    const auto above = std::upper_bound(points_.begin(), points_.end(), x,
                                        [](double value, const Point& p) { return value < p.at; });
    return static_cast<std::size_t>(above - points_.begin()) - 1;
  }

  std::vector<Point> points_;
};

/// Refuses a list parameter whose values do not ascend.
/// Errors  Failure(PILEUS_E_CONFIG)
inline void require_ascending(const char* parameter, std::span<const double> values) {
  if (std::adjacent_find(values.begin(), values.end(),
                         [](double a, double b) { return !(b > a); }) == values.end())
    return;
  Failure failure("", PILEUS_E_CONFIG);
  std::snprintf(failure.record.text, sizeof failure.record.text,
                "%s does not ascend; order its values from low to high", parameter);
  throw failure;
}

/// A list parameter and its name, for what is said about it.
struct NamedList {
  const char* name;
  std::span<const double> values;
};

/// The profile that two list parameters stand for: a value for each height, or one for all.
/// Errors  Failure(PILEUS_E_CONFIG) for lists of different length or heights that do not ascend
inline PiecewiseLinear profile_of_lists(const NamedList& heights, const NamedList& values) {
  require_ascending(heights.name, heights.values);
  if (values.values.size() == 1) {
    const double everywhere[] = {0.0, values.values.front()};
    return PiecewiseLinear(everywhere);
  }
  if (values.values.size() == heights.values.size()) return {heights.values, values.values};
  Failure failure("", PILEUS_E_CONFIG);
  std::snprintf(failure.record.text, sizeof failure.record.text,
                "%s needs one value, or one for each %s", values.name, heights.name);
  throw failure;
}

}  // namespace pileus
