#include "mesh/volume_potential.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/parallel.hpp"
#include "mesh/mode_columns.hpp"

namespace pileus::mesh {

namespace {

int conjugate(int m, int n) {
  return m == 0 ? 0 : n - m;
}

double cosine(long j, int n) {
  return std::cos(std::numbers::pi * double(j % (2L * n)) / n);
}
double sine(long j, int n) {
  return j % n == 0 ? 0 : std::sin(std::numbers::pi * double(j % (2L * n)) / n);
}

/// Wavenumber including the Nyquist one, for the Laplacian.
double full_wavenumber(int m, int n, double extent) {
  return 2 * std::numbers::pi * signed_index(m, n) / extent;
}

// A row of a 2D mesh is the whole mesh: cut it into groups of levels so that threads share it.
template <int D>
int levels_per_piece(int nz) {
  return D == 3 ? packed_levels(nz) : std::min(16, packed_levels(nz));
}

}  // namespace

/// Levels [first, first + block) of row j; the mesh has those below `last`.
template <int D>
struct VolumePotential<D>::Piece {
  int j, first, last;
  Piece(const VolumePotential& p, std::size_t task)
      : j(int(task) / p.blocks_),
        first(int(task) % p.blocks_ * p.block_),
        last(std::min(first + p.block_, p.grid_.nz() + 1)) {}
};

template <int D>
VolumePotential<D>::VolumePotential(const Grid<D>& grid, HorizontalMean mean)
    : grid_(grid),
      mean_(mean),
      block_(levels_per_piece<D>(grid.nz())),
      blocks_((grid.nz() + block_) / block_),
      levels_(block_ * blocks_),
      wavenumber_(column_pitch(grid.nz())),
      x_in_(grid.nx(), block_ / 2),
      x_out_(grid.nx(), D * block_ / 2),
      y_in_(grid.ny(), levels_ / 2),
      y_out_(grid.ny(), D * levels_ / 2) {
  const int nz = grid.nz();
  const auto end = [nz](int k) { return k == 0 || k == nz ? 0.5 : 1.0; };
  cosine_analysis_ = ColumnMatrix(
      nz, [&](int m, int k) { return 2.0 / nz * end(m) * end(k) * cosine(long(m) * k, nz); });
  cosine_synthesis_ = ColumnMatrix(nz, [&](int k, int m) { return cosine(long(m) * k, nz); });
  sine_synthesis_ = ColumnMatrix(nz, [&](int k, int m) { return sine(long(m) * k, nz); });
  wavenumber_.fill(0);
  for (int m = 0; m <= nz; ++m)
    wavenumber_[std::size_t(m)] = std::numbers::pi * m / grid.extent[D - 1];
  const std::size_t strip = 3 * aligned_doubles(y_in_.doubles()) +
                            3 * aligned_doubles(y_out_.doubles()) +
                            10 * aligned_doubles(std::size_t(levels_) + 8);
  scratch_ = ThreadScratch(std::max(strip, 2 * aligned_doubles(x_out_.doubles())));
}

template <int D>
std::size_t VolumePotential<D>::room_needed() const {
  return aligned_doubles(grid_.columns() * std::size_t(levels_)) +
         grid_.columns() * std::size_t(D * levels_);
}

template <int D>
void VolumePotential<D>::solve(const double* phi, double* gradient, double* room) {
  scratch_.reserve();
  phi_ = room;
  gradient_ = room + aligned_doubles(grid_.columns() * std::size_t(levels_));
  const std::size_t pieces = std::size_t(grid_.ny()) * std::size_t(blocks_);
  parallel_tasks(pieces, [&](std::size_t task) { transform_row(phi, task); });
  parallel_tasks(std::size_t(grid_.nx() / 2 + 1), [&](std::size_t i) { solve_strip(int(i)); });
  parallel_tasks(pieces, [&](std::size_t task) { finish_row(task, gradient); });
  parallel_chunks(
      grid_.columns(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t column = begin; column < end; ++column) fill_halo(column, gradient);
      },
      64);
}

template <int D>
void VolumePotential<D>::transform_row(const double* phi, std::size_t task) {
  const Piece piece(*this, task);
  double* row = scratch_.mine();
  double* spectrum = row + aligned_doubles(x_out_.doubles());
  for (int i = 0; i < grid_.nx(); ++i) {
    double* column = row + i * block_;
    std::fill_n(column, block_, 0.0);
    std::copy_n(phi + grid_.node(grid_.column(i, piece.j), piece.first), piece.last - piece.first,
                column);
  }
  x_in_.forward(row, spectrum);
  for (int i = 0; i < grid_.nx(); ++i)
    std::copy_n(spectrum + i * block_, block_,
                phi_ + grid_.column(i, piece.j) * std::size_t(levels_) + piece.first);
}

