// How fast a single drop falls through still air: published formulas, chosen by name.
#pragma once
#include <pileus/drops.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace pileus::superdroplets {

enum class FallSpeedScheme {
  beard_1976,   // three regimes, for any temperature and pressure
  beard_1977,   // two polynomials, at sea level
  gunn_kinzer,  // measured at sea level, interpolated
  rogers_yau,   // three powers of the radius, which jump at 30 µm
  simmel,       // powers of the mass, as used with Long's kernel
  rogers_1993,  // two exponentials, at sea level
  none          // drops that do not fall
};

/// Σ c_i x^i.
template <std::size_t n>
constexpr double polynomial(const std::array<double, n>& c, double x) {
  double sum = 0;
  for (std::size_t i = n; i-- > 0;) sum = sum * x + c[i];
  return sum;
}

/// Beard (1976, doi:10.1175/1520-0469(1976)033<0851:TVASOC>2.0.CO;2): slip-corrected Stokes flow
/// below 9.5 µm, a fit in the Best number to 535 µm, and one in the Bond and the physical-property
/// number for drops that are flattened; radii beyond 3.5 mm fall like 3.5 mm.
///
/// The regimes differ by 0.2 % where they meet at 9.5 µm, by up to as much at 535 µm.
struct Beard1976 {
  static constexpr double gravity = 9.80616;         // m s-2
  static constexpr double gas_constant = 287.05;     // of dry air, J kg-1 K-1
  static constexpr double surface_tension = 0.0728;  // of water against air at 20 °C, N m-1
  static constexpr double slip_radius = 9.5e-6, sphere_radius = 535e-6, largest_radius = 3.5e-3;

  double viscosity, air_density, buoyant_density, mean_free_path;

  /// For air of a temperature (K) and a pressure (Pa). The viscosity is that of Rogers & Yau 1989.
  Beard1976(double temperature, double pressure)
      : viscosity(1.72e-5 * (393.0 / (temperature + 120.0)) * std::pow(temperature / 273.0, 1.5)),
        air_density(pressure / (gas_constant * temperature)),
        buoyant_density(drops::water_density - air_density),
        mean_free_path(6.62e-8 * (viscosity / 1.818e-5) * (101325.0 / pressure) *
                       std::sqrt(temperature / 293.15)) {}

  double operator()(double radius) const {
    if (!(radius > 0)) return 0;
    if (radius < sphere_radius) {
      const double slip = 1.0 + 1.255 * mean_free_path / radius;
      return radius < slip_radius ? slip * stokes(radius) : slip * of_sphere(radius);
    }
    return of_flattened_drop(std::min(radius, largest_radius));
  }

 private:
  double stokes(double radius) const {
    return buoyant_density * gravity * radius * radius / (4.5 * viscosity);
  }
  double of_sphere(double radius) const {
    static constexpr std::array<double, 7> fit = {-3.18657,    0.992696,   -1.53193e-3, -9.87059e-4,
                                                  -5.78878e-4, 8.55176e-5, -3.27815e-6};
    const double best = 32.0 * radius * radius * radius * air_density * buoyant_density * gravity /
                        (3.0 * viscosity * viscosity);
    return viscosity * std::exp(polynomial(fit, std::log(best))) / (2.0 * radius * air_density);
  }
  double of_flattened_drop(double radius) const {
    static constexpr std::array<double, 6> fit = {-5.00015, 5.23778,    -2.04914,
                                                  0.475294, -0.0542819, 2.38449e-3};
    const double weight = buoyant_density * gravity;
    const double bond = 16.0 / 3.0 * weight * radius * radius / surface_tension;
    const double square = viscosity * viscosity;
    const double property = std::pow(surface_tension * surface_tension * surface_tension *
                                         air_density * air_density / (square * square * weight),
                                     1.0 / 6.0);
    return viscosity * property * std::exp(polynomial(fit, std::log(bond * property))) /
           (2.0 * radius * air_density);
  }
};

