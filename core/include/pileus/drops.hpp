// Drops of water and the air about them: what the plugins for clouds and rain agree on.
#pragma once
#include <cmath>

namespace pileus::drops {

inline constexpr double pi = 3.14159265358979323846;
inline constexpr double water_density = 1000.0;  // kg m-3

/// Density of air that fall speeds and kernels are given for, ρ_0 of their corrections, kg m-3.
inline constexpr double surface_density = 1.225;

/// Mean masses beyond these are no cloud droplets and no raindrops: up to 40 µm, up to 2.1 mm of
/// diameter (Seifert & Beheng 2006, doi:10.1007/s00703-005-0112-4). Rates use the mean mass cut to
/// them.
inline constexpr double largest_droplet = 2.6e-10;  // kg, also the smallest raindrop
inline constexpr double largest_raindrop = 5.0e-6;  // kg

/// Mass of a drop of a radius (m), kg, and the radius of a mass.
inline double mass_of_radius(double radius) {
  return 4.0 / 3.0 * pi * water_density * radius * radius * radius;
}
inline double radius_of_mass(double mass) {
  return std::cbrt(mass * (3.0 / (4.0 * pi * water_density)));
}

/// Diffusivity of vapour in air, m2 s-1. Pruppacher & Klett 1997, eq. 13-3; −40 to 40 °C.
inline double vapour_diffusivity(double temperature, double pressure) {
  return 2.11e-5 * std::pow(temperature / 273.15, 1.94) * (101325.0 / pressure);
}

/// Thermal conductivity of air, W m-1 K-1. Linear fit of Beard & Pruppacher 1971.
inline double heat_conductivity(double temperature) {
  return 4.3783e-3 + 7.1128e-5 * temperature;
}

/// Dynamic viscosity of air, kg m-1 s-1. Rogers & Yau 1989, table 7.1 as a Sutherland law.
inline double dynamic_viscosity(double temperature) {
  return 1.72e-5 * (393.0 / (temperature + 120.0)) * std::pow(temperature / 273.0, 1.5);
}

}  // namespace pileus::drops
