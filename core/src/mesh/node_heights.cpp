#include "mesh/node_heights.hpp"

#include <algorithm>

#include "base/parallel.hpp"

namespace pileus::mesh {
namespace {

/// h of level k, m.
template <int D>
double node_height(const Grid<D>& grid, int k) {
  const double inside = k == 0 ? 1.0 / 3 : k == grid.nz() ? -1.0 / 3 : 0.0;
  return grid.bottom() + (k + inside) * grid.spacing[D - 1];
}

template <int D>
void refer_column(const Grid<D>& grid, double* column) {
  using Record = DepositRecord<D>;
  const int top = grid.nz();
  const auto at = [&](int k) { return column + std::ptrdiff_t(k) * Record::width; };
  double below = 0, height_below = 0;  // of the level below, as gathered
  for (int k = 0; k <= top; ++k) {
    double* node = at(k);
    const double gathered = node[Record::buoyancy], height = node[mean_height<D>];
    const bool has_low = k > 0 && at(k - 1)[Record::volume] > 0;
    const bool has_high = k < top && at(k + 1)[Record::volume] > 0;
    if ((has_low || has_high) && node[Record::volume] > 0) {
      const double difference =
          (has_high ? at(k + 1)[Record::buoyancy] : gathered) - (has_low ? below : gathered);
      const double apart =
          (has_high ? at(k + 1)[mean_height<D>] : height) - (has_low ? height_below : height);
      // What neighbouring nodes gathered may lie close together; then the slope is that over the
      // least distance told apart, half of the mesh's own.
      const double least =
          0.5 * (node_height(grid, has_high ? k + 1 : k) - node_height(grid, has_low ? k - 1 : k));
      const double slope = difference / std::max(apart, least);
      node[Record::buoyancy] = gathered - (height - node_height(grid, k)) * slope;
    }
    node[gathered_buoyancy<D>] = gathered;
    below = gathered;
    height_below = height;
  }
}

}  // namespace

template <int D>
void refer_buoyancy_to_nodes(const Grid<D>& grid, double* records) {
  parallel_chunks(
      grid.columns(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c)
          refer_column(grid, records + grid.node(c, 0) * std::size_t(DepositRecord<D>::width));
      },
      64);
}

template void refer_buoyancy_to_nodes<2>(const Grid<2>&, double*);
template void refer_buoyancy_to_nodes<3>(const Grid<3>&, double*);

}  // namespace pileus::mesh
