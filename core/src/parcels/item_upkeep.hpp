// What becomes of the parcels' items when parcels merge, split and are put into a new order.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "parcels/item_lists.hpp"
#include "parcels/item_reduction.hpp"

namespace pileus::parcels {

/// A parcel that was merged into another; both as indices before the new order.
struct MergedParcel {
  std::uint32_t receiver, source;
};

/// How the parcels were regrouped.
struct ParcelRegrouping {
  std::span<const std::uint32_t> source;  // old index of every new parcel
  std::span<const MergedParcel> merged;   // by receiver, in a fixed order
  std::span<const std::size_t> pairs;     // new index of the first of every split pair
  const std::uint64_t* uid;               // per new parcel; of a split parcel: before its split
  std::uint64_t step;
};

class ItemUpkeep {
 public:
  /// Lists of merged parcels are joined, those above the declared length shortened; the two halves
  /// of a split parcel get half of every item each, and the odd one of an odd multiplicity goes to
  /// either by chance (drawn from identity, step and position in the list). Sums of multiplicities
  /// are exact. Returns the number of items that were united with others.
  std::uint64_t run(ItemLists& lists, const ParcelRegrouping& parcels);

  std::size_t allocated_bytes() const;

 private:
  void index_merged(const ItemLists& lists, const ParcelRegrouping& parcels);
  std::uint64_t shorten(ItemLists& lists, const ParcelRegrouping& parcels);
  template <class F>
  void each_item(const ItemLists& lists, std::uint32_t parcel, F&& f) const;
  template <class F>
  void each_share(const ItemLists& lists, const ParcelRegrouping& parcels, std::size_t k,
                  F&& f) const;
  void mark_halves(const ParcelRegrouping& parcels);
  void list_sources(const ItemLists& lists, const ParcelRegrouping& parcels);

  std::vector<std::uint32_t> first_merged_;  // per old parcel: position in merged, or its size
  std::span<const MergedParcel> merged_;
  std::vector<std::uint8_t> half_;  // per new parcel: 0 whole, 1 and 2 of a split
  std::vector<std::int32_t> count_;
  std::vector<std::int64_t> begin_, source_;
  std::vector<std::vector<std::int64_t>> shares_;  // of the items of halves
};

}  // namespace pileus::parcels
