#include "mesh/sharpening.hpp"

#include <algorithm>
#include <cstring>
#include <utility>

#include "base/parallel.hpp"
#include "mesh/vector_clones.hpp"

namespace pileus::mesh {

namespace {

/// value += beta (value − ½ (before + after)), entry by entry.
PILEUS_VECTOR_CLONES
void sharpen(double* __restrict value, const double* __restrict before,
             const double* __restrict after, const double* __restrict beta, std::size_t count) {
  for (std::size_t n = 0; n < count; ++n)
    value[n] += beta[n] * (value[n] - 0.5 * (before[n] + after[n]));
}

/// The continuation beyond a wall: 2 wall − inside.
void extrapolate(double* beyond, const double* wall, const double* inside, int width) {
  for (int f = 0; f < width; ++f) beyond[f] = 2 * wall[f] - inside[f];
}

constexpr int line_buffers = 5;  // the first two of a line, and three that move along it

}  // namespace

double lattice_mean_product(int m) {
  double sum = 0;
  for (int i = 0; i < m; ++i) {
    const double f = (i + 0.5) / m;
    sum += f * (1 - f);
  }
  return sum / m;
}

template <int D>
Sharpening<D>::Sharpening(const Grid<D>& grid, int width, int first, int last, double beta)
    : grid_(grid), width_(width), active_(beta != 0) {
  const auto column = static_cast<std::size_t>(grid.levels() * width);
  beta_.assign(column, 0.0);
  for (std::size_t n = 0; n < column; ++n) {
    const int entry = static_cast<int>(n) % width;
    if (entry >= first && entry < last) beta_[n] = beta;
  }
  if (active_) scratch_ = ThreadScratch(line_buffers * aligned_doubles(column));
}

template <int D>
void Sharpening<D>::along_column(double* column, double* original) const {
  const int nz = grid_.nz();
  if (nz < 2) return;
  const auto level = [&](double* from, int k) { return from + (k + 1) * width_; };
  extrapolate(level(column, -1), level(column, 0), level(column, 1), width_);
  extrapolate(level(column, nz + 1), level(column, nz), level(column, nz - 1), width_);
  std::memcpy(original, column, beta_.size() * sizeof(double));
  const auto interior = static_cast<std::size_t>((nz - 1) * width_);
  sharpen(level(column, 1), level(original, -1), level(original, 3), beta_.data(), interior);
  extrapolate(level(column, -1), level(column, 0), level(column, 1), width_);
  extrapolate(level(column, nz + 1), level(column, nz), level(column, nz - 1), width_);
}

template <int D>
void Sharpening<D>::along_line(double* first, std::size_t stride, int count,
                               double* buffers) const {
  if (count < 3) return;  // two cells away is the same node
  const std::size_t size = beta_.size(), pitch = aligned_doubles(size);
  const auto keep = [&](double* to, int i) {
    std::memcpy(to, first + static_cast<std::size_t>(i) * stride, size * sizeof(double));
  };
  double *start[2] = {buffers, buffers + pitch}, *before = buffers + 2 * pitch,
         *last = buffers + 3 * pitch, *spare = buffers + 4 * pitch;
  keep(start[0], 0);
  keep(start[1], 1);
  keep(before, count - 2);
  keep(last, count - 1);
  for (int i = 0; i < count; ++i) {
    const double* after =
        i + 2 < count ? first + static_cast<std::size_t>(i + 2) * stride : start[i + 2 - count];
    keep(spare, i);
    sharpen(first + static_cast<std::size_t>(i) * stride, before, after, beta_.data(), size);
    std::swap(before, last);  // what was last is now two behind
    std::swap(last, spare);   // and the original of this one is last
  }
}

template <int D>
void Sharpening<D>::apply(double* records) {
  if (!active_) return;
  scratch_.reserve();
  const std::size_t column = beta_.size();
  const int nx = grid_.nx(), ny = grid_.ny();
  parallel_tasks(static_cast<std::size_t>(ny), [&](std::size_t j) {
    double* row = records + j * static_cast<std::size_t>(nx) * column;
    for (int i = 0; i < nx; ++i)
      along_column(row + static_cast<std::size_t>(i) * column, scratch_.mine());
    along_line(row, column, nx, scratch_.mine());
  });
  if (D == 2) return;
  parallel_tasks(static_cast<std::size_t>(nx), [&](std::size_t i) {
    along_line(records + i * column, static_cast<std::size_t>(nx) * column, ny, scratch_.mine());
  });
}

template class Sharpening<2>;
template class Sharpening<3>;

}  // namespace pileus::mesh
