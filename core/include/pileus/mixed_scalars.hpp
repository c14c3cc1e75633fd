// The registered scalars that parcels may carry and that mixing exchanges in proportion to volume.
#pragma once
#include <array>

namespace pileus {

struct MixedScalar {
  const char *name, *units;
};

/// Amounts per volume or mass of air: a mixture holds their volume-weighted mean. An operator that
/// mixes declares them as optional and finds those the run carries.
inline constexpr std::array<MixedScalar, 12> mixed_scalars = {
    {{"liquid_water_buoyancy", "m s-2"},
     {"buoyancy", "m s-2"},
     {"liquid_water_potential_temperature", "K"},
     {"air_potential_temperature", "K"},
     {"total_water_mass_fraction", "1"},
     {"specific_humidity", "1"},
     {"mass_fraction_of_cloud_liquid_water_in_air", "1"},
     {"mass_fraction_of_rain_in_air", "1"},
     {"number_of_cloud_droplets_per_mass_of_air", "kg-1"},
     {"number_of_aerosol_particles_per_mass_of_air", "kg-1"},
     {"number_of_raindrops_per_mass_of_air", "kg-1"},
     {"passive_tracer", "1"}}};

}  // namespace pileus
