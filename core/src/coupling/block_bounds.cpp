#include "coupling/block_bounds.hpp"

#include <limits>

namespace pileus::coupling {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Whether a comparison fails for every value in [low, high].
bool fails(std::uint32_t comparison, double low, double high, double value) {
  switch (comparison) {
    case PILEUS_LT:
      return low >= value;
    case PILEUS_LE:
      return low > value;
    case PILEUS_GT:
      return high <= value;
    case PILEUS_GE:
      return high < value;
    default:
      return low == value && high == value;
  }
}

}  // namespace

void BlockBounds::prepare(const std::vector<BoundOperator>& operators, int columns,
                          std::size_t blocks) {
  blocks_.resize(static_cast<std::size_t>(columns));
  for (const BoundOperator& bound : operators) {
    for (const BoundCondition& condition : bound.conditions) {
      if (condition.column < 0) continue;
      auto& list = blocks_[static_cast<std::size_t>(condition.column)];
      if (list.size() < blocks) list.resize(blocks + blocks / 8);
    }
  }
}

const BlockBounds::Extrema& BlockBounds::extrema(const parcels::Store& store, int column,
                                                 std::uint64_t version, std::size_t block,
                                                 std::size_t begin, std::size_t count) {
  Extrema& e = blocks_[static_cast<std::size_t>(column)][block];
  if (e.version == version) return e;
  const double* x = store.column(column) + begin;
  double low = infinity, high = -infinity;
  bool broken = false;
  for (std::size_t i = 0; i < count; ++i) {
    low = x[i] < low ? x[i] : low;
    high = x[i] > high ? x[i] : high;
    broken = broken || x[i] != x[i];
  }
  e = {version, broken ? -infinity : low, broken ? infinity : high};
  return e;
}

bool BlockBounds::rule_out(const BoundOperator& bound, const parcels::Store& store,
                           const std::vector<std::uint64_t>& versions, std::size_t block,
                           std::size_t begin, std::size_t count) {
  if (bound.entry->table->active_if.empty()) return false;
  const auto& conditions = bound.conditions;
  for (std::size_t i = 0; i < conditions.size();) {
    const std::uint32_t clause = conditions[i].clause;
    bool ruled_out = false;
    for (; i < conditions.size() && conditions[i].clause == clause; ++i) {
      if (ruled_out) continue;
      const BoundCondition& c = conditions[i];
      if (c.item >= 0) {
        const std::int64_t* first = store.items().begin() + begin;
        ruled_out = first[0] == first[count];
        continue;
      }
      const Extrema& e = extrema(store, c.column, versions[static_cast<std::size_t>(c.column)],
                                 block, begin, count);
      ruled_out = fails(c.comparison, e.low, e.high, c.value);
    }
    if (!ruled_out) return false;
  }
  return true;
}

}  // namespace pileus::coupling
