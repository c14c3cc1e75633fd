// An operator instance bound to the columns of a parcel store.
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "coupling/item_extension.hpp"
#include "coupling/mesh_extension.hpp"
#include "coupling/mesh_quantities.hpp"
#include "coupling/operator_entry.hpp"
#include "coupling/surface_fields.hpp"
#include "host/instance.hpp"
#include "parcels/store.hpp"

namespace pileus::coupling {

/// A declared quantity and the column of the store, the surface field or the place on the mesh it
/// stands for.
struct BoundSlot {
  int column = -1;           // −1: no quantity of the parcels, or it does not exist in this run
  int surface = -1;          // position among the surface fields; −1: none of them
  int item = -1;             // of items: 0 the multiplicity, c + 1 column c; −1: none of them
  MeshSlot mesh;             // of places on the mesh
  double* domain = nullptr;  // the number of the domain, where it is one
  bool derived = false;      // written by diagnose; every other writable slot by apply
  bool writable = false;
  bool withheld = false;   // exists, but its effect waits to be switched on
  bool on_demand = false;  // derived, and nobody reads it within a step
  double low = 0, high = 0;

  /// Whether an activity condition can look at it.
  bool is_compared() const { return column >= 0 || item >= 0; }
};

/// A comparison of an activity condition with its number filled in.
struct BoundCondition {
  std::size_t slot = 0;
  int column = -1;  // −1: one of items
  std::uint32_t clause = 0, comparison = 0;
  double value = 0;
  int item = -1;  // as in BoundSlot; holds if it holds for one of the parcel's items
};

/// A written quantity that belongs to a budget.
struct BudgetedSlot {
  std::size_t written = 0;  // position in `written`
  std::size_t budget = 0;   // position in the operator's budgets
  bool per_volume = false;  // intensive: the amount is volume times value
};

/// The same of items: the amount is multiplicity times value over the scale of the lists.
struct BudgetedItems {
  int item = 0;            // as in BoundSlot
  std::size_t budget = 0;  // position in the operator's budgets
};

struct BoundOperator {
  const OperatorEntry* entry = nullptr;
  std::unique_ptr<host::Instance> instance;
  std::uint32_t stream = 0;
  std::vector<BoundSlot> slots;             // by slot number
  std::vector<std::size_t> written;         // slots that apply writes
  std::vector<std::size_t> derived;         // slots that diagnose writes
  std::vector<std::size_t> accumulated;     // slots of the surface that apply changes
  std::vector<std::size_t> written_domain;  // slots of the domain that apply writes
  std::vector<std::size_t> written_items;   // slots of items that apply writes
  std::vector<int> kept_items;              // what of items has to be put back after a rejection
  std::vector<BoundCondition> conditions;   // sorted by clause; empty: always active
  std::vector<BudgetedSlot> budgeted;
  std::vector<BudgetedItems> budgeted_items;
  /// Whose change makes diagnose or the conditions stale: columns of the store, and the surface
  /// fields and the quantities of items counted on from there.
  std::vector<int> read_columns;
  bool dormant = false;          // not called: all its effects wait to be switched on
  bool idle = false;             // apply is not called: no clause of its activity can hold
  std::vector<MeshSlot> mesh;    // to be made before its hooks are called
  bool moves_parcels = false;    // apply writes positions
  bool deforms_parcels = false;  // apply writes shapes
  bool creates_items = false;    // owns them
  bool resizes_items = false;    // apply may give parcels other items

  const pileus_operator& op() const { return entry->table->op; }
  bool is_local() const { return op().scope == PILEUS_LOCAL; }
};

/// What one closure derives and another reads is needed within a step, too, and so is the buoyancy.
void keep_what_closures_read(std::vector<BoundOperator>& operators);

/// Takes over which effects of the entry are on: at the start, and when one is switched on.
void follow_effects(BoundOperator& bound);

/// Positions among the versions of a run: columns, surface fields, quantities of items.
inline int version_of_surface(const parcels::Store& store, int field) {
  return store.column_count() + field;
}
inline int version_of_item(const parcels::Store& store, const SurfaceFields& surface, int item) {
  return store.column_count() + static_cast<int>(surface.list().size()) + item;
}
/// Number of quantities of items, the multiplicity included.
inline int item_quantities(const parcels::Store& store) {
  return store.items().exist() ? 1 + static_cast<int>(store.items().declaration().columns.size())
                               : 0;
}

/// What of the model operators are bound to besides parcels and surface; null where there is none.
struct BoundMesh {
  MeshQuantities* quantities = nullptr;
  const MeshExtension* extension = nullptr;  // for operators of global scope
  const ItemExtension* items = nullptr;      // for those that make or move items
};

/// Binds an operator to the store's columns, to the surface and to the mesh.
/// Errors  Error(ExitCode::usage) if a quantity has no column in this store (y_position in 2D), or
///         the scope is not offered
BoundOperator bind_operator(const OperatorEntry& entry, const parcels::Store& store,
                            const SurfaceFields& surface, const BoundMesh& mesh,
                            std::uint32_t stream, bool (*stop)());

}  // namespace pileus::coupling
