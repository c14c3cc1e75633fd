// The air a parcel's water exchanges heat and vapour with: saturation at a temperature and
// pressure.
#pragma once
#include <algorithm>

#include "reference_state.hpp"
#include "thermo.hpp"

namespace pileus {

enum class HumidityMeasure { specific_humidity, mixing_ratio };

/// Where a parcel is: the reference state at its height.
struct Level {
  double pressure;    // Pa
  double exner;       // 1
  double prescribed;  // temperature of a prescribed profile, K; used only with it
};

/// Saturation at one temperature and pressure.
struct Saturation {
  double humidity;  // q_s, kg kg-1
  double slope;     // dq_s/dT, K-1
  double pressure;  // of vapour, e_s, Pa
};

/// Temperatures below this are no air the formulas are meant for, K.
inline constexpr double coldest_air = 100.0;

struct MoistAir {
  thermo::Constants constants;
  thermo::SaturationFormula formula = thermo::SaturationFormula::bolton;
  HumidityMeasure measure = HumidityMeasure::specific_humidity;
  bool prescribed_temperature = false;  // no latent heating; temperature by height alone

  double vapour_gas_constant() const { return constants.gas_constant_dry_air / constants.epsilon; }
  /// Warming by condensing one kg per kg of air, L/c_p, K; 0 for a prescribed temperature.
  double warming() const {
    return prescribed_temperature ? 0.0 : constants.latent_heat / constants.heat_capacity;
  }
  double temperature(double theta, const Level& level) const {
    return prescribed_temperature ? level.prescribed : level.exner * theta;
  }
  double density(double temperature, double pressure) const {
    return pressure / (constants.gas_constant_dry_air * temperature);
  }

  /// Below this, where the formulas have their poles and saturated air holds less than 1e-15 of
  /// vapour, it holds none: the search for an equilibrium may look there.
  Saturation saturation(double temperature, double pressure) const {
    if (!(temperature > coldest_air)) return {0, 0, 0};
    const numerics::ValueAndSlope e = thermo::saturation_pressure(temperature, formula);
    const numerics::ValueAndSlope q =
        measure == HumidityMeasure::specific_humidity
            ? thermo::saturation_specific_humidity(e, pressure, constants.epsilon)
            : thermo::saturation_mixing_ratio(e, pressure, constants.epsilon);
    return {q.value, q.slope, e.value};
  }

  /// −∂ ln q_s/∂ ln p at a saturation pressure e_s: p/(p − (1 − ε) e_s), or p/(p − e_s) as mixing
  /// ratio; cut where air is near boiling.
  double pressure_response(double saturation, double pressure) const {
    const double share =
        measure == HumidityMeasure::specific_humidity ? 1.0 - constants.epsilon : 1.0;
    return 1.0 / std::max(0.1, 1.0 - share * saturation / pressure);
  }

  /// Vapour pressure over its saturation value: e/e_s, with e of the humidity's measure.
  double relative_humidity(double vapour, double temperature, double pressure) const {
    if (vapour == 0) return 0;
    const double dry = measure == HumidityMeasure::specific_humidity ? 1.0 - vapour : 1.0;
    const double e = pressure * vapour / (constants.epsilon * dry + vapour);
    return e / thermo::saturation_pressure(temperature, formula).value;
  }

  /// What has condensed since the last call of apply if the excess of vapour has stayed as it was,
  /// as in steady ascent by `rise` to air of this temperature and pressure: the fall of q_s on the
  /// way over Γ. Clouds heat the air within a step by it and not one step later. Along the dry
  /// adiabat d ln q_s/dz = −(dq_s/dT)/q_s·(g/c_p)(θ/θ_v) + (−∂ ln q_s/∂ ln p) g/(R_d T_v), with θ_v
  /// and T_v of the reference state.
  double condensed_on_the_way(double rise, double theta, double temperature, double pressure,
                              const thermo::ReferenceState::Point& at) const {
    const Saturation s = saturation(temperature, pressure);
    if (prescribed_temperature || !(s.humidity > 0)) return 0;
    const thermo::Constants& c = constants;
    const double cooling = s.slope / s.humidity * c.gravity / c.heat_capacity * theta / at.theta_v;
    const double expansion = pressure_response(s.pressure, pressure) * c.gravity /
                             (c.gas_constant_dry_air * at.exner * at.theta_v);
    const double x = std::clamp(rise * (cooling - expansion), -1.0, 1.0);
    return s.humidity * x * (1.0 + 0.5 * x) / (1.0 + warming() * s.slope);
  }
};

}  // namespace pileus
