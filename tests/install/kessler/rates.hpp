// Kessler's warm rain at a point: the rates of Klemp & Wilhelmson (1978, KW below,
// doi:10.1175/1520-0469(1978)035<1070:TSOTDC>2.0.CO;2), which follow Kessler (1969), in SI units.
#pragma once
#include <pileus/drops.hpp>

#include <algorithm>
#include <cmath>

namespace kessler {

/// Autoconversion, s-1: A_r = k1 (q_c − a), KW eq. 2.13a: 1e-3 s-1 beyond 1 g kg-1.
inline double autoconversion(double cloud, double threshold, double rate) {
  return std::max(0.0, rate * (cloud - threshold));
}

/// Accretion over the cloud, s-1: C_r/q_c = k2 q_r^0.875, KW eq. 2.13b with k2 = 2.2 s-1.
inline double accretion_rate(double rain, double coefficient) {
  return rain > 0 ? coefficient * std::pow(rain, 0.875) : 0.0;
}

/// Cloud that dt of autoconversion alone turns into rain: the exact solution.
inline double converted(double cloud, double threshold, double rate, double dt) {
  return cloud > threshold ? -std::expm1(-rate * dt) * (cloud - threshold) : 0.0;
}

/// Cloud that dt of both turns into rain: accretion between two halves of autoconversion, by the
/// rain there is half way. Second order in dt, positive and stable for any step; the amount and not
/// what is left, of which the first rain in a cloud would have the rounding.
///
/// Ensures   0 for dt = 0; between 0 and cloud
inline double collected(double cloud, double rain, double threshold, double rate,
                        double coefficient, double dt) {
  if (!(cloud > 0) || dt == 0) return 0.0;
  const double first = converted(cloud, threshold, rate, 0.5 * dt), rest = cloud - first;
  const auto swept = [&](double by) { return -std::expm1(-accretion_rate(by, coefficient) * dt); };
  const double predicted = rest * swept(rain + first);
  const double middle = rest * swept(rain + first + 0.5 * predicted);
  const double last = converted(rest - middle, threshold, rate, 0.5 * dt);
  return std::min(cloud, first + middle + last);
}

/// Ventilation factor of rain, C = 1.6 + 124.9 (ρ q_r)^0.2046 with ρ q_r in g cm-3, KW eq. 2.14b.
inline double ventilation(double rain_density_cgs) {
  return 1.6 + 124.9 * std::pow(rain_density_cgs, 0.2046);
}

/// Evaporation of rain per deficit of vapour, E_r/(q_vs − q_v), s-1, KW eq. 2.14a:
///
///   E_r = (1/ρ) (1 − q_v/q_vs) C (ρ q_r)^0.525 / (5.4e5 + 2.55e6/(p q_vs))
///
/// in their units g cm-3 and hPa. Density in kg m-3, pressure in Pa.
inline double evaporation_rate(double rain, double saturation, double density, double pressure) {
  if (!(rain > 0) || !(saturation > 0)) return 0.0;
  const double density_cgs = 1e-3 * density, hectopascal = 1e-2 * pressure;
  const double held = density_cgs * rain;
  const double diffusion = 5.4e5 + 2.55e6 / (hectopascal * saturation);
  return ventilation(held) * std::pow(held, 0.525) / (diffusion * density_cgs * saturation);
}

/// Rain that evaporates in dt into air with a deficit of vapour, kg kg-1. Evaporation moistens and
/// cools the air, which closes the deficit by 1 + (L/c_p) dq_s/dT =: Γ of every unit; with the rate
/// of the start it relaxes exponentially and never beyond saturation. At most the rain there is.
inline double evaporated(double rain, double deficit, double rate, double gamma, double dt) {
  if (!(deficit > 0) || !(rain > 0)) return 0.0;
  return std::min(rain, -std::expm1(-rate * gamma * dt) * deficit / gamma);
}

/// Drops of Marshall & Palmer's exponential distribution with the intercept N_0 (m-4), per kg of
/// air: n = N_0/(ρ λ), λ = (π ρ_w N_0/(ρ q_r))^{1/4}. With it Kessler's rain falls in schemes that
/// take the size of drops from mass and number.
inline double raindrops(double rain, double density, double intercept) {
  if (!(rain > 0)) return 0.0;
  const double slope = std::sqrt(
      std::sqrt(pileus::drops::pi * pileus::drops::water_density * intercept / (density * rain)));
  return intercept / (density * slope);
}

}  // namespace kessler
