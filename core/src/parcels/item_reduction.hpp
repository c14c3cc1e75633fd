// Shortening the list of a parcel's items without changing what they add up to.
#pragma once
#include <cstdint>
#include <vector>

#include "parcels/item_lists.hpp"

namespace pileus::parcels {

/// Unites those items of a list that are most alike until at most `most` are left: the two next to
/// each other in the order of the first column whose logarithms differ least, summed in squares
/// over the columns of each. Number and amounts are conserved (multiplicities add, columns take the
/// mean weighted by them); higher moments shrink, least where items are alike.
class ItemReduction {
 public:
  /// `items`: positions of the list in `lists`, in a fixed order; those united into others are left
  /// with multiplicity 0. Returns how many those are.
  std::uint64_t run(ItemLists& lists, std::vector<std::int64_t>& items, std::size_t most);

 private:
  std::vector<double> distance_;  // to the next in the list
  std::vector<std::uint32_t> next_, previous_;
};

}  // namespace pileus::parcels
