// By how much the fall of a parcel's drops speeds up their growth.
#pragma once
#include <pileus/drops.hpp>
#include <pileus/thermo.hpp>

#include <cstddef>
#include <span>

#include "condensation.hpp"
#include "fall_speed_table.hpp"
#include "growth.hpp"

namespace pileus::superdroplets {

class VentilatedDrops {
 public:
  /// Factors of growth of the droplets into `room` (one per droplet); empty where all are so small
  /// that they have none to speak of.
  ///
  /// Fall speeds are those of Beard (1976) in air of 1013.25 hPa and 20 °C; ν = η/ρ of the present
  /// air.
  std::span<const double> factors(const Droplets& droplets, double temperature, double pressure,
                                  const thermo::Constants& constants,
                                  std::span<double> room) const {
    const std::size_t n = droplets.water_mass.size();
    double heaviest = 0;
    for (const double mass : droplets.water_mass) heaviest = heaviest > mass ? heaviest : mass;
    if (!(heaviest > least_mass)) return {};
    const double density = pressure / (constants.gas_constant_dry_air * temperature);
    const double kinematic = drops::dynamic_viscosity(temperature) / density;
    const double schmidt = kinematic / drops::vapour_diffusivity(temperature, pressure);
    for (std::size_t i = 0; i < n; ++i) {
      const double mass = droplets.water_mass[i];
      room[i] = 1.0;
      if (!(mass > least_mass)) continue;
      const RadiusAndSpeed drop = table_(mass);
      room[i] = ventilation(schmidt, 2.0 * drop.radius * drop.speed / kinematic);
    }
    return room.first(n);
  }

 private:
  static constexpr double least_mass = 4.2e-12;  // kg; a drop of 10 µm gains 0.1 % by its fall

  FallSpeedTable table_{FallSpeedScheme::beard_1976, 293.15, 101325.0};
};

}  // namespace pileus::superdroplets
