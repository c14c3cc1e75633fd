// Which parcels sit in which cell: a counting sort of parcel indices by tile, column and level.
#pragma once
#include <cstdint>
#include <vector>

#include "parcels/kernel_grid.hpp"
#include "parcels/store.hpp"
#include "parcels/tiling.hpp"

namespace pileus::parcels {

template <int D>
class CellOrder {
 public:
  CellOrder(const mesh::Grid<D>& grid, const Tiling<D>& tiling);

  /// Sorts the parcels' indices by cell of their centre; stable, so the result depends on the
  /// previous order and the positions alone.
  /// `keys` is room for the time of the call.
  void sort(const Store& store, std::vector<std::uint32_t>& keys);

  /// Parcel indices in cell order.
  const std::vector<std::uint32_t>& order() const { return order_; }
  /// Parcels of cell (i, j, k) are order()[first(key)] … order()[first(key+1) − 1].
  std::uint32_t first(std::size_t key) const { return first_[key]; }
  std::size_t key(int i, int j, int k) const {
    return std::size_t(rank_[grid_.column(i, j)]) * std::size_t(grid_.nz()) + std::size_t(k);
  }
  /// First key of a column rank.
  std::size_t key_of_rank(std::uint32_t rank) const {
    return std::size_t(rank) * std::size_t(grid_.nz());
  }
  std::size_t allocated_bytes() const {
    return (order_.capacity() + first_.capacity()) * sizeof(std::uint32_t);
  }

 private:
  mesh::Grid<D> grid_;
  std::vector<std::uint32_t> rank_;  // column → rank
  std::vector<std::uint32_t> order_, first_;
};

/// Index of the cell (or node) below a coordinate in a periodic direction of n cells; any distance
/// from the domain is wrapped, a value that is not a number gives 0.
inline int periodic_cell(double x, double lower, double inverse_spacing, int n) {
  double xi = (x - lower) * inverse_spacing;
  xi -= n * __builtin_floor(xi / n);
  if (!(xi > 0)) return 0;
  // So far away that rounding leaves more than a period: any cell will do, but it must be one.
  return xi < n ? static_cast<int>(xi) : n - 1;
}
/// Index of the cell of a height, held inside the walls.
inline int vertical_cell(double z, double lower, double inverse_spacing, int n) {
  const double xi = (z - lower) * inverse_spacing;
  if (!(xi > 0)) return 0;
  return xi < n ? static_cast<int>(xi) : n - 1;
}

}  // namespace pileus::parcels
