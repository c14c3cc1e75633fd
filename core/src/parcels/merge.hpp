// Merging small parcels into their nearest neighbours.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "parcels/cell_order.hpp"
#include "parcels/item_upkeep.hpp"
#include "parcels/merge_graph.hpp"
#include "parcels/nearest.hpp"
#include "parcels/store.hpp"

namespace pileus::parcels {

struct MergeCounts {
  std::uint64_t small = 0;   // parcels below the smallest volume
  std::uint64_t merged = 0;  // parcels that disappeared
  /// Clusters by number of sources: 1, 2, … 6, 7 and more.
  std::array<std::uint64_t, 7> clusters{};
};

template <int D>
class Merge {
 public:
  /// Parcels below `smallest_volume` merge.
  Merge(const mesh::Grid<D>& grid, double smallest_volume);

  /// Merges in place: receivers take the volume-weighted means, the centroid and the second moment
  /// of their cluster, rescaled so that the shape encloses the summed volume (Frey et al. 2023),
  /// or only ever enlarged where parcels carry a size of their own.
  /// Volume, centroid (up to the periodic wrap) and all volume integrals are conserved to rounding,
  /// and no value leaves the range of its parents. `order` must be sorted for the present
  /// positions. Sources are marked in gone().
  MergeCounts run(Store& store, const CellOrder<D>& order);

  /// One byte per parcel: 1 where the parcel has been merged away; empty when none was.
  const std::vector<std::uint8_t>& gone() const { return gone_; }
  /// Who was merged into whom, by receiver.
  const std::vector<MergedParcel>& merged() const { return merged_; }
  void forget() {
    gone_.clear();
    merged_.clear();
  }

 private:
  struct Source {
    std::uint64_t receiver_uid, uid;
    std::uint32_t receiver, source;
  };
  void find_links(const Store& store, const CellOrder<D>& order);
  void merge_cluster(Store& store, const Source* begin, const Source* end) const;
  void list_merged();

  mesh::Grid<D> grid_;
  double smallest_volume_;
  NearestParcel<D> nearest_;
  MergeGraph graph_;
  std::vector<std::uint32_t> small_;
  std::vector<Link> links_;
  std::vector<Source> sources_;
  std::vector<std::size_t> cluster_begin_;
  std::vector<std::uint8_t> gone_;
  std::vector<MergedParcel> merged_;
};

}  // namespace pileus::parcels
