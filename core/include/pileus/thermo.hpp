// Constants and formulas of moist air at a point: values in, values out, SI throughout.
#pragma once
#include <cmath>

#include "numerics.hpp"

namespace pileus::thermo {

/// Pressure at which potential temperature equals temperature, Pa.
inline constexpr double reference_pressure = 1.0e5;
/// Factor of vapour in the virtual temperature, R_v/R_d − 1 as used with `epsilon` = 0.622.
inline constexpr double virtual_factor = 0.608;

/// The constants a moist scheme depends on. Cloud base moves by tens of metres between published
/// sets, so each is a parameter. Defaults: those of the LES intercomparisons (Siebesma et al.
/// 2003, doi:10.1175/1520-0469(2003)60<1201:ALESIS>2.0.CO;2, with Bolton's saturation pressure).
struct Constants {
  double gravity = 9.81;                 // m s-2
  double gas_constant_dry_air = 287.04;  // J kg-1 K-1
  double heat_capacity = 1005.0;         // of dry air at constant pressure, J kg-1 K-1
  double latent_heat = 2.5e6;            // of vaporisation, J kg-1
  double epsilon = 0.622;                // R_d/R_v

  double kappa() const { return gas_constant_dry_air / heat_capacity; }
};

/// Saturation vapour pressure over liquid water and its slope, Pa and Pa K-1.
///
/// Source   Bolton (1980, doi:10.1175/1520-0493(1980)108<1046:TCOEPT>2.0.CO;2) eq. 10, 0.3 % from
///          −35 to 35 °C, with 611.2 Pa at the freezing point
/// Requires T > 29.65 K
inline numerics::ValueAndSlope saturation_pressure(double temperature) {
  constexpr double at_freezing = 611.2, freezing = 273.15, slope = 17.67, pole = 29.65;
  const double above_pole = temperature - pole;
  const double pressure = at_freezing * std::exp(slope * (temperature - freezing) / above_pole);
  return {pressure, pressure * slope * (freezing - pole) / (above_pole * above_pole)};
}

/// Published fits of the saturation vapour pressure over liquid water. They differ by 0.5 % at 25
/// °C and by 3.5 % at −40 °C: runs of different fits are not comparable below that.
enum class SaturationFormula {
  bolton,      // Bolton 1980, eq. 10; −35 to 35 °C
  tetens,      // Tetens 1930 in the form of Murray 1967; −20 to 50 °C
  magnus,      // Alduchov & Eskridge 1996 (AERK); −40 to 50 °C
  buck,        // Buck 1996; −80 to 50 °C
  murphy_koop  // Murphy & Koop 2005, eq. 10 (doi:10.1256/qj.04.94); 123 to 332 K
};

/// The same by a formula of choice. Requires a temperature above the formula's pole (at most 36 K).
inline numerics::ValueAndSlope saturation_pressure(double temperature, SaturationFormula formula) {
  constexpr double freezing = 273.15;
  const double t = temperature - freezing;
  // a exp(b t/(T − pole)) has the slope e b (273.15 − pole)/(T − pole)².
  const auto rational = [&](double a, double b, double pole) -> numerics::ValueAndSlope {
    const double above = temperature - pole;
    const double e = a * std::exp(b * t / above);
    return {e, e * b * (freezing - pole) / (above * above)};
  };
  switch (formula) {
    case SaturationFormula::tetens:
      return rational(610.78, 17.2693882, 35.86);
    case SaturationFormula::magnus:
      return rational(610.94, 17.625, freezing - 243.04);
    case SaturationFormula::buck: {
      // From 1108 K on this fit falls. What is as hot is no air, but searches may look there.
      constexpr double hottest = 1000.0;
      if (temperature > hottest) return {saturation_pressure(hottest, formula).value, 0.0};
      const double above = 257.14 + t, factor = 18.678 - t / 234.5;
      const double e = 611.21 * std::exp(factor * t / above);
      return {e, e * ((factor - t / 234.5) / above - factor * t / (above * above))};
    }
    case SaturationFormula::murphy_koop: {
      const double log_t = std::log(temperature), inverse = 1.0 / temperature;
      const double step = std::tanh(0.0415 * (temperature - 218.8));
      const double cold = 53.878 - 1331.22 * inverse - 9.44523 * log_t + 0.014025 * temperature;
      const double e = std::exp(54.842763 - 6763.22 * inverse - 4.21 * log_t +
                                0.000367 * temperature + step * cold);
      const double slope = 6763.22 * inverse * inverse - 4.21 * inverse + 0.000367 +
                           0.0415 * (1.0 - step * step) * cold +
                           step * (1331.22 * inverse * inverse - 9.44523 * inverse + 0.014025);
      return {e, e * slope};
    }
    case SaturationFormula::bolton:
      break;
  }
  return saturation_pressure(temperature);
}

/// Saturation specific humidity ε e/(p − (1−ε) e) and its slope in T, from those of e.
///
/// Above the boiling point (e ≥ p) only vapour is left: the value is 1 and the slope 0, so that
/// the function stays increasing and finite for every temperature.
inline numerics::ValueAndSlope saturation_specific_humidity(numerics::ValueAndSlope vapour,
                                                            double pressure, double epsilon) {
  if (vapour.value >= pressure) return {1.0, 0.0};
  const double rest = pressure - (1.0 - epsilon) * vapour.value;
  return {epsilon * vapour.value / rest, epsilon * pressure * vapour.slope / (rest * rest)};
}

/// Saturation mixing ratio ε e/(p − e), kg of vapour per kg of dry air, and its slope in T.
///
/// Next to the boiling point and above it (e ≥ 0.99 p) the value is the one at 0.99 p and the slope
/// 0, so that the function stays increasing and finite for every temperature.
inline numerics::ValueAndSlope saturation_mixing_ratio(numerics::ValueAndSlope vapour,
                                                       double pressure, double epsilon) {
  constexpr double boiling = 0.99;
  if (vapour.value >= boiling * pressure) return {epsilon * boiling / (1.0 - boiling), 0.0};
  const double rest = pressure - vapour.value;
  return {epsilon * vapour.value / rest, epsilon * pressure * vapour.slope / (rest * rest)};
}

/// Exner function (p/p_00)^κ.
inline double exner(double pressure, double kappa) {
  return std::pow(pressure / reference_pressure, kappa);
}

/// Pressure of an Exner function, Pa.
inline double pressure_of_exner(double exner, double kappa) {
  return reference_pressure * std::pow(exner, 1.0 / kappa);
}

/// Virtual potential temperature θ(1 + 0.608 q_v − q_l), K: density of the mixture, its liquid
/// included, as a temperature.
inline double virtual_potential_temperature(double theta, double vapour, double liquid) {
  return theta * (1.0 + virtual_factor * vapour - liquid);
}

}  // namespace pileus::thermo
