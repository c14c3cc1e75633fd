// Items as they were before a call, to put back what the call did to them.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "base/aligned_array.hpp"
#include "parcels/item_lists.hpp"

namespace pileus::coupling {

/// Positions among the quantities of items: 0 is the multiplicity, c + 1 column c.
inline constexpr int item_multiplicity = 0;

class ItemSnapshot {
 public:
  /// Keeps quantities `which` of the items of parcels [first, first + count); with `structure`,
  /// which needs all quantities and all parcels, how many items each parcel has as well.
  void take(const parcels::ItemLists& lists, std::size_t first, std::size_t count,
            std::span<const int> which, bool structure);
  /// Puts everything back.
  void restore(parcels::ItemLists& lists) const;
  /// Puts the items of one parcel back; only without structure.
  void restore_parcel(parcels::ItemLists& lists, std::size_t parcel) const;

  std::int64_t first_item() const { return first_item_; }
  std::int64_t items() const { return items_; }
  /// Kept values of a quantity; null if it was not kept.
  const std::int64_t* multiplicity() const;
  const double* column(int quantity) const;

 private:
  const unsigned char* kept(int quantity) const;
  void put_back(parcels::ItemLists& lists, std::int64_t from, std::int64_t to) const;

  std::vector<int> which_;
  AlignedArray<unsigned char> bytes_;  // of the quantities, one after another
  std::vector<std::int32_t> count_;    // of a structure
  bool structure_ = false;
  std::int64_t first_item_ = 0, items_ = 0;
};

}  // namespace pileus::coupling
