// Extrema of blocks of parcels, by which an operator's conditions are ruled out without a look at
// the parcels.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "coupling/bound_operator.hpp"

namespace pileus::coupling {

/// Lowest and highest value of the columns that conditions compare, per block, each with the
/// version of the column it belongs to. Operators that look at the same quantity share them; a
/// block is looked through once per version of a column.
class BlockBounds {
 public:
  /// Room for the columns that occur in conditions.
  void prepare(const std::vector<BoundOperator>& operators, int columns, std::size_t blocks);

  /// True if no parcel of [begin, begin + count) can be active: every clause has a comparison that
  /// fails for all values between the extrema. `versions` are those of the columns. A NaN counts
  /// as every value. Blocks may be asked for by different threads at once.
  bool rule_out(const BoundOperator& bound, const parcels::Store& store,
                const std::vector<std::uint64_t>& versions, std::size_t block, std::size_t begin,
                std::size_t count);

 private:
  struct Extrema {
    std::uint64_t version = 0;
    double low = 0, high = 0;
  };
  const Extrema& extrema(const parcels::Store& store, int column, std::uint64_t version,
                         std::size_t block, std::size_t begin, std::size_t count);

  std::vector<std::vector<Extrema>> blocks_;  // per column; empty where no condition looks
};

}  // namespace pileus::coupling
