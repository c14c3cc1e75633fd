// What droplets see of moist air: its saturation ratio, Kelvin's length and how fast it lets grow.
#pragma once
#include <pileus/moist_air.hpp>

#include <algorithm>

#include "growth.hpp"
#include "koehler.hpp"

namespace pileus::superdroplets {

/// S = e/e_s and its slopes.
struct SaturationRatio {
  double value;
  double per_vapour;       // ∂S/∂q_v
  double per_temperature;  // ∂S/∂T, K-1
};

struct DropletAir {
  MoistAir air{};
  Accommodation accommodation{};
  bool kinetic = true;             // jump lengths of molecules
  double surface_tension = 0.072;  // N m-1; 0: no curvature effect

  double warming() const { return air.warming(); }
  double temperature(double theta, const Level& level) const {
    return air.temperature(theta, level);
  }

  /// For every argument: searches may look at vapour slightly below none and at very cold air.
  SaturationRatio saturation_ratio(double vapour, double temperature, double pressure) const {
    const bool ratio = air.measure == HumidityMeasure::mixing_ratio;
    const double epsilon = air.constants.epsilon, rest = ratio ? 1.0 : 1.0 - epsilon;
    const double q = std::max(vapour, -0.5 * epsilon);
    const double all = epsilon + rest * q;
    const numerics::ValueAndSlope saturated =
        thermo::saturation_pressure(std::max(temperature, coldest_air), air.formula);
    const double s = pressure * q / (all * saturated.value);
    return {s, pressure * epsilon / (all * all * saturated.value),
            -s * saturated.slope / saturated.value};
  }

  /// Bounded from below, so that quotients by it exist.
  double kelvin(double temperature) const {
    return std::max(1e-100, kelvin_length(std::max(temperature, coldest_air),
                                          air.vapour_gas_constant(), surface_tension));
  }
  Conductance conductance(double temperature, double pressure) const {
    const double t = std::max(temperature, coldest_air);
    const double e = thermo::saturation_pressure(t, air.formula).value;
    return superdroplets::conductance(growth_air(t, pressure, e, air.constants), accommodation,
                                      kinetic);
  }
};

}  // namespace pileus::superdroplets
