// Exact integrals of profiles that are linear between points, over the hat functions of the levels:
// what a source that is given over height brings to each level, however its kinks lie between them.
#pragma once
#include <pileus/piecewise_linear.hpp>

#include <cstddef>

#include "level_means.hpp"

namespace pileus::large_scale {

/// ∫ F w_k dz and ∫ F w_{k+1} dz over the layer from level k to level k + 1.
struct LayerIntegrals {
  double lower = 0, upper = 0;
  double sum() const { return lower + upper; }
};

inline LayerIntegrals layer_integrals(const PiecewiseLinear& profile, const Levels& levels,
                                      std::size_t layer) {
  const double from = levels.height(layer), to = levels.height(layer + 1);
  const double spacing = to - from;
  // The product of two linear functions is a parabola: Simpson's rule is exact on each piece.
  const auto weighted = [&](auto&& hat) {
    return profile.over_pieces(from, to, [&](double a, double b) {
      const double middle = 0.5 * (a + b);
      return (b - a) / 6 *
             (profile(a) * hat(a) + 4 * profile(middle) * hat(middle) + profile(b) * hat(b));
    });
  };
  return {weighted([&](double z) { return (to - z) / spacing; }),
          weighted([&](double z) { return (z - from) / spacing; })};
}

/// ∫ F w_k dz over the domain.
inline double hat_integral(const PiecewiseLinear& profile, const Levels& levels, std::size_t k) {
  double sum = 0;
  if (k > 0) sum += layer_integrals(profile, levels, k - 1).upper;
  if (k < levels.cells) sum += layer_integrals(profile, levels, k).lower;
  return sum;
}

/// ∫ F′ w_k dz over the domain by parts, from integrals of F over the layers below and above the
/// level (0 beyond a wall) and the values of F at the walls: the sum over all levels is
/// F(top) − F(bottom).
inline double slope_integral(const Levels& levels, std::size_t k, double layer_below,
                             double layer_above, double at_bottom, double at_top) {
  double sum = (layer_above - layer_below) / levels.spacing;
  if (k == 0) sum -= at_bottom;
  if (k == levels.cells) sum += at_top;
  return sum;
}

inline double slope_integral(const PiecewiseLinear& profile, const Levels& levels, std::size_t k) {
  const double below = k > 0 ? profile.integral(levels.height(k - 1), levels.height(k)) : 0.0;
  const double above =
      k < levels.cells ? profile.integral(levels.height(k), levels.height(k + 1)) : 0.0;
  return slope_integral(levels, k, below, above, profile(levels.bottom), profile(levels.top()));
}

/// Mean over the depth of the domain.
inline double depth_mean(const PiecewiseLinear& profile, const Levels& levels) {
  return profile.integral(levels.bottom, levels.top()) / levels.depth();
}

}  // namespace pileus::large_scale
