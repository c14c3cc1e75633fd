// The normal distribution and its inverse.
#pragma once
#include <cmath>
#include <numbers>

namespace pileus::superdroplets {

/// Φ(z), accurate in the lower tail to relative rounding.
inline double normal_distribution(double z) {
  return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

/// Φ(b) − Φ(a) for a ≤ b without cancellation in either tail.
inline double normal_between(double a, double b) {
  return a > 0 ? normal_distribution(-a) - normal_distribution(-b)
               : normal_distribution(b) - normal_distribution(a);
}

/// z with Φ(z) = p, 0 < p < 1: Abramowitz & Stegun (1964) eq. 26.2.23 (4.5e-4) and three steps of
/// Halley's method, each of which cubes the error.
inline double normal_quantile(double p) {
  if (p > 0.5) return -normal_quantile(1.0 - p);
  const double t = std::sqrt(-2.0 * std::log(p));
  double z = ((0.010328 * t + 0.802853) * t + 2.515517) /
                 (((0.001308 * t + 0.189269) * t + 1.432788) * t + 1.0) -
             t;
  for (int i = 0; i < 3; ++i) {
    const double density = std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi);
    const double newton = (normal_distribution(z) - p) / density;
    z -= newton / (1.0 + 0.5 * z * newton);
  }
  return z;
}

}  // namespace pileus::superdroplets
