#include "coupling/bound_operator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <string_view>

#include "base/error.hpp"
#include "coupling/quantity_plan.hpp"

namespace pileus::coupling {
namespace {

/// Binds a quantity of the surface, which the plan has seen to exist.
void bind_surface_slot(BoundOperator& bound, std::size_t number, const parcels::Store& store,
                       const SurfaceFields& surface, BoundSlot& slot) {
  slot.surface = surface.find(bound.entry->table->quantities[number].name);
  if ((bound.entry->table->quantities[number].access & PILEUS_READ) != 0)
    bound.read_columns.push_back(version_of_surface(store, slot.surface));
  if (slot.writable) bound.accumulated.push_back(number);
}

/// Binds a number of the domain; in the plane there is less of them.
void bind_domain_slot(BoundOperator& bound, std::size_t number, const BoundMesh& mesh,
                      BoundSlot& slot) {
  if (mesh.quantities == nullptr) return;
  slot.domain = mesh.quantities->access().domain_value(bound.entry->table->quantities[number].name);
  if (slot.domain != nullptr && slot.writable) bound.written_domain.push_back(number);
}

[[noreturn]] void refuse_missing(const BoundOperator& bound, const pileus_quantity& row,
                                 const char* where) {
  throw Error(ExitCode::usage, fmt::format("operator '{}' needs '{}', which {} not have",
                                           bound.entry->name, row.name, where));
}

bool is_derived(const parcels::Store& store, int column) {
  const int scalar = column - store.first_scalar();
  return scalar >= 0 &&
         store.scalars()[static_cast<std::size_t>(scalar)].nature == parcels::Nature::derived;
}

bool is_shape(const parcels::Store& store, int column) {
  const int component = column - store.dimension() - 1 - store.vorticity_components();
  return component >= 0 && component < store.shape_components();
}

/// Column of a quantity on the parcels, −1 for an optional one that is not there: an optional
/// quantity to be written must be carried, for what is derived is not the operator's to change.
int find_parcel_column(const BoundOperator& bound, const pileus_quantity& row,
                       const parcels::Store& store) {
  // The plane has no y.
  const bool optional =
      (row.access & PILEUS_OPTIONAL) != 0 || row.name == std::string_view("y_position");
  const int column = find_column(store, row.name);
  if (column < 0 && !optional) {
    refuse_missing(
        bound, row,
        store.dimension() == 2 ? "parcels in 2 dimensions do" : "parcels in 3 dimensions do");
  }
  const bool writes = (row.access & PILEUS_WRITE) != 0;
  return column >= 0 && optional && writes && is_derived(store, column) ? -1 : column;
}

/// Binds a quantity of items, which the plan has seen to exist.
void bind_item_slot(BoundOperator& bound, std::size_t number, const parcels::Store& store,
                    const SurfaceFields& surface, BoundSlot& slot) {
  const parcels::ItemLists& items = store.items();
  const char* name = bound.entry->table->quantities[number].name;
  const bool counts = items.declaration().multiplicity == name;
  if (!counts && items.find_column(name) < 0) return;  // optional, and nobody brings it about
  slot.item = counts ? 0 : items.find_column(name) + 1;
  bound.read_columns.push_back(version_of_item(store, surface, slot.item));
  if (!slot.writable) return;
  bound.written_items.push_back(number);
  bound.kept_items.push_back(slot.item);
  const std::uint32_t access = bound.entry->table->quantities[number].access;
  if (counts && (access & PILEUS_CREATE) != 0) bound.creates_items = true;
}

/// Whoever gives parcels other items changes all quantities of them.
void bind_resizing(BoundOperator& bound, const parcels::Store& store) {
  bound.resizes_items =
      (bound.op().flags & PILEUS_RESIZES_ITEMS) != 0 && item_quantities(store) > 0;
  if (!bound.resizes_items) return;
  bound.kept_items.clear();
  for (int q = 0; q < item_quantities(store); ++q) bound.kept_items.push_back(q);
}

MeshSlot find_mesh_slot(const BoundOperator& bound, const pileus_quantity& row,
                        const parcels::Store& store, const BoundMesh& mesh) {
  MeshSlot slot;
  if (mesh.quantities != nullptr) {
    slot = mesh.quantities->add(row.name, find_column(store, row.name),
                                row.place == PILEUS_MESH_AT_PARCEL);
  }
  if (!slot.exists() && (row.access & PILEUS_OPTIONAL) == 0) {
    refuse_missing(bound, row, "the mesh of this run does");
  }
  return slot;
}

void bind_slots(BoundOperator& bound, const parcels::Store& store, const SurfaceFields& surface,
                const BoundMesh& mesh) {
  const host::OperatorTable& table = *bound.entry->table;
  for (std::size_t i = 0; i < table.quantities.size(); ++i) {
    const pileus_quantity& row = table.quantities[i];
    BoundSlot slot;
    // A range without ends still holds nothing infinite.
    slot.low = std::max(row.low, std::numeric_limits<double>::lowest());
    slot.high = std::min(row.high, std::numeric_limits<double>::max());
    slot.derived = row.nature == PILEUS_DERIVED;
    slot.on_demand = (row.access & PILEUS_ON_DEMAND) != 0;
    slot.writable = (row.access & (PILEUS_WRITE | PILEUS_CREATE | PILEUS_ADD)) != 0;
    const bool exists = bound.entry->exists(i);
    if (exists && row.place == PILEUS_SURFACE) {
      bind_surface_slot(bound, i, store, surface, slot);
    } else if (exists && row.place == PILEUS_DOMAIN) {
      bind_domain_slot(bound, i, mesh, slot);
    } else if (exists && row.place == PILEUS_ITEM) {
      if (item_quantities(store) > 0) bind_item_slot(bound, i, store, surface, slot);
    } else if (exists && row.place != PILEUS_PARCEL) {
      slot.mesh = find_mesh_slot(bound, row, store, mesh);
      if (slot.mesh.exists()) bound.mesh.push_back(slot.mesh);
    } else if (exists) {
      slot.column = find_parcel_column(bound, row, store);
    }
    if (slot.column >= 0) {
      if (!slot.derived) bound.read_columns.push_back(slot.column);
      if (slot.writable) (slot.derived ? bound.derived : bound.written).push_back(i);
      if (slot.writable && slot.column < store.dimension()) bound.moves_parcels = true;
      if (slot.writable && is_shape(store, slot.column)) bound.deforms_parcels = true;
    }
    bound.slots.push_back(slot);
  }
}

void bind_conditions(BoundOperator& bound) {
  const host::OperatorTable& table = *bound.entry->table;
  for (const pileus_condition& row : table.active_if) {
    const int slot = table.find_quantity(row.quantity);
    const BoundSlot& compared = bound.slots[static_cast<std::size_t>(slot)];
    if (!compared.is_compared()) continue;  // a clause on what does not exist: see below
    const double value = row.parameter != nullptr
                             ? bound.entry->values.numbers()[table.find_parameter(row.parameter)]
                             : row.value;
    bound.conditions.push_back({static_cast<std::size_t>(slot), compared.column, row.clause, row.op,
                                value, compared.item});
  }
  // A comparison with an absent quantity is false, so its whole clause is.
  for (const pileus_condition& row : table.active_if) {
    if (bound.slots[static_cast<std::size_t>(table.find_quantity(row.quantity))].is_compared())
      continue;
    std::erase_if(bound.conditions,
                  [&](const BoundCondition& c) { return c.clause == row.clause; });
  }
  std::stable_sort(
      bound.conditions.begin(), bound.conditions.end(),
      [](const BoundCondition& a, const BoundCondition& b) { return a.clause < b.clause; });
}

void bind_budgets(BoundOperator& bound) {
  const host::OperatorTable& table = *bound.entry->table;
  for (std::size_t w = 0; w < bound.written.size(); ++w) {
    const pileus_quantity& row = table.quantities[bound.written[w]];
    if (row.budget == nullptr) continue;
    const auto found = std::find(table.budgets.begin(), table.budgets.end(), row.budget);
    bound.budgeted.push_back({w, static_cast<std::size_t>(found - table.budgets.begin()),
                              row.nature != PILEUS_EXTENSIVE});
  }
  for (const std::size_t s : bound.written_items) {
    const pileus_quantity& row = table.quantities[s];
    if (row.budget == nullptr) continue;
    const auto found = std::find(table.budgets.begin(), table.budgets.end(), row.budget);
    bound.budgeted_items.push_back(
        {bound.slots[s].item, static_cast<std::size_t>(found - table.budgets.begin())});
  }
}

/// Whether every clause compares a quantity that the plugin is not given: then none holds.
bool is_idle(const BoundOperator& bound) {
  if (bound.entry->table->active_if.empty()) return false;
  const auto& conditions = bound.conditions;
  return std::all_of(conditions.begin(), conditions.end(), [&](const BoundCondition& own) {
    return std::any_of(conditions.begin(), conditions.end(), [&](const BoundCondition& c) {
      return c.clause == own.clause && bound.slots[c.slot].withheld;
    });
  });
}

}  // namespace

void keep_what_closures_read(std::vector<BoundOperator>& operators) {
  const auto is_read = [&](int column) {
    return std::any_of(operators.begin(), operators.end(), [&](const BoundOperator& reader) {
      return reader.op().diagnose != nullptr &&
             std::find(reader.read_columns.begin(), reader.read_columns.end(), column) !=
                 reader.read_columns.end();
    });
  };
  for (BoundOperator& bound : operators)
    for (std::size_t i = 0; i < bound.slots.size(); ++i) {
      BoundSlot& slot = bound.slots[i];
      const bool drives_the_flow =
          std::string_view(bound.entry->table->quantities[i].name) == buoyancy_name;
      slot.on_demand =
          slot.on_demand && slot.column >= 0 && !drives_the_flow && !is_read(slot.column);
    }
}

void follow_effects(BoundOperator& bound) {
  bound.dormant = bound.entry->is_dormant();
  for (std::size_t i = 0; i < bound.slots.size(); ++i) {
    bound.slots[i].withheld = bound.slots[i].column >= 0 && !bound.entry->hands_over(i);
  }
  bound.idle = is_idle(bound);
}

BoundOperator bind_operator(const OperatorEntry& entry, const parcels::Store& store,
                            const SurfaceFields& surface, const BoundMesh& mesh,
                            std::uint32_t stream, bool (*stop)()) {
  const std::uint32_t scope = entry.table->op.scope;
  if (scope != PILEUS_LOCAL && scope != PILEUS_GLOBAL) {
    throw Error(ExitCode::plugin,
                fmt::format("operator '{}' works on whole cells or columns, which this version "
                            "does not offer; it offers the scopes local and global",
                            entry.name));
  }
  BoundOperator bound;
  bound.entry = &entry;
  bound.stream = stream;
  bind_slots(bound, store, surface, mesh);
  bind_resizing(bound, store);
  // What follows from nothing is derived again when the parcels are others.
  if (bound.read_columns.empty()) bound.read_columns.push_back(store.dimension() - 1);
  bind_conditions(bound);
  follow_effects(bound);
  bind_budgets(bound);
  const bool lend_mesh = scope == PILEUS_GLOBAL && mesh.extension != nullptr;
  const bool lend_items = (bound.creates_items || bound.resizes_items) && mesh.items != nullptr;
  bound.instance = std::make_unique<host::Instance>(
      entry.table, host::Lent{stop, lend_mesh ? mesh.extension->table() : nullptr,
                              lend_items ? mesh.items->table() : nullptr});
  bound.instance->configure(entry.values);
  return bound;
}

}  // namespace pileus::coupling