/// Beard (1977, doi:10.1175/1520-0469(1977)034<1293:TVAFCA>2.0.CO;2): ln v (cm s-1) as polynomials
/// in ln D (cm), at 20 °C and 1013 hPa; diameters beyond 7 mm fall like 7 mm.
inline double beard_1977(double radius) {
  static constexpr std::array<double, 4> small = {10.5035, 1.08750, -0.133245, -0.00659969};
  static constexpr std::array<double, 8> large = {6.5639,   -1.0391,   -1.4001,   -0.82736,
                                                  -0.34277, -0.083072, -0.010583, -5.4208e-4};
  // The polynomial of small drops was made for D from 1 µm; below, drops fall like Stokes' spheres.
  constexpr double smallest = 0.5e-6, join = 20e-6, largest = 3.5e-3;
  if (!(radius > 0)) return 0;
  const double fitted = std::clamp(radius, smallest, largest);
  const double x = std::log(200.0 * fitted);
  const double speed =
      0.01 * std::exp(fitted <= join ? polynomial(small, x) : polynomial(large, x));
  return radius < smallest ? speed * (radius / smallest) * (radius / smallest) : speed;
}

/// Measurements of Gunn & Kinzer (1949, doi:10.1175/1520-0469(1949)006<0243:TTVOFF>2.0.CO;2) at
/// 20 °C and 1013 hPa, linear between them; the largest drop's speed beyond. They begin at a
/// diameter of 0.1 mm; up to 0.06 mm drops fall as Beard (1977) has it.
inline double gunn_kinzer(double radius) {
  static constexpr std::size_t points = 12;
  static constexpr std::array<double, points> diameter = {1e-4,   2e-4, 4e-4, 6e-4, 8e-4, 1e-3,
                                                          1.6e-3, 2e-3, 3e-3, 4e-3, 5e-3, 5.8e-3};
  static constexpr std::array<double, points> speed = {0.27, 0.72, 1.62, 2.47, 3.27, 4.03,
                                                       5.65, 6.49, 8.06, 8.83, 9.09, 9.17};
  constexpr double join = 0.6e-4;
  const double d = 2.0 * radius;
  if (!(d > join)) return beard_1977(radius);
  if (d >= diameter.back()) return speed.back();
  double d0 = join, v0 = beard_1977(0.5 * join);
  std::size_t i = 0;
  for (; d > diameter[i]; ++i) {
    d0 = diameter[i];
    v0 = speed[i];
  }
  return v0 + (speed[i] - v0) * ((d - d0) / (diameter[i] - d0));
}

/// Rogers & Yau (1989), eqs 8.5, 8.6 and 8.8: Stokes' law, a linear range and a square root. The
/// speed more than doubles at 30 µm, which changes collision rates there by tens of per cent.
inline double rogers_yau(double radius) {
  if (!(radius > 0)) return 0;
  if (radius < 30e-6) return 1.19e8 * radius * radius;
  if (radius < 600e-6) return 8e3 * radius;
  return radius < 2e-3 ? 201.0 * std::sqrt(radius) : 9.0;
}

/// Simmel et al. (2002, doi:10.1016/S0169-8095(01)00131-4): powers of the mass (g).
inline double simmel(double radius) {
  if (!(radius > 0)) return 0;
  const double third = std::cbrt(4.0 / 3.0 * drops::pi) * 100.0 * radius;  // m^{1/3}, g^{1/3}
  if (radius < 67.215e-6) return 4579.5 * third * third;
  if (radius < 755.82e-6) return 49.62 * third;
  return radius < 1738.92e-6 ? 17.32 * std::sqrt(third) : 9.17;
}

/// Rogers et al. (1993), eq. 1: a short form for radars.
inline double rogers_1993(double radius) {
  const double d = 2e3 * std::max(radius, 0.0);  // mm
  return d <= 0.745 ? -4.0 * d * std::expm1(-12.0 * d) : 9.65 - 10.43 * std::exp(-0.6 * d);
}

/// Speed at which a drop of a radius (m) falls in air of a temperature (K) and a pressure (Pa),
/// m s-1; only `beard_1976` knows of the air.
inline double fall_speed(FallSpeedScheme scheme, double radius, double temperature,
                         double pressure) {
  switch (scheme) {
    case FallSpeedScheme::beard_1976:
      return Beard1976(temperature, pressure)(radius);
    case FallSpeedScheme::beard_1977:
      return beard_1977(radius);
    case FallSpeedScheme::gunn_kinzer:
      return gunn_kinzer(radius);
    case FallSpeedScheme::rogers_yau:
      return rogers_yau(radius);
    case FallSpeedScheme::simmel:
      return simmel(radius);
    case FallSpeedScheme::rogers_1993:
      return rogers_1993(radius);
    case FallSpeedScheme::none:
      break;
  }
  return 0;
}

}  // namespace pileus::superdroplets