template <int D>
void VolumePotential<D>::solve_strip(int i) {
  double* gather = scratch_.mine();
  double* in = gather + aligned_doubles(y_in_.doubles());
  double* in_conjugate = in + aligned_doubles(y_in_.doubles());
  double* out = in_conjugate + aligned_doubles(y_in_.doubles());
  double* out_conjugate = out + aligned_doubles(y_out_.doubles());
  double* line = out_conjugate + aligned_doubles(y_out_.doubles());
  double* work = line + aligned_doubles(y_out_.doubles());
  const auto stride = std::size_t(levels_);
  const int ny = grid_.ny(), partner = conjugate(i, grid_.nx());
  const auto read = [&](int column, double* to) {
    for (int j = 0; j < ny; ++j)
      std::copy_n(phi_ + grid_.column(column, j) * stride, stride,
                  gather + std::size_t(j) * stride);
    y_in_.forward(gather, to);
  };
  read(i, in);
  if (partner != i) {
    read(partner, in_conjugate);
  } else {
    in_conjugate = in;
    out_conjugate = out;
  }
  for (int j = 0; j < ny; ++j) {
    const auto other = std::size_t(conjugate(j, ny));
    if (partner != i || j <= int(other))
      solve_mode(i, j, in + std::size_t(j) * stride, in_conjugate + other * stride,
                 out + std::size_t(j) * D * stride, out_conjugate + other * D * stride, work);
  }
  const auto write = [&](int column, const double* from) {
    y_out_.backward(from, line);
    for (int j = 0; j < ny; ++j)
      std::copy_n(line + std::size_t(j) * D * stride, D * stride,
                  gradient_ + grid_.column(column, j) * D * stride);
  };
  write(i, out);
  if (partner != i) write(partner, out_conjugate);
}

template <int D>
void VolumePotential<D>::solve_mode(int i, int j, const double* in, const double* in_conjugate,
                                    double* out, double* out_conjugate, double* work) const {
  const auto stride = std::size_t(levels_), p = column_pitch(grid_.nz());
  // Columns are as long as the longer of the two paddings.
  double *phi = work, *coefficients = work + 2 * aligned_doubles(stride + 8);
  double *chi = coefficients + 4 * p, *chi_z = chi + 2 * p;
  const double full_k = full_wavenumber(i, grid_.nx(), grid_.extent[0]);
  const double full_l = D == 3 ? full_wavenumber(j, grid_.ny(), grid_.extent[1]) : 0;
  const double squared = full_k * full_k + full_l * full_l;
  const bool horizontal_mean = i == 0 && j == 0;

  double *real = phi, *imaginary = phi + aligned_doubles(stride + 8);
  unpack_mode(in, in_conjugate, levels_, 1.0 / double(grid_.columns()), real, imaginary);
  std::copy_n(real, p, chi);
  std::copy_n(imaginary, p, chi + p);
  cosine_analysis_.apply(chi, coefficients, 2);
  for (std::size_t part = 0; part < 2; ++part) {
    double* c = coefficients + part * p;
    double* c_z = c + 2 * p;
    for (std::size_t m = 0; m < p; ++m) {
      const double laplacian = squared + wavenumber_[m] * wavenumber_[m];
      // The domain mean of φ has no potential.
      const bool none = horizontal_mean && (m == 0 || mean_ == HorizontalMean::remove);
      c[m] = none || laplacian == 0 ? 0 : -c[m] / laplacian;
      c_z[m] = -wavenumber_[m] * c[m];
    }
  }
  cosine_synthesis_.apply(coefficients, chi, 2);
  sine_synthesis_.apply(coefficients + 2 * p, chi_z, 2);

  const auto levels = std::size_t(grid_.nz()) + 1;
  const auto put = [&](int axis, double factor_re, const double* re, double factor_im,
                       const double* im) {
    std::fill_n(real, stride, 0.0);
    std::fill_n(imaginary, stride, 0.0);
    for (std::size_t z = 0; z < levels; ++z) {
      real[z] = factor_re * re[z];
      imaginary[z] = factor_im * im[z];
    }
    const auto at = std::size_t(axis) * stride;
    pack_mode(real, imaginary, levels_, out + at, out_conjugate + at);
  };
  const double k = derivative_wavenumber(i, grid_.nx(), grid_.extent[0]);
  put(0, -k, chi + p, k, chi);
  if constexpr (D == 3) {
    const double l = derivative_wavenumber(j, grid_.ny(), grid_.extent[1]);
    put(1, -l, chi + p, l, chi);
  }
  put(D - 1, 1, chi_z, 1, chi_z + p);
}

template <int D>
void VolumePotential<D>::finish_row(std::size_t task, double* gradient) {
  const Piece piece(*this, task);
  double* spectrum = scratch_.mine();
  double* row = spectrum + aligned_doubles(x_out_.doubles());
  for (int i = 0; i < grid_.nx(); ++i)
    for (int axis = 0; axis < D; ++axis)
      std::copy_n(gradient_ +
                      (grid_.column(i, piece.j) * D + std::size_t(axis)) * std::size_t(levels_) +
                      piece.first,
                  block_, spectrum + (i * D + axis) * block_);
  x_out_.backward(spectrum, row);
  for (int i = 0; i < grid_.nx(); ++i) {
    double* record = gradient + grid_.node(grid_.column(i, piece.j), piece.first) * width;
    const double* column = row + i * D * block_;
    for (int k = 0; k < piece.last - piece.first; ++k, record += width) {
      for (int axis = 0; axis < D; ++axis) record[axis] = column[axis * block_ + k];
      if constexpr (width > D) record[D] = 0;
    }
  }
}

template <int D>
void VolumePotential<D>::fill_halo(std::size_t column, double* gradient) const {
  const auto mirror = [&](int halo, int inner) {
    const double* in = gradient + grid_.node(column, inner) * width;
    double* out = gradient + grid_.node(column, halo) * width;
    for (int f = 0; f < width; ++f) out[f] = f == D - 1 ? -in[f] : in[f];
  };
  mirror(-1, 1);
  mirror(grid_.nz() + 1, grid_.nz() - 1);
}

template class VolumePotential<2>;
template class VolumePotential<3>;

}  // namespace pileus::mesh
