#include "parcels/split.hpp"

#include <cmath>

#include "parcels/ellipsoid.hpp"
#include "parcels/identity.hpp"
#include "parcels/walls.hpp"

namespace pileus::parcels {

template <int D>
SplitCriterion<D> SplitCriterion<D>::make(const mesh::Grid<D>& grid, double max_aspect_ratio,
                                          double max_volume_ratio) {
  constexpr double radius_of_unit_volume = 0.62035049089940001667;  // (3/(4π))^(1/3)
  const double longest = radius_of_unit_volume * CellMetric<D>(grid).edge;
  return {max_aspect_ratio * max_aspect_ratio, longest * longest,
          grid.cell_volume() / max_volume_ratio};
}

template <int D>
void split_pair(Store& store, const mesh::Grid<D>& grid, const CellMetric<D>& metric,
                std::size_t first, std::size_t second, std::uint64_t step) {
  double axis[D];  // unit vector of the longest axis, mapped back from the cell's metric
  double a2;
  double shape_in_cell[D == 3 ? 6 : 3];
  for (int i = 0, c = 0; i < D; ++i)
    for (int j = i; j < D; ++j, ++c)
      shape_in_cell[c] =
          store.shape(c)[first] * (metric.stretch[std::size_t(i)] * metric.stretch[std::size_t(j)]);
  if constexpr (D == 3) {
    const auto axes = baseline::principal_axes(
        baseline::Symmetric3<double>{shape_in_cell[0], shape_in_cell[1], shape_in_cell[2],
                                     shape_in_cell[3], shape_in_cell[4], shape_in_cell[5]});
    a2 = axes.a2;
    axis[0] = axes.major.x;
    axis[1] = axes.major.y;
    axis[2] = axes.major.z;
  } else {
    const auto axes = baseline::principal_axes(
        baseline::Symmetric2<double>{shape_in_cell[0], shape_in_cell[1], shape_in_cell[2]});
    a2 = axes.a2;
    axis[0] = axes.major_x;
    axis[1] = axes.major_z;
  }
  for (int d = 0; d < D; ++d) axis[d] /= metric.stretch[std::size_t(d)];
  const double h = (D == 3 ? 0.5 * std::sqrt(0.6) : 0.25 * std::sqrt(3.0)) * std::sqrt(a2);
  int c = 0;
  for (int i = 0; i < D; ++i)
    for (int j = i; j < D; ++j, ++c) {
      const double shape = store.shape(c)[first] - 0.75 * a2 * axis[i] * axis[j];
      store.shape(c)[first] = store.shape(c)[second] = shape;
    }
  for (int d = 0; d < D; ++d) {
    const double x = store.position(d)[first];
    store.position(d)[first] = x + h * axis[d];
    store.position(d)[second] = x - h * axis[d];
  }
  const double half = 0.5 * store.volume()[first];
  store.volume()[first] = store.volume()[second] = half;
  for (std::size_t s = 0; s < store.scalars().size(); ++s)
    if (store.scalars()[s].nature == Nature::extensive) {
      double* value = store.scalar(static_cast<int>(s));
      value[second] = 0.5 * value[first];
      value[first] -= value[second];  // exact: the halves sum to the whole
    }
  store.uid()[second] = child_uid(store.uid()[first], step);
  confine<D>(store, grid, first);
  confine<D>(store, grid, second);
}

template struct SplitCriterion<2>;
template struct SplitCriterion<3>;
template void split_pair<2>(Store&, const mesh::Grid<2>&, const CellMetric<2>&, std::size_t,
                            std::size_t, std::uint64_t);
template void split_pair<3>(Store&, const mesh::Grid<3>&, const CellMetric<3>&, std::size_t,
                            std::size_t, std::uint64_t);

}  // namespace pileus::parcels
