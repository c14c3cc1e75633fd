#include "coupling/failure_report.hpp"

#include <fmt/format.h>

#include "coupling/item_snapshot.hpp"

namespace pileus::coupling {
namespace {

void describe_operator(const BoundOperator& bound, FailureBundle& bundle) {
  const host::OperatorTable& table = *bound.entry->table;
  bundle.operator_name = bound.entry->name;
  bundle.operator_id = table.op.id;
  bundle.operator_version = table.op.version;
  bundle.library = table.library;
  bundle.toolchain = table.toolchain;
  for (std::size_t i = 0; i < table.parameters.size(); ++i) {
    const int index = static_cast<int>(i);
    const host::ParameterValues& values = bound.entry->values;
    bundle.parameters.push_back({table.parameters[i].name, table.parameters[i].units,
                                 values.numbers()[i], values.text(index), values.list(index)});
  }
}

void describe_call(const BlockFailure& failure, const char* phase, FailureBundle& bundle) {
  bundle.phase = phase;
  bundle.step = failure.step.number;
  bundle.seed = failure.step.seed;
  bundle.stream = failure.step.stream;
  bundle.call = failure.step.call;
  bundle.time = failure.step.time;
  bundle.dt = failure.step.dt;
  bundle.block = failure.block;
  bundle.attempts = failure.attempts;
  bundle.active = failure.active;
  const pileus_error& error = failure.result.error;
  bundle.reason = host::describe_status(failure.result.status);
  if (error.text[0] != '\0') bundle.reason += std::string(": ") + error.text;
  bundle.uid = error.uid;
  bundle.value = error.value;
}

void copy_inputs(const BoundOperator& bound, const parcels::Store& store, const ParcelRange& range,
                 FailureBundle& bundle) {
  const host::OperatorTable& table = *bound.entry->table;
  bundle.uids.assign(store.uid() + range.begin, store.uid() + range.begin + range.count);
  for (std::size_t s = 0; s < bound.slots.size(); ++s) {
    const BoundSlot& slot = bound.slots[s];
    if (slot.column < 0) continue;
    const double* from = store.column(slot.column) + range.begin;
    bundle.columns.push_back({table.quantities[s].name,
                              table.quantities[s].units,
                              slot.writable,
                              {from, from + range.count}});
  }
}

/// The items of the range: how many each parcel has, and what the operator knows of each.
void copy_items(const BoundOperator& bound, const parcels::Store& store, const ParcelRange& range,
                FailureBundle& bundle) {
  const parcels::ItemLists& items = store.items();
  if (items.parcels() < range.begin + range.count) return;
  const std::int64_t first = items.begin()[range.begin];
  const std::int64_t end = items.begin()[range.begin + range.count];
  bool any = false;
  for (std::size_t s = 0; s < bound.slots.size(); ++s) {
    const BoundSlot& slot = bound.slots[s];
    if (slot.item < 0) continue;
    any = true;
    const pileus_quantity& row = bound.entry->table->quantities[s];
    std::vector<double> values;
    for (std::int64_t i = first; i < end; ++i)
      values.push_back(slot.item == item_multiplicity ? static_cast<double>(items.multiplicity()[i])
                                                      : items.column(slot.item - 1)[i]);
    bundle.columns.push_back({row.name, row.units, slot.writable, std::move(values)});
  }
  if (any)
    bundle.columns.push_back(
        {"item_count",
         "1",
         false,
         {items.count() + range.begin, items.count() + range.begin + range.count}});
}

/// Looks for a value that was broken before the call; then the operator is not to blame.
void find_broken_input(const BoundOperator& bound, const parcels::Store& store,
                       const ParcelRange& range, FailureBundle& bundle) {
  for (std::size_t s = 0; s < bound.slots.size(); ++s) {
    const BoundSlot& slot = bound.slots[s];
    if (slot.column < 0 || slot.derived) continue;
    const double* x = store.column(slot.column) + range.begin;
    for (std::size_t i = 0; i < range.count; ++i) {
      const std::uint64_t uid = store.uid()[range.begin + i];
      if (x[i] >= slot.low && x[i] <= slot.high) continue;
      if (bundle.uid != 0 && bundle.uid != uid) continue;
      bundle.input_at_fault = true;
      bundle.uid = uid;
      bundle.quantity = bound.entry->table->quantities[s].name;
      bundle.value = x[i];
      bundle.reason += fmt::format("; it was given {} = {:.17g} where [{:.6g}, {:.6g}] is allowed",
                                   bundle.quantity, x[i], slot.low, slot.high);
      return;
    }
  }
}

}  // namespace

std::shared_ptr<const FailureBundle> make_bundle(const BoundOperator& bound,
                                                 const parcels::Store& store,
                                                 const ParcelRange& range,
                                                 const BlockFailure& failure, const char* phase) {
  auto bundle = std::make_shared<FailureBundle>();
  describe_operator(bound, *bundle);
  describe_call(failure, phase, *bundle);
  const std::int32_t slot = failure.result.error.slot;
  if (slot >= 0 && static_cast<std::size_t>(slot) < bound.slots.size()) {
    bundle->quantity = bound.entry->table->quantities[static_cast<std::size_t>(slot)].name;
  }
  if (range.block >= 0) {
    copy_inputs(bound, store, range, *bundle);
    copy_items(bound, store, range, *bundle);
  }
  find_broken_input(bound, store, range, *bundle);
  return bundle;
}

std::string describe_failure(const FailureBundle& bundle) {
  std::string text = fmt::format(
      "operator '{}' ({}) {} in {} at step {}, t = {:.9g} s, dt = {:.6g} s", bundle.operator_name,
      bundle.operator_id, bundle.reason, bundle.phase, bundle.step, bundle.time, bundle.dt);
  if (bundle.uid != 0) text += fmt::format("; parcel {}", bundle.uid);
  if (!bundle.quantity.empty())
    text += fmt::format(", {} = {:.17g}", bundle.quantity, bundle.value);
  if (bundle.block >= 0) text += fmt::format("; block {}", bundle.block);
  if (bundle.attempts > 1)
    text += fmt::format("; {} calls, smaller steps included", bundle.attempts);
  text += bundle.input_at_fault
              ? "; the state broke down before this call: a smaller time step may help"
              : "; the block is as it was before the call";
  return text;
}

}  // namespace pileus::coupling
