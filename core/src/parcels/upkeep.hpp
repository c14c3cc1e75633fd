// Once per step: merge the small, split the stretched, put everything back into cell order.
#pragma once
#include <cstdint>
#include <vector>

#include "base/phase_timer.hpp"
#include "parcels/cell_order.hpp"
#include "parcels/deposit.hpp"
#include "parcels/item_upkeep.hpp"
#include "parcels/merge.hpp"
#include "parcels/split.hpp"
#include "parcels/store.hpp"

namespace pileus::parcels {

struct UpkeepCounts {
  MergeCounts merges;
  std::uint64_t splits = 0;
  std::uint64_t items_united = 0;  // with another of their parcel, to keep its list short
};

template <int D>
class Upkeep {
 public:
  Upkeep(const mesh::Grid<D>& grid, const Tiling<D>& tiling, double smallest_volume,
         const SplitCriterion<D>& criterion);

  /// Merges, splits and reorders; positions must lie in the domain. Support offsets are used as
  /// scratch and hold nothing afterwards. Derived scalars are undefined afterwards.
  UpkeepCounts run(Store& store, SupportOffsets<D>& offsets, std::uint64_t step, PhaseTimes& times);

  /// Puts the parcels into cell order without changing any; offsets are scratch here too.
  void reorder(Store& store, SupportOffsets<D>& offsets, PhaseTimes& times);

  /// Parcels of tile t are [tile_begin()[t], tile_begin()[t + 1]).
  const std::vector<std::size_t>& tile_begin() const { return tile_begin_; }
  const CellOrder<D>& order() const { return order_; }
  std::size_t allocated_bytes() const;

 private:
  void mark_splits(const Store& store, SupportOffsets<D>& scratch);
  void mark_splits_in_flat_cells(const Store& store);
  void list_survivors();
  std::uint64_t regroup_items(Store& store, std::uint64_t step);

  mesh::Grid<D> grid_;
  const Tiling<D>& tiling_;
  CellOrder<D> order_;
  Merge<D> merge_;
  CellMetric<D> metric_;
  SplitCriterion<D> criterion_;
  std::vector<std::uint8_t> splits_;   // per parcel before reordering
  std::vector<std::uint32_t> source_;  // old index of every new parcel
  std::vector<std::size_t> pairs_;     // new index of the first of every split pair
  std::vector<std::size_t> tile_begin_;
  ItemUpkeep item_upkeep_;
};

}  // namespace pileus::parcels
