#include "coupling/workspace.hpp"

#include <algorithm>
#include <numeric>

namespace pileus::coupling {
namespace {

std::vector<pileus_view> static_views(const BoundOperator& bound) {
  pileus_view view{};
  view.stride = sizeof(double);
  view.type = PILEUS_F64;
  view.components = 1;
  std::vector<pileus_view> views(bound.slots.size(), view);
  for (std::size_t s = 0; s < views.size(); ++s)
    if (bound.slots[s].item == item_multiplicity) views[s].type = PILEUS_I64;
  return views;
}

}  // namespace

void Workspace::reserve(const std::vector<BoundOperator>& operators, std::size_t parcels) {
  if (views.size() != operators.size()) {
    views.clear();
    for (const BoundOperator& bound : operators) views.push_back(static_views(bound));
    diagnosed.resize(operators.size());
    applied.resize(operators.size());
    std::size_t budgets = 0;
    for (const BoundOperator& bound : operators) {
      budgets = std::max(budgets, bound.entry->table->budgets.size());
    }
    ledger.assign(budgets, 0.0);
    attempt.assign(budgets, 0.0);
    std::size_t numbers = 0;
    for (const BoundOperator& bound : operators)
      numbers = std::max(numbers, bound.written_domain.size());
    domain_snapshot.assign(numbers, 0.0);
  }
  if (parcels <= everyone.size()) return;
  std::size_t columns = 0;
  for (const BoundOperator& bound : operators) columns = std::max(columns, bound.written.size());
  snapshot_stride = (parcels + 7) / 8 * 8;
  snapshot.discard_and_resize(columns * snapshot_stride);
  active.resize(parcels);
  skipped.reserve(parcels);
  mask.resize(parcels);
  clause_mask.resize(parcels);
  everyone.resize(parcels);
  std::iota(everyone.begin(), everyone.end(), 0u);
}

void Workspace::reserve_surface(const std::vector<BoundOperator>& operators, std::size_t columns) {
  std::size_t fields = 0;
  for (const BoundOperator& bound : operators) fields = std::max(fields, bound.accumulated.size());
  if (surface_snapshot.size() < fields * columns) {
    surface_snapshot.discard_and_resize(fields * columns);
  }
}

}  // namespace pileus::coupling
