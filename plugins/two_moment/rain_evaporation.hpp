// Exchange of vapour between raindrops and the air they fall through.
#pragma once
#include <algorithm>
#include <cmath>

#include "droplet_growth.hpp"

namespace pileus::two_moment {

/// Slope of the exponential distribution of drop diameters, (π ρ_w n_r/q_r)^{1/3}, m-1, for a mean
/// mass cut to the range of raindrops.
inline double rain_slope(double rain, double raindrops) {
  const double mass = std::clamp(raindrops > 0 ? rain / raindrops : largest_droplet,
                                 largest_droplet, largest_raindrop);
  return std::cbrt(pi * water_density / mass);
}

/// Ventilated mean size B (m): dq_r/dt = 2π ρ_w n_r G s B, integrated over the distribution with
/// the fall speed 842 D^0.8 (ρ_0/ρ)^{1/2} (Liu & Orville 1969) and the ventilation 0.78 + 0.308
/// Sc^{1/3} Re^{1/2} (Pruppacher & Klett 1997, eq. 13-61): B = a_v/λ + b_v Sc^{1/3} (α/ν)^{1/2}
/// (ρ_0/ρ)^{1/4} Γ((5+β)/2) λ^{−(3+β)/2}.
inline double ventilated_size(double slope, double temperature, double pressure, double density) {
  constexpr double still = 0.78, moving = 0.308, alpha = 841.99667;
  constexpr double gamma_2_9 = 1.8273550806240353;  // Γ((5 + β)/2), β = 0.8
  const double viscosity = dynamic_viscosity(temperature) / density;
  const double schmidt = viscosity / vapour_diffusivity(temperature, pressure);
  return still / slope + moving * std::cbrt(schmidt) * std::sqrt(alpha / viscosity) *
                             std::sqrt(std::sqrt(surface_density / density)) * gamma_2_9 *
                             std::pow(slope, -1.9);
}

/// 2π ρ_w n_r B: times G s this is dq_r/dt. The number follows from the mass where it is too small
/// for it.
inline double rain_exchange(double rain, double raindrops, double temperature, double pressure,
                            double density) {
  const double number = std::max(raindrops, rain / largest_raindrop);
  return 2.0 * pi * water_density * number *
         ventilated_size(rain_slope(rain, number), temperature, pressure, density);
}

}  // namespace pileus::two_moment
