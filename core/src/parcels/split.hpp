// Splitting parcels that have become too long or too large.
#pragma once
#include <cstddef>
#include <limits>

#include "mesh/grid.hpp"
#include "parcels/cell_metric.hpp"
#include "parcels/store.hpp"

namespace pileus::parcels {

/// When a parcel splits, with axes in the metric of the cell. 3D: a/c ≥ max_aspect_ratio or a ≥ the
/// radius of a sphere of the cell's volume; 2D: a/b > max_aspect_ratio or area > largest_volume.
/// The published criterion takes the smallest edge of the cell in place of the cube of its volume;
/// in cells that are not cubes that splits parcels of the cell's own shape until all must merge.
template <int D>
struct SplitCriterion {
  double squared_aspect_ratio;  // of the longest to the shortest axis
  double squared_longest;       // m2, 3D
  double largest_volume;        // m2, 2D, of the ellipse

  static SplitCriterion make(const mesh::Grid<D>& grid, double max_aspect_ratio,
                             double max_volume_ratio);
  static SplitCriterion never() {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    return {infinity, infinity, infinity};
  }
  bool splits(double squared_length, double squared_ratio, double volume) const {
    if constexpr (D == 3)
      return squared_ratio >= squared_aspect_ratio || squared_length >= squared_longest;
    else
      return squared_ratio > squared_aspect_ratio || volume > largest_volume;
  }
};

/// Turns two copies of one parcel, at `first` and `second`, into its two halves along the longest
/// axis (in the metric of the cell): half the volume and half that axis each, centres h apart on
/// either side, so that volume, centroid and second moment are the parent's (h = √(3/5) a/2 in 3D,
/// √3 a/4 in 2D; Frey et al.). Any affine map keeps all of this, so also that to the cell's metric
/// and back. `second` gets the identity of a child born in `step`. Halves beyond a wall are
/// reflected.
template <int D>
void split_pair(Store& store, const mesh::Grid<D>& grid, const CellMetric<D>& metric,
                std::size_t first, std::size_t second, std::uint64_t step);

}  // namespace pileus::parcels
