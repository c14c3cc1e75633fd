// Geometry of the regular mesh and the memory order of everything that lives on it.
//
// Nodes carry all fields (no staggering). Horizontal directions are periodic with as many nodes as
// cells; the vertical is the last direction, has walls, and stores one halo level beyond each wall.
// A column is contiguous in memory: node(column, k), k = −1 … n_z + 1. Columns are ordered with x
// fastest. A field of W interleaved values per node holds value f of a node at [node*W + f].
#pragma once
#include <array>
#include <cstddef>

namespace pileus::mesh {

template <int D>
struct Grid {
  static_assert(D == 2 || D == 3);
  static constexpr int vertical = D - 1;

  std::array<int, D> cells{};       // number of cells: x[, y], z
  std::array<double, D> lower{};    // m, corner of the domain
  std::array<double, D> extent{};   // m
  std::array<double, D> spacing{};  // m
  std::array<double, D> inverse_spacing{};

  Grid() = default;
  Grid(const std::array<int, D>& n, const std::array<double, D>& origin,
       const std::array<double, D>& size)
      : cells(n), lower(origin), extent(size) {
    for (int d = 0; d < D; ++d) {
      spacing[d] = extent[d] / cells[d];
      inverse_spacing[d] = cells[d] / extent[d];
    }
  }

  int nx() const { return cells[0]; }
  int ny() const { return D == 3 ? cells[1] : 1; }
  int nz() const { return cells[vertical]; }
  /// Stored levels of a column: k = −1 … n_z + 1.
  int levels() const { return nz() + 3; }
  std::size_t columns() const { return std::size_t(nx()) * std::size_t(ny()); }
  std::size_t nodes() const { return columns() * std::size_t(levels()); }
  std::size_t cell_count() const { return columns() * std::size_t(nz()); }

  std::size_t column(int i, int j) const {
    return std::size_t(j) * std::size_t(nx()) + std::size_t(i);
  }
  std::size_t node(std::size_t column, int k) const {
    return column * std::size_t(levels()) + std::size_t(k + 1);
  }

  double cell_volume() const {
    double volume = 1;
    for (int d = 0; d < D; ++d) volume *= spacing[d];
    return volume;
  }
  double domain_volume() const {
    double volume = 1;
    for (int d = 0; d < D; ++d) volume *= extent[d];
    return volume;
  }
  double bottom() const { return lower[vertical]; }
  double top() const { return lower[vertical] + extent[vertical]; }
};

/// Layout of the deposited record of a node: volume-weighted sums before division by the volume,
/// means after it. Eight doubles, one cache line, in 3D; four in 2D.
template <int D>
struct DepositRecord;
template <>
struct DepositRecord<3> {
  static constexpr int width = 8, volume = 0, vorticity = 1, vorticity_components = 3, buoyancy = 4,
                       first_spare = 5;
};
template <>
struct DepositRecord<2> {
  static constexpr int width = 4, volume = 0, vorticity = 1, vorticity_components = 1, buoyancy = 2,
                       first_spare = 3;
};

/// Layout of the flow record of a node: what a parcel interpolates in every stage. w_z (and in 2D
/// also u_x from w_z) follows from continuity and is not stored.
template <int D>
struct FlowRecord;
template <>
struct FlowRecord<3> {
  static constexpr int width = 16;
  static constexpr int u = 0, v = 1, w = 2;
  static constexpr int u_x = 3, u_y = 4, u_z = 5, v_x = 6, v_y = 7, v_z = 8, w_x = 9, w_y = 10;
  static constexpr int tendency = 11;  // of the three vorticity components; 14 and 15 are zero
};
template <>
struct FlowRecord<2> {
  static constexpr int width = 8;
  static constexpr int u = 0, w = 1;
  static constexpr int u_x = 2, u_z = 3, w_x = 4;
  static constexpr int tendency = 5;  // of the vorticity w_x − u_z; 6 and 7 are zero
};

}  // namespace pileus::mesh
