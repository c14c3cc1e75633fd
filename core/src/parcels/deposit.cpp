#include "parcels/deposit.hpp"

#include <algorithm>
#include <limits>

#include "base/parallel.hpp"
#include "parcels/margin.hpp"

namespace pileus::parcels {
namespace {

constexpr std::size_t read_ahead = 8;

void run_kernel(DepositJob<3>& job, int width) {
  (width == 1 ? kernels().deposit_volume_3d : kernels().deposit_3d)(job);
}
void run_kernel(DepositJob<2>& job, int width) {
  (width == 1 ? kernels().deposit_volume_2d : kernels().deposit_2d)(job);
}

/// Half cells at the walls hold half the volume: double them; what lies beyond a wall is the mirror
/// image of parcels inside: add it one level inside.
void fold_column(double* column, int nz, int width) {
  const auto level = [&](int k) { return column + std::ptrdiff_t(k + 1) * width; };
  // With a single layer of cells the level inside is the other wall, a half cell itself.
  const double inside = nz == 1 ? 2.0 : 1.0;
  for (int f = 0; f < width; ++f) {
    level(0)[f] *= 2;
    level(nz)[f] *= 2;
    level(1)[f] += inside * level(-1)[f];
    level(nz - 1)[f] += inside * level(nz + 1)[f];
  }
}

/// Divides the sums of one column by its volumes; returns the number of empty nodes.
std::size_t divide_column(double* column, int nz, int width) {
  std::size_t empty = 0;
  for (int k = 0; k <= nz; ++k) {
    double* node = column + std::ptrdiff_t(k + 1) * width;
    if (node[0] > 0) {
      const double inverse = 1.0 / node[0];
      for (int f = 1; f < width; ++f) node[f] *= inverse;
    } else {
      std::fill(node, node + width, 0.0);
      ++empty;
    }
  }
  return empty;
}

}  // namespace

template <int D>
std::size_t SupportOffsets<D>::capacity() const {
  std::size_t smallest = data_[0]->size();
  for (const auto* component : data_) smallest = std::min(smallest, component->size());
  return smallest;
}

template <int D>
void SupportOffsets<D>::resize(std::size_t parcels) {
  for (auto* component : data_) component->discard_and_resize(parcels + parcels / 32 + read_ahead);
}

template <int D>
void SupportOffsets<D>::update(const Store& store) {
  if (store.size() + read_ahead > capacity()) resize(store.size());
  const double* shape[D == 3 ? 6 : 3];
  double* offset[components];
  for (int c = 0; c < store.shape_components(); ++c) shape[c] = store.shape(c);
  for (int c = 0; c < components; ++c) offset[c] = scratch(c);
  const auto compute = D == 3 ? kernels().support_offsets_3d : kernels().support_offsets_2d;
  parallel_chunks(store.size(),
                  [&](std::size_t begin, std::size_t end) { compute(shape, offset, begin, end); });
}

template <int D>
std::size_t SupportOffsets<D>::allocated_bytes() const {
  std::size_t bytes = 0;
  for (const auto& component : own_) bytes += component.allocated_bytes();
  return bytes;
}

template <int D>
Deposit<D>::Deposit(const mesh::Grid<D>& grid)
    : grid_(grid),
      kernel_grid_(make_kernel_grid(grid)),
      tiling_(grid),
      stray_count_(tiling_.tiles().size()) {}

template <int D>
DepositJob<D> Deposit<D>::describe(const Store& store, const SupportOffsets<D>* offsets,
                                   const std::vector<const double*>& values, double* field) const {
  DepositJob<D> job{};
  job.grid = kernel_grid_;
  for (int d = 0; d < D; ++d) job.position[d] = store.position(d);
  for (int c = 0; c < store.shape_components(); ++c) job.shape[c] = store.shape(c);
  for (int c = 0; offsets != nullptr && c < SupportOffsets<D>::components; ++c)
    job.offset[c] = offsets->component(c);
  job.volume = store.volume();
  job.value_count = static_cast<int>(values.size());
  for (int f = 0; f < job.value_count; ++f) job.value[f] = values[static_cast<std::size_t>(f)];
  job.reference_value = -1;
  job.field = field;
  return job;
}

template <int D>
void Deposit<D>::run(const DepositJob<D>& whole, std::size_t parcels,
                     const std::vector<std::size_t>& tile_begin, int width) {
  const std::size_t doubles = grid_.nodes() * static_cast<std::size_t>(width);
  parallel_chunks(
      doubles,
      [&](std::size_t begin, std::size_t end) {
        std::fill(whole.field + begin, whole.field + end, 0.0);
      },
      1u << 15);
  if (strays_.size() < parcels) resize_with_margin(strays_, parcels);

  for (const auto& colour : tiling_.colours())
    parallel_tasks(colour.size(), [&](std::size_t task) {
      const std::uint32_t t = colour[task];
      DepositJob<D> job = whole;
      job.begin = tile_begin[t];
      job.end = tile_begin[t + 1];
      for (int d = 0; d < 2; ++d) {
        job.tile_first[d] = tiling_.tiles()[t].first[d];
        job.tile_count[d] = tiling_.tiles()[t].count[d];
      }
      job.strays = strays_.data() + job.begin;
      job.stray_count = 0;
      run_kernel(job, width);
      stray_count_[t] = job.stray_count;
    });

  for (std::size_t t = 0; t < stray_count_.size(); ++t)
    for (std::size_t s = 0; s < stray_count_[t]; ++s) {
      DepositJob<D> job = whole;
      job.begin = strays_[tile_begin[t] + s];
      job.end = job.begin + 1;
      job.tile_first[0] = job.tile_first[1] = 0;
      job.tile_count[0] = job.tile_count[1] = std::numeric_limits<std::int32_t>::max();
      job.strays = nullptr;
      run_kernel(job, width);
    }
}

template <int D>
std::size_t Deposit<D>::finish_means(double* field) const {
  constexpr int width = mesh::DepositRecord<D>::width;
  const std::size_t stride = static_cast<std::size_t>(grid_.levels()) * width;
  return ordered_reduce(
      grid_.columns(), std::size_t{0},
      [&](std::size_t begin, std::size_t end) {
        std::size_t empty = 0;
        for (std::size_t c = begin; c < end; ++c) {
          fold_column(field + c * stride, grid_.nz(), width);
          empty += divide_column(field + c * stride, grid_.nz(), width);
        }
        return empty;
      },
      [](std::size_t a, std::size_t b) { return a + b; }, 64);
}

template <int D>
std::size_t Deposit<D>::means(const Store& store, const SupportOffsets<D>& offsets,
                              const std::vector<std::size_t>& tile_begin,
                              const std::vector<const double*>& values, double* field) {
  run(describe(store, &offsets, values, field), store.size(), tile_begin,
      mesh::DepositRecord<D>::width);
  return finish_means(field);
}

template <int D>
std::size_t Deposit<D>::means(const Store& store, const std::vector<std::size_t>& tile_begin,
                              const std::vector<const double*>& values,
                              const LinearReference& reference, double* field) {
  DepositJob<D> job = describe(store, nullptr, values, field);
  job.reference_value = reference.value;
  job.reference_intercept = reference.intercept;
  job.reference_slope = reference.slope;
  run(job, store.size(), tile_begin, mesh::DepositRecord<D>::width);
  return finish_means(field);
}

template <int D>
void Deposit<D>::volume(const Store& store, const SupportOffsets<D>& offsets,
                        const std::vector<std::size_t>& tile_begin, double* field) {
  run(describe(store, &offsets, {}, field), store.size(), tile_begin, 1);
  const std::size_t stride = static_cast<std::size_t>(grid_.levels());
  parallel_chunks(
      grid_.columns(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) fold_column(field + c * stride, grid_.nz(), 1);
      },
      64);
}

template class SupportOffsets<2>;
template class SupportOffsets<3>;
template class Deposit<2>;
template class Deposit<3>;

}  // namespace pileus::parcels
