#include "coupling/block_runner.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>

#include "coupling/block_attempt.hpp"

namespace pileus::coupling {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Number of values outside [low, high]; a NaN is outside of everything. Without branches.
std::size_t count_outside(const double* x, std::size_t count, double low, double high) {
  std::size_t outside = 0;
  for (std::size_t i = 0; i < count; ++i) outside += x[i] >= low && x[i] <= high ? 0 : 1;
  return outside;
}

/// Sets the result to a guard violation at the first bad value of a column, if there is one.
/// Without `uid` the values are no parcels'.
bool violates(const double* x, std::size_t count, std::span<const std::uint32_t> list,
              const BoundSlot& slot, std::size_t slot_number, const std::uint64_t* uid,
              host::CallResult& result) {
  const auto bad = [&](std::size_t i) { return !(x[i] >= slot.low && x[i] <= slot.high); };
  std::size_t at = count;
  if (list.empty()) {
    if (count_outside(x, count, slot.low, slot.high) == 0) return false;
    at = 0;
    while (!bad(at)) ++at;
  } else {
    const auto found = std::find_if(list.begin(), list.end(), bad);
    if (found == list.end()) return false;
    at = *found;
  }
  result.status = PILEUS_E_NUMERIC;
  result.error.slot = static_cast<std::int32_t>(slot_number);
  result.error.uid = uid != nullptr ? uid[at] : 0;
  result.error.value = x[at];
  if (uid != nullptr) {
    std::snprintf(result.error.text, sizeof result.error.text,
                  "it wrote %.17g, allowed is [%.6g, %.6g]", x[at], slot.low, slot.high);
  } else {
    std::snprintf(result.error.text, sizeof result.error.text,
                  "it brought column %zu of the surface to %.17g, allowed is [%.6g, %.6g]", at,
                  x[at], slot.low, slot.high);
  }
  return true;
}

}  // namespace

pileus_block BlockRunner::block(std::size_t which, const ParcelRange& range, Derived what,
                                Workspace& work) const {
  const bool diagnosing = what != Derived::none;
  const BoundOperator& bound = operators_[which];
  std::vector<pileus_view>& views = work.views[which];
  for (std::size_t s = 0; s < views.size(); ++s) {
    const BoundSlot& slot = bound.slots[s];
    if (slot.surface >= 0) {
      const bool changes = slot.writable && !diagnosing;
      const bool owned = (bound.entry->table->quantities[s].access & PILEUS_WRITE) != 0;
      views[s].access = PILEUS_READ;
      if (changes) views[s].access |= owned ? PILEUS_WRITE : PILEUS_ADD;
      views[s].data = surface_.values(static_cast<std::size_t>(slot.surface)).data();
      views[s].count = static_cast<std::int64_t>(surface_.columns());
      continue;
    }
    const int column = is_left_out(slot, what) ? -1 : slot.column;
    const bool writable = slot.writable && slot.derived == diagnosing;
    views[s].access = writable ? PILEUS_READ | PILEUS_WRITE : std::uint32_t{PILEUS_READ};
    if (slot.item >= 0) continue;
    if (slot.domain != nullptr) {
      views[s].data = slot.domain;
      views[s].count = 1;
      continue;
    }
    views[s].data = column >= 0 ? store_.column(column) + range.begin : nullptr;
    views[s].count = static_cast<std::int64_t>(range.count);
    if (slot.mesh.exists()) mesh_->show(slot.mesh, range.begin, range.count, views[s]);
  }
  pileus_block record{};
  record.size = sizeof record;
  record.count = record.active_count = static_cast<std::int64_t>(range.count);
  record.uid = store_.uid() + range.begin;
  record.views = views.data();
  record.grid = grid_;
  record.ledger = work.attempt.data();
  show_items(which, range, work, record);
  return record;
}

