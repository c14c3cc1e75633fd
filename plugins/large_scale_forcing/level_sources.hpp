// What subsidence and a forced wind bring to each level, as integrals over its hat function.
#pragma once
#include <cmath>
#include <cstddef>
#include <span>

#include "profile_integrals.hpp"

namespace pileus::large_scale {

/// The continuous profile, linear between the levels, whose means over the hat functions are those
/// that were gathered: (φ_{k−1} + 4 φ_k + φ_{k+1})/6 = φ̄_k, at the walls the value at the mean
/// height of what they hold. A mean over a hat function rounds off what happens within two cells,
/// the bottom of an inversion above all; this profile does not, and sums of its slopes are its
/// differences. For levels none of which is empty; `work` has one double per level.
inline void fit_profile(const Levels& levels, const LevelMeans& means, std::size_t quantity,
                        double* profile, double* work) {
  const std::size_t last = levels.cells;
  // What parcels that lie unevenly about their level have too much because of the slope.
  const auto centred = [&](std::size_t k) {
    if (k == 0 || k == last) return means.mean(k, quantity);
    const double slope = (means.mean(k + 1, quantity) - means.mean(k - 1, quantity)) /
                         (means.height(k + 1) - means.height(k - 1));
    return means.mean(k, quantity) - slope * (means.height(k) - levels.height(k));
  };
  const double from_bottom = (means.height(0) - levels.bottom) / levels.spacing;
  const double from_top = (levels.top() - means.height(last)) / levels.spacing;
  double pivot = 1 - from_bottom;
  profile[0] = centred(0) / pivot;
  for (std::size_t k = 1; k <= last; ++k) {
    const bool top = k == last;
    const double below = top ? from_top : 1.0 / 6, here = top ? 1 - from_top : 4.0 / 6;
    work[k - 1] = (k == 1 ? from_bottom : 1.0 / 6) / pivot;
    pivot = here - below * work[k - 1];
    profile[k] = (centred(k) - below * profile[k - 1]) / pivot;
  }
  for (std::size_t k = last; k-- > 0;) profile[k] -= work[k] * profile[k + 1];
}

/// Subtracts ∫ w (∂φ/∂z) w_k dz from the source of each level, φ the fitted profile. `velocity`
/// holds the integrals of w over the layers. Where a level is empty, means are taken for values at
/// their mean heights, and layers next to it have no gradient.
inline void add_subsidence(const Levels& levels, const LevelMeans& means, std::size_t quantity,
                           std::span<const LayerIntegrals> velocity, double* sources) {
  double* profile = means.spare().data();
  const bool fitted = !means.any_empty() && levels.cells >= 2;
  if (fitted) fit_profile(levels, means, quantity, profile, profile + levels.count());
  for (std::size_t k = 0; k < levels.cells; ++k) {
    const double apart = fitted ? levels.spacing : means.height(k + 1) - means.height(k);
    if (means.is_empty(k) || means.is_empty(k + 1) || !(apart > 0)) continue;
    const double rise = fitted ? profile[k + 1] - profile[k]
                               : means.mean(k + 1, quantity) - means.mean(k, quantity);
    sources[k] -= rise / apart * velocity[k].lower;
    sources[k + 1] -= rise / apart * velocity[k].upper;
  }
}

/// Subsidence of the wind, a force F = −w ∂u/∂z with a shear that is linear between the levels:
/// adds ∫ F′ w_k dz to the source of shear of each level and returns ∫ F dz over the depth.
inline double add_wind_subsidence(const Levels& levels, const double* shear,
                                  std::span<const LayerIntegrals> velocity, double at_bottom,
                                  double at_top, double* sources) {
  const auto force_over = [&](std::size_t layer) {
    return -(shear[layer] * velocity[layer].lower + shear[layer + 1] * velocity[layer].upper);
  };
  double sum = 0, below = 0;
  for (std::size_t k = 0; k < levels.count(); ++k) {
    const double above = k < levels.cells ? force_over(k) : 0.0;
    sources[k] += slope_integral(levels, k, below, above, -at_bottom * shear[0],
                                 -at_top * shear[levels.cells]);
    sum += above;
    below = above;
  }
  return sum;
}

/// What a wind gains in `dt` from the pressure gradient that balances the geostrophic wind. The
/// core turns the wind by the angle f dt; with R that rotation, (1 − R) u_g makes it a rotation
/// about the geostrophic wind, u ← u_g + R (u − u_g), which for short steps is the force f (−v_g,
/// u_g).
struct GeostrophicPush {
  double cosine_part, sine;  // 1 − cos(f dt) and sin(f dt)

  GeostrophicPush(double coriolis, double dt)
      : cosine_part(2 * std::sin(0.5 * coriolis * dt) * std::sin(0.5 * coriolis * dt)),
        sine(std::sin(coriolis * dt)) {}
  double x(double u, double v) const { return cosine_part * u - sine * v; }
  double y(double u, double v) const { return sine * u + cosine_part * v; }
};

}  // namespace pileus::large_scale
