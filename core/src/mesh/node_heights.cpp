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
  double below = at(0)[Record::buoyancy];  // of the level below, as gathered
  for (int k = 0; k <= top; ++k) {
    double* node = at(k);
    const double gathered = node[Record::buoyancy];
    const int low = k > 0 && at(k - 1)[Record::volume] > 0 ? k - 1 : k;
    const int high = k < top && at(k + 1)[Record::volume] > 0 ? k + 1 : k;
    if (low != high && node[Record::volume] > 0) {
      const double difference =
          (high > k ? at(high)[Record::buoyancy] : gathered) - (low < k ? below : gathered);
      const double apart = at(high)[mean_height<D>] - at(low)[mean_height<D>];
      // What neighbouring nodes gathered may lie close together; then the slope is that over the
      // least distance told apart, half of the mesh's own.
      const double least = 0.5 * (node_height(grid, high) - node_height(grid, low));
      const double slope = difference / std::max(apart, least);
      node[Record::buoyancy] = gathered - (node[mean_height<D>] - node_height(grid, k)) * slope;
    }
    below = gathered;
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