bool BlockRunner::diagnose(std::size_t which, const pileus_step& step, const ParcelRange& range,
                           Derived what, Workspace& work) const {
  const Clock::time_point start = Clock::now();
  const BoundOperator& bound = operators_[which];
  Attempt a{which, bound, step, range, work, block(which, range, what, work)};
  a.last = bound.instance->diagnose(step, a.record, range.block);
  a.calls = 1;
  for (std::size_t s : bound.derived) {
    if (!a.last.ok()) break;
    if (is_left_out(bound.slots[s], what)) continue;
    violates(store_.column(bound.slots[s].column) + range.begin, range.count, {}, bound.slots[s], s,
             a.record.uid, a.last);
  }
  OperatorCounts& counts = work.diagnosed[which];
  ++counts.calls;
  counts.parcels += range.count;
  counts.seconds += seconds_since(start);
  if (a.last.ok()) return true;
  record_failure(a, {}, true);
  return false;
}

/// Checks everything apply may have changed against its declared range, and what it booked.
bool BlockRunner::writes_violate(const Attempt& a, std::span<const std::uint32_t> list,
                                 host::CallResult& result) const {
  for (const std::size_t s : a.bound.written) {
    const BoundSlot& slot = a.bound.slots[s];
    if (violates(store_.column(slot.column) + a.range.begin, a.range.count, list, slot, s,
                 a.record.uid, result))
      return true;
  }
  if (items_violate(a, result)) return true;
  for (const std::size_t s : a.bound.accumulated) {
    const BoundSlot& slot = a.bound.slots[s];
    if (violates(surface_.values(static_cast<std::size_t>(slot.surface)).data(), surface_.columns(),
                 {}, slot, s, nullptr, result))
      return true;
  }
  for (const std::size_t s : a.bound.written_domain) {
    const BoundSlot& slot = a.bound.slots[s];
    if (*slot.domain >= slot.low && *slot.domain <= slot.high) continue;
    result.status = PILEUS_E_NUMERIC;
    result.error.slot = static_cast<std::int32_t>(s);
    result.error.value = *slot.domain;
    std::snprintf(result.error.text, sizeof result.error.text,
                  "it wrote %.17g, allowed is [%.6g, %.6g]", *slot.domain, slot.low, slot.high);
    return true;
  }
  const std::vector<std::string>& budgets = a.bound.entry->table->budgets;
  for (std::size_t b = 0; b < budgets.size(); ++b) {
    if (std::isfinite(a.work.attempt[b])) continue;
    result.status = PILEUS_E_NUMERIC;
    std::snprintf(result.error.text, sizeof result.error.text,
                  "it booked a source of %s that is not finite", budgets[b].c_str());
    return true;
  }
  return false;
}

host::CallResult BlockRunner::init(std::size_t which, const pileus_step& step,
                                   const ParcelRange& range, Workspace& work) const {
  const BoundOperator& bound = operators_[which];
  if (bound.op().init == nullptr) return bound.instance->init(step, {});
  const auto column = [&](std::size_t w) {
    return store_.column(bound.slots[bound.written[w]].column) + range.begin;
  };
  std::vector<std::vector<double>> before;
  for (std::size_t w = 0; w < bound.written.size(); ++w)
    before.emplace_back(column(w), column(w) + range.count);
  std::fill(work.attempt.begin(), work.attempt.end(), 0.0);
  const Attempt a{which, bound, step, range, work, block(which, range, Derived::none, work)};
  const ItemExtension::Permission permission(
      bound.creates_items || bound.resizes_items ? items_ : nullptr,
      [&](pileus_block& record) { show_items(which, range, work, record); });
  host::CallResult result = bound.instance->init(step, a.record);
  if (!result.ok() || !writes_violate(a, {}, result)) return result;
  // As it was, so that the values it was given are not taken for those it wrote.
  for (std::size_t w = 0; w < bound.written.size(); ++w)
    std::copy(before[w].begin(), before[w].end(), column(w));
  return result;
}

host::CallResult BlockRunner::call_once(const Attempt& a, std::span<const std::uint32_t> list,
                                        const pileus_step& step) const {
  pileus_block record = a.record;
  record.active = list.empty() ? nullptr : list.data();
  if (!list.empty()) record.active_count = static_cast<std::int64_t>(list.size());
  const ItemExtension::Permission permission(
      a.bound.resizes_items ? items_ : nullptr,
      [&](pileus_block& shown) { show_items(a.which, a.range, a.work, shown); });
  if (a.bound.resizes_items) show_items(a.which, a.range, a.work, record);
  host::CallResult result = a.bound.instance->apply(step, record, a.range.block);
  if (result.ok()) writes_violate(a, list, result);
  return result;
}

