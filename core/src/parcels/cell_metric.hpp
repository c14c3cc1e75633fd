// Lengths as the mesh sees them: measured in cells that are made cubes of the same volume.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

#include "mesh/grid.hpp"

namespace pileus::parcels {

/// What is long, and who is near, depends on the mesh: in cells ten times as wide as high a parcel
/// of the cell's own shape is round, and its neighbour one cell to the side as near as the one
/// above. Cells up to twice as long as short, for which the method was published (EPIC refuses
/// others), measure lengths as they are, and its criteria apply unchanged.
template <int D>
struct CellMetric {
  double edge;                    // m, of the cube (square) of the cell's volume; shortest if plain
  std::array<double, D> stretch;  // by which each direction is stretched to make the cell a cube
  bool plain;                     // lengths are measured as they are

  explicit CellMetric(const mesh::Grid<D>& grid) {
    constexpr double published = 2;
    constexpr double rounding = 1e-12;  // of spacings that are meant to be in that ratio
    const auto [least, most] = std::minmax_element(grid.spacing.begin(), grid.spacing.end());
    plain = *most <= published * *least * (1 + rounding);
    edge = plain ? *least : std::pow(grid.cell_volume(), 1.0 / D);
    for (int d = 0; d < D; ++d)
      stretch[static_cast<std::size_t>(d)] =
          plain ? 1.0 : edge / grid.spacing[static_cast<std::size_t>(d)];
  }
};

}  // namespace pileus::parcels
