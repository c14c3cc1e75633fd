// The quantities of superdroplets, as all operators of this library declare them.
#pragma once
namespace pileus::superdroplets {

inline constexpr const char* multiplicity_name = "droplet_multiplicity";
inline constexpr const char* water_mass_name = "droplet_water_mass";
inline constexpr const char* dry_volume_name = "droplet_dry_volume";
inline constexpr const char* hygroscopic_volume_name = "droplet_hygroscopic_volume";
inline constexpr const char* height_name = "height_within_parcel";

inline constexpr const char* water_budget = "water";
inline constexpr const char* aerosol_budget = "dry_aerosol";

/// Beyond these a state is broken. Kernels made for mathematics may put all the water of a cloud
/// into one drop.
inline constexpr double heaviest_drop = 1e9;     // kg
inline constexpr double largest_particle = 1e6;  // m3
/// Sums of multiplicities stay below 2^63.
inline constexpr double largest_multiplicity = 1e18;

}  // namespace pileus::superdroplets
