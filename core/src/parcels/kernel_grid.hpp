// The mesh as the kernels see it: plain numbers, no functions, safe to share between instruction
// sets.
#pragma once
#include <cstdint>

#include "mesh/grid.hpp"

namespace pileus::parcels {

template <int D>
struct KernelGrid {
  double lower[D];
  double inverse_spacing[D];
  double cells_real[D];  // number of cells as a double
  double inverse_cells[D];
  std::int32_t cells[D];
  std::int32_t levels;  // stored levels of a column
};

template <int D>
KernelGrid<D> make_kernel_grid(const mesh::Grid<D>& grid) {
  KernelGrid<D> g{};
  for (int d = 0; d < D; ++d) {
    g.lower[d] = grid.lower[d];
    g.inverse_spacing[d] = grid.inverse_spacing[d];
    g.cells_real[d] = grid.cells[d];
    g.inverse_cells[d] = 1.0 / grid.cells[d];
    g.cells[d] = grid.cells[d];
  }
  g.levels = grid.levels();
  return g;
}

}  // namespace pileus::parcels