/// Advances the list by the whole step in 2^level parts. False: rejected, a.last says why; the
/// parcels of the list are as before.
bool BlockRunner::try_level(Attempt& a, std::span<const std::uint32_t> list, int level) const {
  const std::uint32_t parts = 1u << level;
  std::fill(a.work.attempt.begin(), a.work.attempt.end(), 0.0);
  pileus_step step = a.step;
  step.dt = a.step.dt / parts;
  for (std::uint32_t part = 0; part < parts; ++part) {
    step.time = a.step.time + part * step.dt;
    step.call = a.step.call + (parts - 1) + part;
    a.last = call_once(a, list, step);
    ++a.calls;
    if (!a.last.ok()) {
      restore(a, list);
      return false;
    }
  }
  for (std::size_t b = 0; b < a.work.ledger.size(); ++b) a.work.ledger[b] += a.work.attempt[b];
  return true;
}

/// Advances the list; after a rejection a local operator's parcels are parted until those that
/// failed stand alone, and only they take smaller steps. A parcel's result depends on nothing but
/// whether it fails itself, so the outcome is the same for every blocking.
bool BlockRunner::advance(Attempt& a, std::span<const std::uint32_t> list, int level) const {
  if (try_level(a, list, level)) return true;
  const bool may_retry = a.last.status == PILEUS_RETRY || a.last.status == PILEUS_E_NUMERIC;
  if (!may_retry) return false;
  ++a.work.applied[a.which].retries;
  if (!a.bound.is_local()) return level < most_halvings && advance(a, list, level + 1);
  if (list.empty()) list = std::span(a.work.everyone).first(a.range.count);
  if (list.size() > 1) {
    const std::size_t half = list.size() / 2;
    return advance(a, list.first(half), level) && advance(a, list.subspan(half), level);
  }
  return level < most_halvings && advance(a, list, level + 1);
}

bool BlockRunner::apply(std::size_t which, const pileus_step& step, const ParcelRange& range,
                        const ActiveParcels& active, Workspace& work, BlockBooks* books) const {
  const Clock::time_point start = Clock::now();
  const BoundOperator& bound = operators_[which];
  const ParcelRange part{range.block, range.begin + active.begin, active.count};
  Attempt a{which, bound, step, part, work, block(which, part, Derived::none, work)};
  snapshot(a);
  std::fill(work.ledger.begin(), work.ledger.end(), 0.0);
  const bool done = advance(a, active.indices, 0);
  if (done) {
    book(a, books);
  } else {
    record_failure(a, active.indices, false);
    restore(a, {});
  }
  OperatorCounts& counts = work.applied[which];
  counts.calls += static_cast<std::uint64_t>(a.calls);
  counts.parcels += active.active();
  counts.seconds += seconds_since(start);
  return done;
}

void BlockRunner::audit(std::size_t which, const pileus_step& step, const ParcelRange& range,
                        std::span<const std::uint32_t> skipped, Workspace& work) const {
  Attempt a{which, operators_[which], step, range, work, block(which, range, Derived::none, work)};
  snapshot(a);
  std::fill(work.attempt.begin(), work.attempt.end(), 0.0);
  a.last = call_once(a, skipped, step);
  AuditFinding finding;
  find_difference(a, finding);
  restore(a, {});
  if (finding.found() && finding.block < work.finding.block) work.finding = finding;
}

/// What a call changed that should have changed nothing, byte by byte.
void BlockRunner::find_difference(const Attempt& a, AuditFinding& finding) const {
  const auto report = [&](std::uint64_t uid, const std::string& what) {
    finding = {a.range.block, a.which, uid, what};
  };
  if (!a.last.ok()) {
    return report(a.last.error.uid, std::string("fails: ") + a.last.error.text);
  }
  for (std::size_t w = 0; w < a.bound.written.size(); ++w) {
    const std::size_t slot = a.bound.written[w];
    if (a.bound.slots[slot].withheld) continue;
    const double* now = store_.column(a.bound.slots[slot].column) + a.range.begin;
    const double* before = a.work.snapshot.data() + w * a.work.snapshot_stride;
    for (std::size_t i = 0; i < a.range.count; ++i) {
      if (std::bit_cast<std::uint64_t>(now[i]) == std::bit_cast<std::uint64_t>(before[i])) continue;
      std::array<char, 160> text{};
      std::snprintf(text.data(), text.size(), "takes its %s from %.17g to %.17g",
                    a.bound.entry->table->quantities[slot].name, before[i], now[i]);
      return report(a.record.uid[i], text.data());
    }
  }
  find_difference_of_items(a, finding);
  if (finding.found()) return;
  for (std::size_t b = 0; b < a.bound.entry->table->budgets.size(); ++b) {
    if (a.work.attempt[b] != 0)
      report(a.record.uid[0], "books a source of " + a.bound.entry->table->budgets[b]);
  }
}

