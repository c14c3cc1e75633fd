#include "coupling/bound_operator.hpp"

#include <fmt/format.h>

#include <algorithm>
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
    bound.read_columns.push_back(store.column_count() + slot.surface);
  if (slot.writable) bound.accumulated.push_back(number);
}

void bind_slots(BoundOperator& bound, const parcels::Store& store, const SurfaceFields& surface) {
  const host::OperatorTable& table = *bound.entry->table;
  for (std::size_t i = 0; i < table.quantities.size(); ++i) {
    const pileus_quantity& row = table.quantities[i];
    BoundSlot slot;
    slot.low = row.low;
    slot.high = row.high;
    slot.derived = row.nature == PILEUS_DERIVED;
    slot.writable = (row.access & (PILEUS_WRITE | PILEUS_CREATE | PILEUS_ADD)) != 0;
    const bool exists = bound.entry->exists(i);
    if (exists && row.place == PILEUS_SURFACE) {
      bind_surface_slot(bound, i, store, surface, slot);
    } else if (exists) {
      slot.column = find_column(store, row.name);
      const bool absent = slot.column < 0 && row.name == std::string_view("y_position");
      if (absent) {  // the plane has no y: the slot does not exist
        bound.slots.push_back(slot);
        continue;
      }
      if (slot.column < 0) {
        throw Error(ExitCode::usage,
                    fmt::format("operator '{}' needs '{}', which parcels in {} dimensions do not "
                                "have",
                                bound.entry->name, row.name, store.dimension()));
      }
      if (!slot.derived) bound.read_columns.push_back(slot.column);
      if (slot.writable) (slot.derived ? bound.derived : bound.written).push_back(i);
    }
    bound.slots.push_back(slot);
  }
}

void bind_conditions(BoundOperator& bound) {
  const host::OperatorTable& table = *bound.entry->table;
  for (const pileus_condition& row : table.active_if) {
    const int slot = table.find_quantity(row.quantity);
    const int column = bound.slots[static_cast<std::size_t>(slot)].column;
    if (column < 0) continue;  // a clause on a quantity that does not exist: see below
    const double value = row.parameter != nullptr
                             ? bound.entry->values.numbers()[table.find_parameter(row.parameter)]
                             : row.value;
    bound.conditions.push_back({column, row.clause, row.op, value});
  }
  // A comparison with an absent quantity is false, so its whole clause is.
  for (const pileus_condition& row : table.active_if) {
    if (bound.slots[static_cast<std::size_t>(table.find_quantity(row.quantity))].column >= 0)
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
}

}  // namespace

void follow_effects(BoundOperator& bound) {
  bound.dormant = bound.entry->is_dormant();
  for (std::size_t i = 0; i < bound.slots.size(); ++i) {
    bound.slots[i].withheld = bound.slots[i].column >= 0 && !bound.entry->hands_over(i);
  }
}

BoundOperator bind_operator(const OperatorEntry& entry, const parcels::Store& store,
                            const SurfaceFields& surface, std::uint32_t stream,
                            const std::atomic<bool>* stop) {
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
  bind_slots(bound, store, surface);
  follow_effects(bound);
  bind_conditions(bound);
  bind_budgets(bound);
  bound.instance = std::make_unique<host::Instance>(entry.table, stop);
  host::ParameterValues values = entry.values;
  bound.instance->configure(values);
  return bound;
}

}  // namespace pileus::coupling
