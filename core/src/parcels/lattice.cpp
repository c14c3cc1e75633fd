#include "parcels/lattice.hpp"

#include <algorithm>
#include <cmath>

#include "base/parallel.hpp"
#include "parcels/identity.hpp"
#include "parcels/walls.hpp"

namespace pileus::parcels {
namespace {

/// Uniform in (−1, 1), a function of its arguments alone.
double symmetric_uniform(std::uint64_t seed, std::uint64_t uid, unsigned direction) {
  const std::uint64_t bits = mix(mix(seed + 0x9e3779b97f4a7c15ull) ^ mix(4 * uid + direction));
  return (static_cast<double>(bits >> 11) + 0.5) * 0x1p-52 - 1.0;
}

}  // namespace

int parcels_per_direction(int per_cell, int dimension) {
  const int m = static_cast<int>(std::lround(std::pow(per_cell, 1.0 / dimension)));
  int power = 1;
  for (int d = 0; d < dimension; ++d) power *= m;
  return per_cell > 0 && power == per_cell ? m : 0;
}

template <int D>
void fill_lattice(Store& store, const mesh::Grid<D>& grid, const LatticeControl& control) {
  const int per_cell = control.per_cell;
  const auto m = static_cast<std::size_t>(parcels_per_direction(per_cell, D));
  std::size_t count[3] = {1, 1, 1};  // lattice points: x, y, z
  for (int d = 0; d < D - 1; ++d) count[d] = m * static_cast<std::size_t>(grid.cells[d]);
  count[2] = m * static_cast<std::size_t>(grid.nz());
  store.resize(count[0] * count[1] * count[2]);
  const double volume = grid.cell_volume() / per_cell;
  // Semi-axes in the ratio of the cell's edges, enclosing the parcel's volume:
  // (abc)² = (3V/4π)² in 3D, (ab)² = (V/π)² in 2D.
  const double radius_power =
      D == 3 ? volume * 0.23873241463784300365 : volume * 0.31830988618379067154;
  const double radius2 = std::pow(radius_power, 2.0 / D);
  const double mean_spacing2 = std::pow(grid.cell_volume(), 2.0 / D);

  parallel_chunks(store.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      const std::size_t index[3] = {p / count[2] % count[0], p / (count[2] * count[0]),
                                    p % count[2]};
      const std::uint64_t uid = p + 1;
      store.uid()[p] = uid;
      store.volume()[p] = volume;
      int c = 0;
      for (int d = 0; d < D; ++d) {
        const std::size_t i = d == D - 1 ? index[2] : index[d];
        const double spacing = grid.spacing[d] / static_cast<double>(m);
        double x = grid.lower[d] + spacing * (static_cast<double>(i) + control.offset);
        if (control.jitter > 0)
          x += control.jitter * spacing * symmetric_uniform(control.seed, uid, unsigned(d));
        store.position(d)[p] = x;
        for (int e = d; e < D; ++e, ++c)
          store.shape(c)[p] =
              e == d ? radius2 * grid.spacing[d] * grid.spacing[d] / mean_spacing2 : 0.0;
      }
      for (int v = 0; v < store.vorticity_components(); ++v) store.vorticity(v)[p] = 0;
      for (std::size_t s = 0; s < store.scalars().size(); ++s)
        store.scalar(static_cast<int>(s))[p] = 0;
      hold_inside<D>(store, grid, p);
    }
  });
}

std::size_t keep_positive(Store& store, const std::vector<double>& indicator) {
  std::vector<std::uint32_t> kept;
  double kept_volume = 0, volume = 0;
  for (std::size_t p = 0; p < store.size(); ++p) {
    volume += store.volume()[p];
    if (!(indicator[p] > 0)) continue;
    kept_volume += store.volume()[p];
    kept.push_back(static_cast<std::uint32_t>(p));
  }
  if (kept.empty() || kept.size() == store.size()) return kept.size();
  AlignedArray<double> spare;
  store.gather(kept, spare);
  const double growth = volume / kept_volume;
  const double shape_growth = std::pow(growth, 2.0 / store.dimension());
  for (std::size_t p = 0; p < store.size(); ++p) {
    store.volume()[p] *= growth;
    for (int c = 0; c < store.shape_components(); ++c) store.shape(c)[p] *= shape_growth;
  }
  return kept.size();
}

template void fill_lattice<2>(Store&, const mesh::Grid<2>&, const LatticeControl&);
template void fill_lattice<3>(Store&, const mesh::Grid<3>&, const LatticeControl&);

}  // namespace pileus::parcels