void BlockRunner::snapshot(const Attempt& a) const {
  for (std::size_t w = 0; w < a.bound.written.size(); ++w) {
    const int column = a.bound.slots[a.bound.written[w]].column;
    std::copy_n(store_.column(column) + a.range.begin, a.range.count,
                a.work.snapshot.data() + w * a.work.snapshot_stride);
  }
  for (std::size_t k = 0; k < a.bound.accumulated.size(); ++k) {
    const int field = a.bound.slots[a.bound.accumulated[k]].surface;
    std::copy_n(surface_.values(static_cast<std::size_t>(field)).data(), surface_.columns(),
                a.work.surface_snapshot.data() + k * surface_.columns());
  }
  for (std::size_t k = 0; k < a.bound.written_domain.size(); ++k)
    a.work.domain_snapshot[k] = *a.bound.slots[a.bound.written_domain[k]].domain;
  if (!a.bound.kept_items.empty()) snapshot_items(a);
}

void BlockRunner::restore(const Attempt& a, std::span<const std::uint32_t> list) const {
  for (std::size_t w = 0; w < a.bound.written.size(); ++w) {
    double* now = store_.column(a.bound.slots[a.bound.written[w]].column) + a.range.begin;
    const double* before = a.work.snapshot.data() + w * a.work.snapshot_stride;
    if (list.empty()) {
      std::copy_n(before, a.range.count, now);
    } else {
      for (const std::uint32_t i : list) now[i] = before[i];
    }
  }
  // Only calls with all parcels change the surface and the domain, so that it goes back as a whole.
  for (std::size_t k = 0; k < a.bound.accumulated.size(); ++k) {
    const int field = a.bound.slots[a.bound.accumulated[k]].surface;
    std::copy_n(a.work.surface_snapshot.data() + k * surface_.columns(), surface_.columns(),
                surface_.values(static_cast<std::size_t>(field)).data());
  }
  for (std::size_t k = 0; k < a.bound.written_domain.size(); ++k)
    *a.bound.slots[a.bound.written_domain[k]].domain = a.work.domain_snapshot[k];
  if (!a.bound.kept_items.empty()) restore_items(a, list);
}

/// Books sources as declared and changes as differences parcel by parcel, whose rounding error is
/// that of the change and not of the total.
void BlockRunner::book(const Attempt& a, BlockBooks* books) const {
  for (const BudgetedSlot& entry : a.bound.budgeted) {
    const int column = a.bound.slots[a.bound.written[entry.written]].column;
    const double* now = store_.column(column) + a.range.begin;
    const double* before = a.work.snapshot.data() + entry.written * a.work.snapshot_stride;
    const double* volume = store_.volume() + a.range.begin;
    double change = 0;
    for (std::size_t i = 0; i < a.range.count; ++i) {
      change += (entry.per_volume ? volume[i] : 1.0) * (now[i] - before[i]);
    }
    books[entry.budget].change += change;
  }
  book_items(a, books);
  for (std::size_t b = 0; b < a.bound.entry->table->budgets.size(); ++b) {
    books[b].source += a.work.ledger[b];
  }
}

void BlockRunner::record_failure(const Attempt& a, std::span<const std::uint32_t> list,
                                 bool in_diagnose) const {
  BlockFailure& failure = a.work.failure;
  if (failure.happened() && failure.block <= a.range.block) return;
  failure = {
      a.range.block, a.which, in_diagnose, a.calls, a.step, a.last, {list.begin(), list.end()}};
}

}  // namespace pileus::coupling
