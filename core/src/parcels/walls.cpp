#include "parcels/walls.hpp"

#include <algorithm>
#include <cmath>

#include "base/parallel.hpp"

namespace pileus::parcels {

namespace {

template <int D>
void wrap(Store& store, const mesh::Grid<D>& grid, std::size_t p) {
  for (int a = 0; a < D - 1; ++a) {
    double& x = store.position(a)[p];
    const double lower = grid.lower[a], upper = lower + grid.extent[a];
    if (x >= lower && x < upper) continue;
    const double offset = x - lower;
    x = lower + (offset - grid.extent[a] * std::floor(offset / grid.extent[a]));
    // Rounded up to the seam or below it; a value that is not a number stays one, to be noticed.
    if (x >= upper || x < lower) x = lower;
  }
}

}  // namespace

template <int D>
void hold_inside(Store& store, const mesh::Grid<D>& grid, std::size_t p) {
  wrap<D>(store, grid, p);
  double& z = store.position(D - 1)[p];
  z = std::clamp(z, grid.bottom(), grid.top());
}

template <int D>
void confine(Store& store, const mesh::Grid<D>& grid, std::size_t p) {
  wrap<D>(store, grid, p);
  double& z = store.position(D - 1)[p];
  const double bottom = grid.bottom(), top = grid.top();
  if (z >= bottom && z <= top) return;
  z = std::clamp(z < bottom ? 2 * bottom - z : 2 * top - z, bottom, top);
  if constexpr (D == 3) {
    store.shape(2)[p] = -store.shape(2)[p];
    store.shape(4)[p] = -store.shape(4)[p];
  } else {
    store.shape(1)[p] = -store.shape(1)[p];
  }
}

template <int D>
void confine(Store& store, const mesh::Grid<D>& grid) {
  parallel_chunks(store.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) confine<D>(store, grid, p);
  });
}

template void confine<2>(Store&, const mesh::Grid<2>&);
template void confine<3>(Store&, const mesh::Grid<3>&);
template void hold_inside<2>(Store&, const mesh::Grid<2>&, std::size_t);
template void hold_inside<3>(Store&, const mesh::Grid<3>&, std::size_t);
template void confine<2>(Store&, const mesh::Grid<2>&, std::size_t);
template void confine<3>(Store&, const mesh::Grid<3>&, std::size_t);

}  // namespace pileus::parcels
