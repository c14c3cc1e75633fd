// The block runner's part that has to do with items of parcels.
#include <algorithm>
#include <bit>
#include <cstdio>

#include "base/parallel.hpp"
#include "coupling/block_attempt.hpp"
#include "coupling/ledger.hpp"

namespace pileus::coupling {
namespace {

/// Parcel of the range that owns an item.
std::size_t owner_of(const parcels::ItemLists& items, const ParcelRange& range, std::int64_t item) {
  std::size_t p = range.begin;
  while (p + 1 < range.begin + range.count && items.begin()[p + 1] <= item) ++p;
  return p;
}

/// Sum of term(i) over [0, count), in an order that depends on the count alone; a whole population
/// on all threads.
template <class Term>
double sum_of(std::int64_t count, bool whole, Term&& term) {
  const auto part = [&](std::size_t begin, std::size_t end) {
    CompensatedSum sum;
    for (std::size_t i = begin; i < end; ++i) sum.add(term(static_cast<std::int64_t>(i)));
    return sum;
  };
  const auto size = static_cast<std::size_t>(count);
  if (!whole) return part(0, size).value();
  return ordered_reduce(size, CompensatedSum{}, part,
                        [](CompensatedSum sum, const CompensatedSum& o) {
                          sum.add(o.value());
                          return sum;
                        })
      .value();
}

/// For how many of [0, count) it holds.
template <class Holds>
std::size_t count_of(std::int64_t count, bool whole, Holds&& holds) {
  const auto part = [&](std::size_t begin, std::size_t end) {
    std::size_t found = 0;
    for (std::size_t i = begin; i < end; ++i) found += holds(static_cast<std::int64_t>(i)) ? 1 : 0;
    return found;
  };
  const auto size = static_cast<std::size_t>(count);
  if (!whole) return part(0, size);
  return ordered_reduce(size, std::size_t{0}, part,
                        [](std::size_t sum, std::size_t more) { return sum + more; });
}

}  // namespace

void BlockRunner::show_items(std::size_t which, const ParcelRange& range, Workspace& work,
                             pileus_block& record) const {
  parcels::ItemLists& items = store_.items();
  if (items.parcels() < range.begin + range.count) return;  // there are none
  const std::int64_t first = items.begin()[range.begin];
  const std::int64_t end = items.begin()[range.begin + range.count];
  const BoundOperator& bound = operators_[which];
  for (std::size_t s = 0; s < bound.slots.size(); ++s) {
    const int item = bound.slots[s].item;
    if (item < 0) continue;
    pileus_view& view = work.views[which][s];
    view.data = item == item_multiplicity ? static_cast<void*>(items.multiplicity() + first)
                                          : static_cast<void*>(items.column(item - 1) + first);
    view.count = end - first;
  }
  record.item_count = items.count() + range.begin;
  record.item_begin = items.begin() + range.begin;
  if (first == 0) return;
  work.item_begin.resize(range.count);
  for (std::size_t p = 0; p < range.count; ++p)
    work.item_begin[p] = items.begin()[range.begin + p] - first;
  record.item_begin = work.item_begin.data();
}

/// Checks all items of the range: those of parcels that were not called for are as they were.
bool BlockRunner::items_violate(const Attempt& a, host::CallResult& result) const {
  const parcels::ItemLists& items = store_.items();
  for (const std::size_t s : a.bound.written_items) {
    const BoundSlot& slot = a.bound.slots[s];
    const std::int64_t begin = items.begin()[a.range.begin];
    const std::int64_t end = items.begin()[a.range.begin + a.range.count];
    const bool counts = slot.item == item_multiplicity;
    const double* value = counts ? nullptr : items.column(slot.item - 1);
    const auto at = [&](std::int64_t i) {
      return counts ? static_cast<double>(items.multiplicity()[i]) : value[i];
    };
    const double low = counts ? std::max(slot.low, 0.0) : slot.low;
    const auto is_bad = [&](std::int64_t i) { return !(at(i) >= low && at(i) <= slot.high); };
    const std::size_t bad =
        count_of(end - begin, a.range.block < 0, [&](std::int64_t i) { return is_bad(begin + i); });
    if (bad == 0) continue;
    std::int64_t i = begin;
    while (!is_bad(i)) ++i;
    result.status = PILEUS_E_NUMERIC;
    result.error.slot = static_cast<std::int32_t>(s);
    result.error.uid = store_.uid()[owner_of(items, a.range, i)];
    result.error.value = at(i);
    std::snprintf(result.error.text, sizeof result.error.text,
                  "it wrote %.17g to an item, allowed is [%.6g, %.6g]", at(i), low, slot.high);
    return true;
  }
  return false;
}

void BlockRunner::snapshot_items(const Attempt& a) const {
  a.work.item_snapshot.take(store_.items(), a.range.begin, a.range.count, a.bound.kept_items,
                            a.bound.resizes_items);
}

void BlockRunner::restore_items(const Attempt& a, std::span<const std::uint32_t> list) const {
  if (list.empty() || a.bound.resizes_items) return a.work.item_snapshot.restore(store_.items());
  for (const std::uint32_t i : list)
    a.work.item_snapshot.restore_parcel(store_.items(), a.range.begin + i);
}

/// Where items and their multiplicities stay, changes are differences item by item, whose rounding
/// error is that of the change and not of the total.
void BlockRunner::book_items(const Attempt& a, BlockBooks* books) const {
  if (a.bound.budgeted_items.empty()) return;
  const parcels::ItemLists& items = store_.items();
  const ItemSnapshot& before = a.work.item_snapshot;
  const bool whole = a.range.block < 0;
  const std::int64_t first = items.begin()[a.range.begin];
  const std::int64_t count = items.begin()[a.range.begin + a.range.count] - first;
  const std::int64_t* multiplicity = items.multiplicity() + first;
  const std::int64_t* then = before.multiplicity();
  const bool same =
      !a.bound.resizes_items && (then == nullptr || std::equal(then, then + count, multiplicity));
  for (const BudgetedItems& entry : a.bound.budgeted_items) {
    const double* now = items.column(entry.item - 1) + first;
    const double* old = before.column(entry.item);
    double change = 0;
    if (same) {
      change = sum_of(count, whole, [&](std::int64_t i) {
        return static_cast<double>(multiplicity[i]) * (now[i] - old[i]);
      });
    } else {
      change = sum_of(count, whole, [&](std::int64_t i) {
        return static_cast<double>(multiplicity[i]) * now[i];
      });
      change -= sum_of(before.items(), whole,
                       [&](std::int64_t i) { return static_cast<double>(then[i]) * old[i]; });
    }
    books[entry.budget].change += change / items.budget_scale();
  }
}

void BlockRunner::find_difference_of_items(const Attempt& a, AuditFinding& finding) const {
  const parcels::ItemLists& items = store_.items();
  const ItemSnapshot& before = a.work.item_snapshot;
  for (const std::size_t s : a.bound.written_items) {
    const int item = a.bound.slots[s].item;
    if (a.bound.slots[s].withheld) continue;
    const auto report = [&](std::int64_t i, double was, double is) {
      char text[160];
      std::snprintf(text, sizeof text, "takes the %s of an item from %.17g to %.17g",
                    a.bound.entry->table->quantities[s].name, was, is);
      const std::size_t owner = owner_of(items, a.range, before.first_item() + i);
      finding = {a.range.block, a.which, store_.uid()[owner], text};
    };
    for (std::int64_t i = 0; i < before.items(); ++i) {
      if (item == item_multiplicity) {
        const std::int64_t was = before.multiplicity()[i];
        const std::int64_t is = items.multiplicity()[before.first_item() + i];
        if (was != is) return report(i, static_cast<double>(was), static_cast<double>(is));
        continue;
      }
      const double was = before.column(item)[i];
      const double is = items.column(item - 1)[before.first_item() + i];
      if (std::bit_cast<std::uint64_t>(was) != std::bit_cast<std::uint64_t>(is))
        return report(i, was, is);
    }
  }
}

}  // namespace pileus::coupling
