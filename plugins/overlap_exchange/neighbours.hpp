// Which parcels sit in and around a cell.
#pragma once
#include <pileus/abi.h>

#include <cmath>
#include <cstdint>
#include <span>

namespace pileus::overlap {

/// Cells of the mesh along the directions of the parcels (x, z or x, y, z).
template <int D>
struct Cells {
  std::int64_t count[D];
  double origin[D], spacing[D];

  explicit Cells(const pileus_grid& grid) {
    for (int d = 0; d < D; ++d) {
      const int axis = d == D - 1 ? 2 : d;
      count[d] = grid.cells[axis];
      origin[d] = grid.origin[axis];
      spacing[d] = grid.spacing[axis];
    }
  }
  std::int64_t total() const {
    std::int64_t product = 1;
    for (int d = 0; d < D; ++d) product *= count[d];
    return product;
  }
  /// Cell along one direction, held inside the domain.
  std::int64_t along(int d, double x) const {
    const double xi = std::floor((x - origin[d]) / spacing[d]);
    const auto last = static_cast<double>(count[d] - 1);
    return static_cast<std::int64_t>(xi > 0 ? std::fmin(xi, last) : 0.0);
  }
  /// Separation along a direction, the shortest of the periodic ones sideways.
  double separation(int d, double from, double to) const {
    const double apart = to - from;
    if (d == D - 1) return apart;
    const double length = static_cast<double>(count[d]) * spacing[d];
    return apart - length * std::nearbyint(apart / length);
  }
};

/// Parcels listed by cell: a counting sort, the same for any number of threads.
struct CellLists {
  std::span<std::int64_t> begin;   // total + 1
  std::span<std::int64_t> parcel;  // in cell order
};

/// Calls visit(cell) for the cells at most one away in every direction, each once.
template <int D, class Visit>
void around(const Cells<D>& cells, const std::int64_t* centre, Visit&& visit) {
  std::int64_t first[D], number[D];
  for (int d = 0; d < D; ++d) {
    if (d == D - 1) {
      first[d] = centre[d] > 0 ? centre[d] - 1 : 0;
      number[d] = (centre[d] + 1 < cells.count[d] ? centre[d] + 1 : centre[d]) - first[d] + 1;
    } else {
      first[d] = centre[d] - 1;
      number[d] = cells.count[d] < 3 ? cells.count[d] : 3;
    }
  }
  std::int64_t steps = 1;
  for (int d = 0; d < D; ++d) steps *= number[d];
  for (std::int64_t n = 0; n < steps; ++n) {
    std::int64_t rest = n, index = 0, stride = 1;
    for (int d = 0; d < D; ++d) {
      const std::int64_t at = first[d] + rest % number[d];
      rest /= number[d];
      index += (d == D - 1 ? at : (at + cells.count[d]) % cells.count[d]) * stride;
      stride *= cells.count[d];
    }
    visit(index);
  }
}

template <int D>
std::int64_t cell_index(const Cells<D>& cells, const std::int64_t* at) {
  std::int64_t index = 0, stride = 1;
  for (int d = 0; d < D; ++d) {
    index += at[d] * stride;
    stride *= cells.count[d];
  }
  return index;
}

}  // namespace pileus::overlap
