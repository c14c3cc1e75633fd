// What the forcing acts on, and in which budgets that counts.
#pragma once
#include <pileus/mixed_scalars.hpp>
#include <pileus/plugin.hpp>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <string_view>

#include "changes.hpp"

namespace pileus::large_scale {

constexpr std::size_t scalar_count = mixed_scalars.size();
/// Budgets in the order of the operator's list.
constexpr std::array<const char*, 4> budget_names = {"heat", "water", "droplets_and_aerosol",
                                                     "buoyancy"};

/// What kind of scalar one of mixed_scalars is.
struct ScalarTraits {
  Sharing sharing = Sharing::evenly;
  int budget = -1;           // position in budget_names; −1: none
  double low = 0, high = 0;  // admissible, where a budget is stated
};

constexpr ScalarTraits traits_of(std::string_view name) {
  if (name == "liquid_water_potential_temperature") return {Sharing::evenly, 0, 150.0, 2000.0};
  if (name == "total_water_mass_fraction" || name == "specific_humidity")
    return {Sharing::evenly_above_zero, 1, 0.0, 1.0};
  if (name == "mass_fraction_of_cloud_liquid_water_in_air" ||
      name == "mass_fraction_of_rain_in_air")
    return {Sharing::in_proportion, 1};
  if (name == "number_of_cloud_droplets_per_mass_of_air") return {Sharing::in_proportion, 2};
  if (name == "number_of_aerosol_particles_per_mass_of_air")
    return {Sharing::evenly_above_zero, 2, 0.0, 1e16};
  if (name == "number_of_raindrops_per_mass_of_air") return {Sharing::in_proportion};
  if (name == "liquid_water_buoyancy") return {Sharing::evenly, 3, -1e4, 1e4};
  if (name == "buoyancy") return {Sharing::evenly, 3};
  return {};
}

/// A component of the mean horizontal wind: its shear ∂u/∂z is `sign` times the mean of a component
/// of the vorticity (ξ = w_y − v_z, η = u_z − w_x; in the plane ζ = w_x − u_z).
struct WindComponent {
  std::size_t vorticity;  // position among Quantities::vorticity
  double sign;
};

struct Quantities {
  Slot height, volume, coriolis;
  std::array<Slot, scalar_count> scalar;
  std::array<Slot, 4> vorticity;  // of the plane; x, y and z of space
  std::array<Slot, 2> mean_wind;
  std::array<Budget, budget_names.size()> budget;

  void describe(Declaration& d) {
    height = d.reads("height", "m").doc("of the parcel's centre");
    volume = d.reads("parcel_volume", "m3").doc("weights the means of the levels");
    for (std::size_t b = 0; b < budget.size(); ++b) budget[b] = d.budget(budget_names[b]);
    for (std::size_t i = 0; i < scalar_count; ++i) describe_scalar(d, i);
    constexpr std::array<const char*, 4> names = {"vorticity", "x_vorticity", "y_vorticity",
                                                  "z_vorticity"};
    for (std::size_t i = 0; i < names.size(); ++i)
      vorticity[i] = d.updates(names[i], "s-1").optional().doc("holds the shear of the mean wind");
    mean_wind[0] = d.updates_domain("domain_mean_x_velocity", "m s-1");
    mean_wind[1] = d.updates_domain("domain_mean_y_velocity", "m s-1");
    coriolis = d.reads_domain("coriolis_parameter", "s-1").when("geostrophic == true");
  }

  static bool is_plane(const Block& block) { return block.raw().grid->dimension == 2; }
  static std::size_t wind_components(const Block& block) { return is_plane(block) ? 1 : 2; }
  static WindComponent wind(const Block& block, std::size_t component) {
    if (is_plane(block)) return {0, -1.0};
    return component == 0 ? WindComponent{2, 1.0} : WindComponent{1, -1.0};
  }

  /// Position of the first of the named scalars that the run carries, or −1.
  int first_carried(const Block& block, std::initializer_list<std::string_view> names) const {
    for (const std::string_view name : names)
      for (std::size_t i = 0; i < scalar_count; ++i)
        if (name == mixed_scalars[i].name && block.has(scalar[i])) return static_cast<int>(i);
    return -1;
  }

 private:
  void describe_scalar(Declaration& d, std::size_t i) {
    const ScalarTraits traits = traits_of(mixed_scalars[i].name);
    auto row = d.updates(mixed_scalars[i].name, mixed_scalars[i].units)
                   .optional()
                   .doc("forced if carried");
    const char* name =
        traits.budget >= 0 ? budget_names[static_cast<std::size_t>(traits.budget)] : nullptr;
    // What some runs derive has nature and range from its owner.
    if (traits.low == traits.high) {
      if (name != nullptr) row.counts_in(name);
    } else {
      row.intensive(name).range(traits.low, traits.high);
    }
    scalar[i] = row;
  }
};

/// The scalars that take the given tendencies; −1: none does.
struct Receivers {
  int temperature, water, buoyancy;

  Receivers(const Quantities& quantities, const Block& block)
      : temperature(quantities.first_carried(
            block, {"liquid_water_potential_temperature", "air_potential_temperature"})),
        water(quantities.first_carried(block, {"total_water_mass_fraction", "specific_humidity"})),
        buoyancy(quantities.first_carried(block, {"liquid_water_buoyancy", "buoyancy"})) {}
};

}  // namespace pileus::large_scale
