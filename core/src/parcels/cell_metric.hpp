// Lengths as the mesh sees them: measured in cells that are made cubes of the same volume.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "mesh/grid.hpp"

namespace pileus::parcels {

/// What is long, and who is near, depends on the mesh: in cells ten times as wide as high a parcel
/// of the cell's own shape is round, and its neighbour one cell to the side as near as the one
/// above. Cubic cells measure lengths as they are, bit for bit.
template <int D>
struct CellMetric {
  double edge;                    // m, of the cube (square) of the cell's volume
  std::array<double, D> stretch;  // by which each direction is stretched to make the cell a cube
  bool cubic;

  explicit CellMetric(const mesh::Grid<D>& grid) {
    constexpr double rounding = 1e-12;  // of spacings that are meant to be equal
    const auto [least, most] = std::minmax_element(grid.spacing.begin(), grid.spacing.end());
    cubic = *most <= *least * (1 + rounding);
    edge = cubic ? *least : std::pow(grid.cell_volume(), 1.0 / D);
    for (int d = 0; d < D; ++d)
      stretch[static_cast<std::size_t>(d)] =
          cubic ? 1.0 : edge / grid.spacing[static_cast<std::size_t>(d)];
  }
};

}  // namespace pileus::parcels
