// A parcel that rises adiabatically at constant speed through its own hydrostatic pressure.
#pragma once
#include <cmath>

#include "../../../plugins/two_moment/condensation.hpp"

namespace pileus::two_moment {

/// The constants of the EPIC model (Frey et al. 2023, doi:10.1016/j.jcpx.2023.100136).
inline constexpr thermo::Constants epic{9.80616, 287.05, 1005.7, 2.501e6, 287.05 / 461.5};

inline MoistAir epic_air() {
  MoistAir air;
  air.constants = epic;
  air.measure = HumidityMeasure::mixing_ratio;
  return air;
}

/// 1000 cm-3 of 50 nm with a deviation of 2 and κ = 0.61, at 900 hPa, 10 °C and 98 %.
struct Ascent {
  static constexpr double pressure = 9e4, temperature = 283.15, humidity = 0.98;
  MoistAir air = epic_air();
  double density = pressure / (epic.gas_constant_dry_air * temperature);
  AerosolMode mode{1e9 / density, 50e-9, 2.0, 0.61};
  Aerosol aerosol{ActivationScheme::kappa_lognormal, {mode}, 0.072, 461.5};
  CondensationOptions options{};

  struct Result {
    double peak = 0, peak_time = 0;  // 1, s
    double number = 0;               // m-3 at the initial density
    double cloud = 0;                // kg kg-1
    double most_aerosol_error = 0;   // of n_a + n_c, relative
    long substeps = 0;
    Water water{};
    Level level{};
  };

  Water start() const {
    Water w;
    const Level level{pressure, thermo::exner(pressure, epic.kappa()), 0};
    const double e = humidity * thermo::saturation_pressure(temperature).value;
    w.theta = temperature / level.exner;
    w.vapour = epic.epsilon * e / (pressure - e);
    if (options.aerosol_carried) w.aerosol = mode.number;
    return w;
  }

  /// dp/dz = −p g/(R_d T_v), T_v = T (1 + 0.608 q_v), the midpoint of each step.
  Result rise(double speed, double distance, double dt) const {
    const Condensation condensation(air, aerosol, options);
    Result result;
    Water w = start();
    Level from{pressure, thermo::exner(pressure, epic.kappa()), 0};
    const double total = w.aerosol + w.droplets;
    const long steps = std::lround(distance / speed / dt);
    for (long i = 0; i < steps; ++i) {
      const double rise = speed * dt;
      const double middle = from.exner * w.theta - 0.5 * epic.gravity * rise / epic.heat_capacity;
      const double p =
          from.pressure * std::exp(-epic.gravity * rise /
                                   (epic.gas_constant_dry_air * middle * (1 + 0.608 * w.vapour)));
      const Level to{p, thermo::exner(p, epic.kappa()), 0};
      const Actions did = condensation.advance(w, from, to, dt);
      result.substeps += did.substeps;
      if (did.peak > result.peak)
        result.peak = did.peak, result.peak_time = static_cast<double>(i + 1) * dt;
      if (total > 0)
        result.most_aerosol_error =
            std::max(result.most_aerosol_error, std::abs((w.aerosol + w.droplets) / total - 1.0));
      from = to;
    }
    result.number = w.droplets * density;
    result.cloud = w.cloud;
    result.water = w;
    result.level = from;
    return result;
  }
};

}  // namespace pileus::two_moment
