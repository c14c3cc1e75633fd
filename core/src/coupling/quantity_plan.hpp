// Which quantities the parcels carry, because operators or the initial state declare them.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "coupling/operator_entry.hpp"
#include "coupling/surface_fields.hpp"
#include "parcels/store.hpp"

namespace pileus::coupling {

/// The quantity the dynamics need: derived by an operator, or else carried by the parcels.
inline constexpr const char* buoyancy_name = "buoyancy";
/// Read-only quantities of the core that go by a name of their own.
inline constexpr const char* height_name = "height";  // of the parcel's centre, m
inline constexpr const char* volume_name = "parcel_volume";
/// The height when the operators last advanced the parcel, m: kept by the core where an operator
/// declares it, and merged like a position. An operator may set it to the present height for the
/// parcels whose ascent it has accounted for.
inline constexpr const char* previous_height_name = "previous_height";

/// Where an item is: its height above its parcel's centre over the parcel's vertical half-extent.
inline constexpr const char* height_within_parcel_name = "height_within_parcel";

/// What the sequence of operators asks of the parcels.
struct QuantityPlan {
  std::vector<parcels::Scalar> scalars;  // in the order of their declaration
  std::vector<SurfaceQuantity> surface;  // likewise
  parcels::ItemDeclaration items;     // of the lists that parcels own; none: without multiplicity
  std::vector<std::size_t> closures;  // operators with diagnose, providers before readers
};

/// Works out the union of the declared quantities that exist in this run.
///
/// `initial` are the scalars the scene's initial state sets. Rules: names are registered and their
/// units are the registered ones; a quantity has one owner; derived quantities are not set by the
/// initial state; what is read is owned or set; natures and budgets agree; closures form no ring.
/// Quantities of the surface: any number of global operators may add to one, anybody may read it.
///
/// Errors  Error(ExitCode::usage) with every violation, each naming operator, quantity and remedy
QuantityPlan plan_quantities(const std::vector<OperatorEntry>& operators,
                             const std::vector<std::string>& initial);

/// True if `name` is a column every store has (position, volume, vorticity, shape) in some
/// dimension, or one of the two names above.
bool is_core_quantity(std::string_view name);

/// Column of a quantity in a store, or −1.
int find_column(const parcels::Store& store, std::string_view name);

}  // namespace pileus::coupling
