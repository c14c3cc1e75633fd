#include "parcels/correction.hpp"

#include <algorithm>
#include <cmath>

#include "base/parallel.hpp"
#include "parcels/walls.hpp"

namespace pileus::parcels {
namespace {

constexpr std::size_t gradient_width(int dimension) {
  return dimension == 3 ? 4 : 2;
}

void run_kernel(const DisplaceJob<3>& job) {
  kernels().displace_3d(job);
}
void run_kernel(const DisplaceJob<2>& job) {
  kernels().displace_2d(job);
}
void run_kernel(const CompressJob<3>& job) {
  kernels().compress_3d(job);
}
void run_kernel(const CompressJob<2>& job) {
  kernels().compress_2d(job);
}

}  // namespace

template <int D>
VolumeCorrection<D>::VolumeCorrection(const mesh::Grid<D>& grid, const CorrectionControl& control)
    : grid_(grid), control_(control), potential_(grid) {}

template <int D>
void VolumeCorrection<D>::deposit_excess(const Store& store, const SupportOffsets<D>& offsets,
                                         const std::vector<std::size_t>& tile_begin,
                                         Deposit<D>& deposit) {
  deposit.volume(store, offsets, tile_begin, excess_);
  const double inverse = 1.0 / grid_.cell_volume();
  parallel_chunks(
      grid_.columns(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) {
          double* column = excess_ + grid_.node(c, 0);
          const int nz = grid_.nz();
          for (int k = 0; k <= nz; ++k) column[k] = column[k] * inverse - 1.0;
          // Beyond a wall, where a centre exactly on it may look: no difference across the wall.
          column[-1] = column[1];
          column[nz + 1] = column[nz - 1];
        }
      },
      64);
}

template <int D>
void VolumeCorrection<D>::displace(Store& store) const {
  parallel_chunks(store.size(), [&](std::size_t begin, std::size_t end) {
    DisplaceJob<D> job{};
    job.grid = make_kernel_grid(grid_);
    for (int d = 0; d < D; ++d) job.position[d] = store.position(d);
    job.gradient = gradient_;
    job.begin = begin;
    job.end = end;
    run_kernel(job);
    for (std::size_t p = begin; p < end; ++p) hold_inside<D>(store, grid_, p);
  });
}

template <int D>
void VolumeCorrection<D>::compress(Store& store) const {
  parallel_chunks(store.size(), [&](std::size_t begin, std::size_t end) {
    CompressJob<D> job{};
    job.grid = make_kernel_grid(grid_);
    for (int d = 0; d < D; ++d) {
      job.position[d] = store.position(d);
      job.spacing[d] = grid_.spacing[static_cast<std::size_t>(d)];
    }
    job.excess = excess_;
    job.prefactor = control_.gradient_prefactor;
    job.limit = control_.max_compression;
    job.begin = begin;
    job.end = end;
    run_kernel(job);
    for (std::size_t p = begin; p < end; ++p) hold_inside<D>(store, grid_, p);
  });
}

template <int D>
void VolumeCorrection<D>::run(Store& store, const SupportOffsets<D>& offsets,
                              const std::vector<std::size_t>& tile_begin, Deposit<D>& deposit,
                              std::span<double> lent) {
  if (control_.iterations == 0) return;
  const std::size_t nodes = mesh::aligned_doubles(grid_.nodes());
  const std::size_t gradient = nodes * gradient_width(D);
  const std::size_t needed = nodes + gradient + potential_.room_needed();
  if (lent.size() < needed && own_.size() < needed) own_.discard_and_resize(needed);
  excess_ = lent.size() < needed ? own_.data() : lent.data();
  gradient_ = excess_ + nodes;
  for (int i = 0; i < control_.iterations; ++i) {
    deposit_excess(store, offsets, tile_begin, deposit);
    potential_.solve(excess_, gradient_, gradient_ + gradient);
    displace(store);
    deposit_excess(store, offsets, tile_begin, deposit);
    compress(store);
  }
}

template class VolumeCorrection<2>;
template class VolumeCorrection<3>;

}  // namespace pileus::parcels
