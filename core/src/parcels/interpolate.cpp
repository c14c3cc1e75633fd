#include "parcels/interpolate.hpp"

#include <algorithm>

#include "base/parallel.hpp"
#include "parcels/kernels.hpp"

namespace pileus::parcels {
namespace {

void run_kernel(const InterpolateJob<3>& job) {
  kernels().interpolate_3d(job);
}
void run_kernel(const InterpolateJob<2>& job) {
  kernels().interpolate_2d(job);
}

}  // namespace

template <int D>
void mirror_halo(const mesh::Grid<D>& grid, double* field) {
  constexpr int width = interpolated_width<D>;
  const int nz = grid.nz();
  parallel_chunks(
      grid.columns(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) {
          const auto level = [&](int k) { return field + grid.node(c, k) * width; };
          std::copy_n(level(1), width, level(-1));
          std::copy_n(level(nz - 1), width, level(nz + 1));
        }
      },
      64);
}

template <int D>
void interpolate(const Store& store, const mesh::Grid<D>& grid, const double* field,
                 std::span<double* const> values) {
  InterpolateJob<D> whole{};
  whole.grid = make_kernel_grid(grid);
  for (int d = 0; d < D; ++d) whole.position[d] = store.position(d);
  for (int c = 0; c < store.shape_components(); ++c) whole.shape[c] = store.shape(c);
  whole.field = field;
  whole.value_count = static_cast<int>(values.size());
  std::copy(values.begin(), values.end(), whole.value);
  parallel_chunks(store.size(), [&](std::size_t begin, std::size_t end) {
    InterpolateJob<D> job = whole;
    job.begin = begin;
    job.end = end;
    run_kernel(job);
  });
}

template void mirror_halo(const mesh::Grid<2>&, double*);
template void mirror_halo(const mesh::Grid<3>&, double*);
template void interpolate(const Store&, const mesh::Grid<2>&, const double*,
                          std::span<double* const>);
template void interpolate(const Store&, const mesh::Grid<3>&, const double*,
                          std::span<double* const>);

}  // namespace pileus::parcels
