#include "model/profile_measure.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace pileus::model {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// `sign` +1: the largest value, −1: the smallest.
double height_of_extremum(const Profile& profile, double sign) {
  const std::span<const double>& f = profile.values;
  std::size_t at = f.size();
  for (std::size_t k = 0; k < f.size(); ++k)
    if (!std::isnan(f[k]) && (at == f.size() || sign * f[k] > sign * f[at])) at = k;
  if (at == f.size()) return nan;
  double shift = 0;
  if (at > 0 && at + 1 < f.size()) {
    const double curvature = f[at - 1] - 2 * f[at] + f[at + 1];
    if (sign * curvature < 0) shift = 0.5 * (f[at - 1] - f[at + 1]) / curvature;
  }
  return profile.height(at) + shift * profile.spacing;
}

struct Points {
  std::vector<double> height, value;
};

Points points_between(const Profile& profile, double low, double high) {
  const double slack = 1e-9 * profile.spacing;  // levels on the bounds belong to the range
  Points points;
  for (std::size_t k = 0; k < profile.values.size(); ++k) {
    const double z = profile.height(k);
    if (z < low - slack || z > high + slack || std::isnan(profile.values[k])) continue;
    points.height.push_back(z);
    points.value.push_back(profile.values[k]);
  }
  return points;
}

double mean_of(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

/// Slope of the least-squares line.
double slope_of(const Points& points) {
  if (points.height.empty()) return nan;
  const double z0 = mean_of(points.height), v0 = mean_of(points.value);
  double covariance = 0, variance = 0;
  for (std::size_t i = 0; i < points.height.size(); ++i) {
    const double z = points.height[i] - z0;
    covariance += z * (points.value[i] - v0);
    variance += z * z;
  }
  return variance > 0 ? covariance / variance : nan;
}

/// Values over the logarithm of the height above `bottom`; without what lies there.
Points over_logarithm(const Points& points, double bottom) {
  Points result;
  for (std::size_t i = 0; i < points.height.size(); ++i) {
    if (!(points.height[i] > bottom)) continue;
    result.height.push_back(std::log(points.height[i] - bottom));
    result.value.push_back(points.value[i]);
  }
  return result;
}

double nonlinearity_of(const Points& points) {
  const double z0 = mean_of(points.height), v0 = mean_of(points.value), slope = slope_of(points);
  double deviation = 0, magnitude = 0;
  for (std::size_t i = 0; i < points.height.size(); ++i) {
    const double line = v0 + slope * (points.height[i] - z0);
    if (std::isnan(line)) return nan;
    deviation = std::max(deviation, std::abs(points.value[i] - line));
    magnitude = std::max(magnitude, std::abs(line));
  }
  if (magnitude > 0) return deviation / magnitude;
  return deviation > 0 ? nan : 0.0;
}

}  // namespace

double value_at(const Profile& profile, double height) {
  const auto last = static_cast<double>(profile.values.size() - 1);
  const double xi = std::clamp((height - profile.bottom) / profile.spacing, 0.0, last);
  const auto k = static_cast<std::size_t>(xi);
  const double fraction = xi - static_cast<double>(k);
  if (fraction == 0) return profile.values[k];
  return profile.values[k] + fraction * (profile.values[k + 1] - profile.values[k]);
}

double height_of_smallest(const Profile& profile) {
  return height_of_extremum(profile, -1);
}

double height_of_largest(const Profile& profile) {
  return height_of_extremum(profile, 1);
}

double measure(const Profile& profile, ProfileMeasure what, double low, double high) {
  if (what == ProfileMeasure::value) return value_at(profile, low);
  const Points points = points_between(profile, low, high);
  const std::vector<double>& values = points.value;
  if (values.empty()) return nan;
  const auto smallest = std::min_element(values.begin(), values.end());
  const auto largest = std::max_element(values.begin(), values.end());
  switch (what) {
    case ProfileMeasure::mean:
      return mean_of(values);
    case ProfileMeasure::min:
      return *smallest;
    case ProfileMeasure::max:
      return *largest;
    case ProfileMeasure::height_of_min:
      return points.height[static_cast<std::size_t>(smallest - values.begin())];
    case ProfileMeasure::height_of_max:
      return points.height[static_cast<std::size_t>(largest - values.begin())];
    case ProfileMeasure::slope:
      return slope_of(points);
    case ProfileMeasure::logarithmic_slope:
      return slope_of(over_logarithm(points, profile.bottom));
    default:
      return nonlinearity_of(points);
  }
}

}  // namespace pileus::model
