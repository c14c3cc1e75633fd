// The parcel nearest to another by distance of centres in the metric of the cell, quick however
// many share a cell.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "parcels/cell_metric.hpp"
#include "parcels/cell_order.hpp"
#include "parcels/store.hpp"

namespace pileus::parcels {

/// How many periods lie between two points less than one and a half apart: −1, 0 or 1.
inline int periods_between(double difference, double extent) {
  return int(difference >= 0.5 * extent) - int(difference <= -0.5 * extent);
}

/// Shortest way around a periodic direction, between points of the domain.
inline double minimum_image(double difference, double extent) {
  return difference >= 0.5 * extent    ? difference - extent
         : difference <= -0.5 * extent ? difference + extent
                                       : difference;
}

template <int D>
class NearestParcel {
 public:
  static constexpr std::uint32_t nobody = std::numeric_limits<std::uint32_t>::max();

  explicit NearestParcel(const mesh::Grid<D>& grid) : grid_(grid), metric_(grid) {}

  /// Builds search trees in the cells that hold too many parcels to look at each; `order` must be
  /// sorted for the present positions. Both must live and stay as they are while of() is used.
  void prepare(const Store& store, const CellOrder<D>& order);

  /// Nearest other parcel among the cells around the node nearest to parcel p, and around ever more
  /// of them while those are empty. Equal distances go to the smaller identity, so that the answer
  /// depends on positions and identities alone. `nobody` if there is none or p is nowhere.
  std::uint32_t of(std::uint32_t p) const;

 private:
  /// Parcels [begin, end) of ranked_, all inside a box. A node with children has them at the next
  /// place and at `second_child`.
  struct Node {
    double low[D], high[D];
    std::uint64_t smallest_uid;
    std::uint32_t begin, end, second_child;  // 0: a leaf
  };
  struct Best {
    double distance = std::numeric_limits<double>::infinity();
    std::uint32_t parcel = nobody;
  };

  void build(std::uint32_t begin, std::uint32_t end);
  double least_distance(std::uint32_t p, const Node& node) const;
  void consider(std::uint32_t p, std::uint32_t begin, std::uint32_t end, Best& best) const;
  void consider_cell(std::uint32_t p, const std::array<int, D>& cell, Best& best) const;
  void search_around(std::uint32_t p, const std::array<double, D>& xi,
                     const std::array<int, D>& node, Best& best) const;
  void descend(std::uint32_t p, std::uint32_t node, Best& best) const;
  bool may_improve(double distance, std::uint64_t uid, const Best& best) const;

  mesh::Grid<D> grid_;
  CellMetric<D> metric_;
  const Store* store_ = nullptr;
  const CellOrder<D>* order_ = nullptr;
  bool crowded_ = false;
  std::vector<std::uint32_t> ranked_;  // parcels in cell order, inside crowded cells by tree
  std::vector<std::uint32_t> root_;    // per cell: place of its tree plus one, or 0
  std::vector<Node> nodes_;
};

}  // namespace pileus::parcels
