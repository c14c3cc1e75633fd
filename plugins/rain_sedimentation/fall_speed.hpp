// How fast rain falls: one speed for its mass and one for its number.
#pragma once
#include <pileus/drops.hpp>

#include <algorithm>
#include <cmath>

namespace pileus::sedimentation {

enum class FallSpeedScheme { seifert_beheng, khairoutdinov_kogan };

struct FallSpeeds {
  double mass = 0, number = 0;  // m s-1, downward, not negative
};

/// Speeds of rain of a mean drop mass (kg) in air of a density (kg m-3).
///
/// Seifert & Beheng 2006 with an exponential distribution: (ρ_0/ρ)^{1/2}
/// [9.65 − 10.3 (1 + 600/λ)^{−(3k+1)}], k = 0 for the number and 1 for the mass, λ cut to 1e3 …
/// 1e4 m-1. Khairoutdinov & Kogan 2000, eq. 37: 0.012 r − 0.2 and 0.007 r − 0.1 with the radius of
/// mean volume r in µm.
inline FallSpeeds fall_speeds(FallSpeedScheme scheme, double mean_mass, double density) {
  if (scheme == FallSpeedScheme::khairoutdinov_kogan) {
    const double radius = 1e6 * drops::radius_of_mass(std::min(mean_mass, drops::largest_raindrop));
    return {std::max(0.0, 0.012 * radius - 0.2), std::max(0.0, 0.007 * radius - 0.1)};
  }
  const double slope =
      std::clamp(std::cbrt(drops::pi * drops::water_density / mean_mass), 1e3, 1e4);
  const double base = 1.0 / (1.0 + 600.0 / slope);
  const double factor = std::sqrt(drops::surface_density / density);
  return {std::max(0.0, factor * (9.65 - 10.3 * base * base * base * base)),
          std::max(0.0, factor * (9.65 - 10.3 * base))};
}

}  // namespace pileus::sedimentation
