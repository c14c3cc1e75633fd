// When a droplet is in equilibrium with the air: curvature against solute.
#pragma once
#include <pileus/drops.hpp>
#include <pileus/numerics.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pileus::superdroplets {

inline constexpr double sphere = 4.0 / 3.0 * drops::pi;  // volume of r = 1

/// What a droplet has condensed on. Both volumes are extensive: they add when droplets join.
struct Particle {
  double dry_volume = 0;          // V_d, m3; 0 for a drop of pure water
  double hygroscopic_volume = 0;  // κ V_d, m3
};

inline double radius_of_volume(double volume) {
  return std::cbrt(volume / sphere);
}
inline double volume_of_radius(double radius) {
  return sphere * radius * radius * radius;
}
/// Radius of a droplet of a water mass (kg), m.
inline double wet_radius(double water_mass, double dry_volume) {
  return radius_of_volume(water_mass / drops::water_density + dry_volume);
}

/// Kelvin's length A = 2σ/(ρ_w R_v T), m; `gas_constant` is that of vapour, `surface_tension` in
/// N m-1.
inline double kelvin_length(double temperature, double gas_constant, double surface_tension) {
  return 2.0 * surface_tension / (drops::water_density * gas_constant * temperature);
}

/// Saturation ratio over a droplet of radius r and its slope in r:
/// S_eq = V_w/(V_w + κ V_d) exp(A/r), V_w = (4π/3) r³ − V_d (Petters & Kreidenweis 2007,
/// doi:10.5194/acp-7-1961-2007, eq. 6).
///
/// Requires   r > 0 and not below the dry radius
inline numerics::ValueAndSlope equilibrium_saturation(double radius, const Particle& particle,
                                                      double kelvin) {
  const double water = std::max(0.0, volume_of_radius(radius) - particle.dry_volume);
  const double solute = particle.hygroscopic_volume;
  const double curvature = std::exp(kelvin / radius);
  if (!(solute > 0)) return {curvature, -curvature * kelvin / (radius * radius)};
  const double solution = water + solute;
  const double activity = water / solution;
  const double area = 3.0 * sphere * radius * radius;
  return {activity * curvature, curvature * (solute / (solution * solution) * area -
                                             activity * kelvin / (radius * radius))};
}

struct CriticalPoint {
  double radius;      // m
  double saturation;  // ratio, 1 + critical supersaturation
};

/// The maximum of S_eq: beyond it a droplet grows without end in air that is held there.
///
/// With v = V_w and V = v + V_d, d ln S_eq/dr = 0 reads 3 κV_d V^{4/3} = a v (v + κV_d), a = A
/// (4π/3)^{1/3}; its right side over its left increases from 0 without bound. A particle that takes
/// up no water has its maximum at the dry radius, a drop of pure water at none: radius 0.
inline CriticalPoint critical_point(const Particle& particle, double kelvin) {
  const double dry = particle.dry_volume, solute = particle.hygroscopic_volume;
  if (!(solute > 0)) {
    const double radius = radius_of_volume(dry);
    return {radius,
            radius > 0 ? std::exp(kelvin / radius) : std::numeric_limits<double>::infinity()};
  }
  const double a = kelvin * std::cbrt(sphere);
  // In x = ln(v): ln a + x + ln(v + κV_d) − ln(3κV_d) − (4/3) ln(v + V_d).
  const auto excess = [&](double x) -> numerics::ValueAndSlope {
    const double v = std::exp(x);
    return {x + std::log(a * (v + solute) / (3.0 * solute)) - 4.0 / 3.0 * std::log(v + dry),
            1.0 + v / (v + solute) - 4.0 / 3.0 * v / (v + dry)};
  };
  // Without V_d on the left 3 κV_d = A r², too small; r = 3 κV_d/(A r_max²)… bounds it from above.
  double low = std::log(solute) - 40.0, high = std::log(solute) + 40.0;
  while (excess(low).value > 0) low -= 40.0;
  while (excess(high).value < 0) high += 40.0;
  const double start = 1.5 * std::log(3.0 * solute / a);
  const double v = std::exp(numerics::bracketed_newton(excess, low, high, start, 1e-15).x);
  const double radius = radius_of_volume(v + dry);
  return {radius, v / (v + solute) * std::exp(kelvin / radius)};
}

/// Water mass (kg) of a droplet in equilibrium at a saturation ratio: on the branch of haze,
/// between dry and critical size. At and beyond the critical saturation that of the critical size;
/// a particle that takes up no water has none.
inline double equilibrium_water(double saturation, const Particle& particle, double kelvin) {
  const double solute = particle.hygroscopic_volume, dry = particle.dry_volume;
  if (!(solute > 0) || !(saturation > 0)) return 0;
  const CriticalPoint critical = critical_point(particle, kelvin);
  const double highest = std::max(0.0, volume_of_radius(critical.radius) - dry);
  if (!(saturation < critical.saturation)) return highest * drops::water_density;
  const auto excess = [&](double v) -> numerics::ValueAndSlope {
    const double radius = radius_of_volume(v + dry), solution = v + solute;
    const double curvature = std::exp(kelvin / radius), activity = v / solution;
    return {activity * curvature - saturation,
            curvature *
                (solute / (solution * solution) - activity * kelvin / (3.0 * radius * (v + dry)))};
  };
  // Without curvature v = κV_d S/(1 − S); curvature only lowers it.
  const double flat = saturation < 1 ? solute * saturation / (1.0 - saturation) : highest;
  const double start = std::min(flat, highest);
  return numerics::bracketed_newton(excess, 0.0, highest, start, 1e-14).x * drops::water_density;
}

}  // namespace pileus::superdroplets
