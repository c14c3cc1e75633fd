// Which parcels are in which cell of the mesh.
#pragma once
#include <pileus/abi.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace pileus::superdroplets {

/// Cells are numbered column by column, from the bottom up. Within a cell parcels keep their order.
class CellLists {
 public:
  CellLists() = default;
  /// `y` is null in two dimensions.
  CellLists(const pileus_grid& grid, std::size_t parcels, const double* x, const double* y,
            const double* z)
      : grid_(grid), first_(cell_count(grid) + 1, 0), order_(parcels) {
    std::vector<std::uint32_t> cell(parcels);
    for (std::size_t p = 0; p < parcels; ++p) {
      cell[p] = static_cast<std::uint32_t>(column_of(x[p], y != nullptr ? y[p] : 0.0) * levels() +
                                           level_of(z[p]));
      ++first_[cell[p] + 1];
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t p = 0; p < parcels; ++p)
      order_[next[cell[p]]++] = static_cast<std::uint32_t>(p);
  }
  /// Every parcel in a cell of its own.
  static CellLists each_alone(std::size_t parcels) {
    CellLists lists;
    lists.first_.resize(parcels + 1);
    lists.order_.resize(parcels);
    std::iota(lists.first_.begin(), lists.first_.end(), 0u);
    std::iota(lists.order_.begin(), lists.order_.end(), 0u);
    return lists;
  }

  std::size_t cells() const { return first_.empty() ? 0 : first_.size() - 1; }
  std::span<const std::uint32_t> parcels(std::size_t cell) const {
    return {order_.data() + first_[cell], order_.data() + first_[cell + 1]};
  }

  std::size_t levels() const { return static_cast<std::size_t>(grid_.cells[2]); }
  std::size_t columns() const { return static_cast<std::size_t>(grid_.cells[0] * grid_.cells[1]); }
  std::size_t column_of(double x, double y) const {
    return along(0, x) + static_cast<std::size_t>(grid_.cells[0]) * along(1, y);
  }
  std::size_t level_of(double z) const { return along(2, z); }

 private:
  static std::size_t cell_count(const pileus_grid& grid) {
    return static_cast<std::size_t>(grid.cells[0] * grid.cells[1] * grid.cells[2]);
  }
  std::size_t along(int axis, double x) const {
    if (grid_.cells[axis] == 1) return 0;
    const double place = std::floor((x - grid_.origin[axis]) / grid_.spacing[axis]);
    // A place that is not a number is in the first cell: it must not lead outside the mesh.
    return place > 0 ? static_cast<std::size_t>(
                           std::min(place, static_cast<double>(grid_.cells[axis] - 1)))
                     : 0;
  }

  pileus_grid grid_{};
  std::vector<std::uint32_t> first_, order_;
};

}  // namespace pileus::superdroplets
