// Which parcels an operator has to be called for.
#pragma once
#include <cstddef>
#include <span>

#include "coupling/workspace.hpp"

namespace pileus::coupling {

/// The active part of a block, as indices relative to `begin`.
struct ActiveParcels {
  std::size_t begin = 0;                   // of the range handed over, relative to the block
  std::size_t count = 0;                   // parcels in the range
  std::span<const std::uint32_t> indices;  // empty: all of the range
  std::size_t active() const { return indices.empty() ? count : indices.size(); }
};

/// Evaluates the conditions of an operator on [begin, begin + count) of the store. A contiguous run
/// of active parcels becomes a shorter range without a list. The list lives in `work.active`.
/// An operator without conditions is active everywhere.
ActiveParcels find_active(const BoundOperator& bound, const parcels::Store& store,
                          std::size_t begin, std::size_t count, Workspace& work);

}  // namespace pileus::coupling
