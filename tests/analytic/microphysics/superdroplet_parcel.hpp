// A parcel with superdroplets that moves vertically through its own hydrostatic pressure.
#pragma once
#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "../../../plugins/superdroplets/aerosol_sampling.hpp"
#include "../../../plugins/superdroplets/condensation.hpp"

namespace pileus::superdroplets {

/// The constants of the EPIC model (Frey et al. 2023, doi:10.1016/j.jcpx.2023.100136).
inline constexpr thermo::Constants epic{9.80616, 287.05, 1005.7, 2.501e6, 287.05 / 461.5};

inline DropletAir epic_air() {
  DropletAir air;
  air.air.constants = epic;
  air.air.measure = HumidityMeasure::mixing_ratio;
  return air;
}

inline Level level_of(double pressure) {
  return {pressure, thermo::exner(pressure, epic.kappa()), 0};
}

/// One kg of air and its droplets.
struct Parcel {
  Level level{};
  Air air{};
  std::vector<double> water, dry, hygroscopic;
  std::vector<std::int64_t> multiplicity;
  std::vector<double> scratch;

  Parcel(double pressure, double temperature, double humidity) : level(level_of(pressure)) {
    const double e = humidity * thermo::saturation_pressure(temperature).value;
    air = {temperature / level.exner, epic.epsilon * e / (pressure - e)};
  }

  double temperature() const { return air.theta * level.exner; }
  double kelvin() const { return kelvin_length(temperature(), 461.5, 0.072); }
  double liquid() const { return total_water(multiplicity, water); }
  double radius(std::size_t i) const { return wet_radius(water[i], dry[i]); }
  Particle particle(std::size_t i) const { return {dry[i], hygroscopic[i]}; }
  double supersaturation() const {
    return epic_air().saturation_ratio(air.vapour, temperature(), level.pressure).value - 1.0;
  }

  void add(const Superdroplet& s) {
    water.push_back(s.water_mass);
    dry.push_back(s.dry_volume);
    hygroscopic.push_back(s.hygroscopic_volume);
    multiplicity.push_back(s.multiplicity);
    scratch.resize(Condensation::scratch_per_droplet * water.size());
  }
  /// One kind of particle, in equilibrium at a saturation ratio.
  void add(std::int64_t number, double dry_radius, double kappa, double saturation) {
    const double volume = volume_of_radius(dry_radius);
    const Particle p{volume, kappa * volume};
    add({number, equilibrium_water(saturation, p, kelvin()), volume, p.hygroscopic_volume});
  }
  Droplets droplets() { return {water, multiplicity, dry, hygroscopic}; }

  Outcome advance(const Condensation& scheme, const Level& to, double dt) {
    const Outcome did = scheme.advance(air, droplets(), 1.0, level, to, dt, scratch);
    level = to;
    return did;
  }
  /// dp/dz = −p g/(R_d T), the midpoint of the step.
  Level above(double rise) const {
    const double middle = temperature() - 0.5 * epic.gravity * rise / epic.heat_capacity;
    return level_of(level.pressure *
                    std::exp(-epic.gravity * rise / (epic.gas_constant_dry_air * middle)));
  }
};

}  // namespace pileus::superdroplets
