#include "coupling/activity.hpp"

#include <algorithm>

namespace pileus::coupling {
namespace {

/// A NaN satisfies every comparison here, so that a broken parcel is seen by the operator and by
/// the guard behind it instead of being skipped.
template <class Compare>
void narrow(std::uint8_t* mask, const double* x, double value, std::size_t count,
            Compare&& violates) {
  for (std::size_t i = 0; i < count; ++i) {
    mask[i] = static_cast<std::uint8_t>(mask[i] & (violates(x[i], value) ? 0 : 1));
  }
}

void narrow_by(const BoundCondition& c, const double* x, std::size_t count, std::uint8_t* mask) {
  const double v = c.value;
  switch (c.comparison) {
    case PILEUS_LT:
      narrow(mask, x, v, count, [](double a, double b) { return a >= b; });
      break;
    case PILEUS_LE:
      narrow(mask, x, v, count, [](double a, double b) { return a > b; });
      break;
    case PILEUS_GT:
      narrow(mask, x, v, count, [](double a, double b) { return a <= b; });
      break;
    case PILEUS_GE:
      narrow(mask, x, v, count, [](double a, double b) { return a < b; });
      break;
    default:
      narrow(mask, x, v, count, [](double a, double b) { return a == b; });
      break;
  }
}

bool holds(std::uint32_t comparison, double x, double value) {
  std::uint8_t mask = 1;
  narrow_by({0, 0, 0, comparison, value, -1}, &x, 1, &mask);
  return mask != 0;
}

/// The same for a quantity of items: one of a parcel's suffices.
void narrow_by_items(const BoundCondition& c, const parcels::ItemLists& items, std::size_t first,
                     std::size_t count, std::uint8_t* mask) {
  const auto value = [&](std::int64_t i) {
    return c.item == 0 ? static_cast<double>(items.multiplicity()[i]) : items.column(c.item - 1)[i];
  };
  for (std::size_t p = 0; p < count; ++p) {
    std::int64_t i = items.begin()[first + p];
    const std::int64_t end = i + items.count()[first + p];
    while (i < end && !holds(c.comparison, value(i), c.value)) ++i;
    if (i == end) mask[p] = 0;
  }
}

/// Fills work.mask with 1 for active parcels: any clause of which all comparisons hold.
void evaluate(const BoundOperator& bound, const parcels::Store& store, std::size_t begin,
              std::size_t count, Workspace& work) {
  std::fill_n(work.mask.begin(), count, std::uint8_t{0});
  for (std::size_t i = 0; i < bound.conditions.size();) {
    std::fill_n(work.clause_mask.begin(), count, std::uint8_t{1});
    const std::uint32_t clause = bound.conditions[i].clause;
    for (; i < bound.conditions.size() && bound.conditions[i].clause == clause; ++i) {
      const BoundCondition& condition = bound.conditions[i];
      if (condition.item >= 0) {
        narrow_by_items(condition, store.items(), begin, count, work.clause_mask.data());
      } else {
        narrow_by(condition, store.column(condition.column) + begin, count,
                  work.clause_mask.data());
      }
    }
    for (std::size_t k = 0; k < count; ++k) {
      work.mask[k] = static_cast<std::uint8_t>(work.mask[k] | work.clause_mask[k]);
    }
  }
}

}  // namespace

ActiveParcels find_active(const BoundOperator& bound, const parcels::Store& store,
                          std::size_t begin, std::size_t count, Workspace& work) {
  if (bound.entry->table->active_if.empty()) return {0, count, {}};
  evaluate(bound, store, begin, count, work);
  std::size_t found = 0;
  for (std::size_t i = 0; i < count; ++i) {
    work.active[found] = static_cast<std::uint32_t>(i);
    found += work.mask[i];
  }
  if (found == 0) return {0, 0, {}};
  const std::size_t first = work.active[0], last = work.active[found - 1];
  if (last - first + 1 == found) return {first, found, {}};
  return {0, count, {work.active.data(), found}};
}

}  // namespace pileus::coupling
