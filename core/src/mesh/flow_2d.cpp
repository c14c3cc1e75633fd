#include "mesh/flow_2d.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/parallel.hpp"
#include "mesh/mode_columns.hpp"
#include "mesh/node_extrema.hpp"

namespace pileus::mesh {

namespace {

using Deposit = DepositRecord<2>;
using Flow = FlowRecord<2>;

constexpr int block_levels = 16;  // two cache lines of a column

namespace slot {
constexpr int u = 0, w = 1, u_x = 2, w_x = 3, zeta = 4, count = 5;
}

std::vector<double> squared_wavenumbers(const Grid<2>& grid) {
  std::vector<double> squared;
  for (int m = 1; m < grid.nx(); ++m) {
    const double k = derivative_wavenumber(m, grid.nx(), grid.extent[0]);
    if (k > 0) squared.push_back(k * k);
  }
  return squared;
}

int block_count(const Grid<2>& grid) {
  return grid.nz() / block_levels + 1;
}

/// Levels [first, last) of a block that the mesh has.
struct Levels {
  int first, last;
};
Levels levels_of(int block, int nz) {
  return {block * block_levels, std::min((block + 1) * block_levels, nz + 1)};
}

}  // namespace

/// Working columns of one mode; a complex column is two adjacent real ones.
struct Inversion2D::Columns {
  double* packed;  // as long as packed columns
  double *zeta, *psi, *psi_z, *spare;
  double* coefficients;  // of ζ, ψ and ψ_z
  double ends[2][2];     // of Re ζ, Im ζ at the lower and upper wall

  Columns(double* work, std::size_t stride, std::size_t pitch)
      : packed(work),
        zeta(packed + 2 * stride),
        psi(zeta + 2 * pitch),
        psi_z(psi + 2 * pitch),
        spare(psi_z + 2 * pitch),
        coefficients(spare + 2 * pitch) {}
  static std::size_t doubles(std::size_t stride, std::size_t pitch) {
    return 2 * stride + 14 * pitch;
  }
};

Inversion2D::Inversion2D(const Grid<2>& grid, const FlowOptions& options)
    : grid_(grid),
      options_(options),
      blocks_(block_count(grid)),
      levels_(blocks_ * block_levels),
      basis_(grid.nz(), grid.extent[1], squared_wavenumbers(grid)),
      in_(grid.nx(), block_levels / 2),
      out_(grid.nx(), slot::count * block_levels / 2),
      vorticity_(std::size_t(grid.nx()) * std::size_t(levels_)),
      flow_(std::size_t(grid.nx()) * std::size_t(slot::count * levels_)),
      block_summary_(std::size_t(blocks_)) {
  scratch_ = ThreadScratch(std::max(2 * aligned_doubles(out_.doubles()),
                                    Columns::doubles(std::size_t(levels_), basis_.pitch())));
  vorticity_.fill(0);
  flow_.fill(0);
}

std::size_t Inversion2D::flow_column(int i) const {
  return std::size_t(i) * std::size_t(slot::count * levels_);
}

std::size_t Inversion2D::allocated_bytes() const {
  return vorticity_.allocated_bytes() + flow_.allocated_bytes() + scratch_.allocated_bytes() +
         basis_.allocated_bytes();
}

void Inversion2D::solve(const double* deposited, double wind, double* flow, FlowSummary* summary) {
  scratch_.reserve();
  const auto blocks = std::size_t(blocks_);
  parallel_tasks(blocks, [&](std::size_t block) { transform_levels(deposited, int(block)); });
  parallel_tasks(std::size_t(grid_.nx() / 2 + 1), [&](std::size_t i) {
    if (i == 0)
      solve_mean(wind);
    else
      solve_mode(int(i));
  });
  parallel_tasks(blocks, [&](std::size_t block) {
    block_summary_[block] = {};
    finish_levels(int(block), flow, summary != nullptr ? &block_summary_[block] : nullptr);
  });
  parallel_chunks(
      std::size_t(grid_.nx()),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) extrapolate(int(i), flow);
      },
      64);
  if (summary == nullptr) return;
  for (const FlowSummary& block : block_summary_) merge_extrema(*summary, block);
}

void Inversion2D::transform_levels(const double* deposited, int block) {
  double* rows = scratch_.mine();
  double* spectrum = rows + aligned_doubles(out_.doubles());
  const auto [first, last] = levels_of(block, grid_.nz());
  for (int i = 0; i < grid_.nx(); ++i) {
    const double* record = deposited + grid_.node(std::size_t(i), first) * Deposit::width;
    double* column = rows + i * block_levels;
    std::fill_n(column, block_levels, 0.0);
    for (int k = first; k < last; ++k, record += Deposit::width)
      column[k - first] = record[Deposit::vorticity];
  }
  in_.forward(rows, spectrum);
  for (int i = 0; i < grid_.nx(); ++i)
    std::memcpy(vorticity_.data() + vorticity_column(i) + first, spectrum + i * block_levels,
                block_levels * sizeof(double));
}

void Inversion2D::invert(const EndFunctions& ends, Columns& c) const {
  const std::size_t p = basis_.pitch(), top = std::size_t(grid_.nz());
  for (std::size_t part = 0; part < 2; ++part) {
    double* f = c.zeta + part * p;
    const double lower = c.ends[part][0] = f[0], upper = c.ends[part][1] = f[top];
    for (std::size_t z = 0; z < p; ++z) f[z] -= lower * ends.lower[z] + upper * ends.upper[z];
  }
  basis_.sine_analysis().apply(c.zeta, c.coefficients, 2);
  for (std::size_t part = 0; part < 2; ++part) {
    double *zeta = c.coefficients + part * p, *psi = zeta + 2 * p, *psi_z = psi + 2 * p;
    for (std::size_t m = 0; m < p; ++m) {
      if (options_.filter) zeta[m] *= basis_.filter()[m];
      psi[m] = zeta[m] * ends.inverse_laplacian[m];
      psi_z[m] = psi[m] * basis_.wavenumber()[m];
    }
  }
  basis_.sine_synthesis().apply(c.coefficients, c.zeta, 2);
  basis_.sine_synthesis().apply(c.coefficients + 2 * p, c.psi, 2);
  basis_.cosine_synthesis().apply(c.coefficients + 4 * p, c.psi_z, 2);
  for (std::size_t part = 0; part < 2; ++part) {
    const double lower = c.ends[part][0], upper = c.ends[part][1];
    double *zeta = c.zeta + part * p, *psi = c.psi + part * p, *psi_z = c.psi_z + part * p;
    for (std::size_t z = 0; z < p; ++z) {
      zeta[z] += lower * ends.lower[z] + upper * ends.upper[z];
      psi[z] += lower * ends.lower_inverse[z] + upper * ends.upper_inverse[z];
      psi_z[z] += lower * ends.lower_inverse_z[z] + upper * ends.upper_inverse_z[z];
    }
  }
}

void Inversion2D::solve_mode(int i) {
  double* out = flow_.data() + flow_column(i);
  const int nx = grid_.nx();
  const auto stride = std::size_t(levels_), p = basis_.pitch();
  if (is_nyquist(i, nx)) {
    std::memset(out, 0, slot::count * stride * sizeof(double));
    return;
  }
  double* out_conjugate = flow_.data() + flow_column(nx - i);
  const double k = derivative_wavenumber(i, nx, grid_.extent[0]);
  const double filter = options_.filter ? hou_li_factor(2.0 * i / nx) : 1;
  Columns c(scratch_.mine(), stride, p);
  unpack_mode(vorticity_.data() + vorticity_column(i), vorticity_.data() + vorticity_column(nx - i),
              levels_, filter / nx, c.packed, c.packed + stride);
  // Blocks of levels and padded columns end differently.
  const std::size_t shared = std::min(stride, p);
  const auto put = [&](int index, double factor, const double* column) {
    for (std::size_t part = 0; part < 2; ++part)
      for (std::size_t z = 0; z < shared; ++z)
        c.packed[part * stride + z] = factor * column[part * p + z];
    const auto at = std::size_t(index) * stride;
    pack_mode(c.packed, c.packed + stride, levels_, out + at, out_conjugate + at);
  };
  const auto put_x_derivative = [&](int index, double factor, const double* column) {
    for (std::size_t z = 0; z < p; ++z) {
      c.spare[z] = -column[p + z];
      c.spare[p + z] = column[z];
    }
    put(index, factor * k, c.spare);
  };
  for (std::size_t part = 0; part < 2; ++part) {
    std::fill_n(c.zeta + part * p, p, 0.0);
    std::copy_n(c.packed + part * stride, shared, c.zeta + part * p);
    std::fill_n(c.packed + part * stride, stride, 0.0);
  }
  invert(basis_.end_functions(basis_.find(k * k)), c);
  put(slot::u, -1, c.psi_z);
  put_x_derivative(slot::u_x, -1, c.psi_z);
  put_x_derivative(slot::w, 1, c.psi);
  put(slot::w_x, -k * k, c.psi);
  put(slot::zeta, 1, c.zeta);
}

void Inversion2D::solve_mean(double wind) {
  double* out = flow_.data();
  const auto stride = std::size_t(levels_), p = basis_.pitch(), top = std::size_t(grid_.nz());
  std::memset(out, 0, slot::count * stride * sizeof(double));
  double *zeta = scratch_.mine(), *series = zeta + 2 * stride, *value = series + 2 * p;
  unpack_mode(vorticity_.data(), vorticity_.data(), levels_, 1.0 / grid_.nx(), zeta, zeta + stride);
  std::fill_n(series, 2 * p, 0.0);
  for (std::size_t z = 0; z <= top; ++z)
    series[z] = zeta[z] - zeta[0] * basis_.mean_lower()[z] - zeta[top] * basis_.mean_upper()[z];
  basis_.sine_analysis().apply(series, value, 2);
  for (std::size_t m = 1; m < top; ++m) series[m] = -value[m] / basis_.wavenumber()[m];
  basis_.cosine_synthesis().apply(series, value, 2);
  for (std::size_t z = 0; z <= top; ++z) {
    // ū_z = −ζ̄.
    out[slot::u * stride + z] = wind - value[z] - zeta[0] * basis_.mean_lower_integral()[z] -
                                zeta[top] * basis_.mean_upper_integral()[z];
    out[slot::zeta * stride + z] = zeta[z];
  }
}

void Inversion2D::finish_levels(int block, double* flow, FlowSummary* summary) {
  double* spectrum = scratch_.mine();
  double* rows = spectrum + aligned_doubles(out_.doubles());
  const auto [first, last] = levels_of(block, grid_.nz());
  for (int i = 0; i < grid_.nx(); ++i)
    for (int f = 0; f < slot::count; ++f)
      std::memcpy(spectrum + (i * slot::count + f) * block_levels,
                  flow_.data() + flow_column(i) + f * levels_ + first,
                  block_levels * sizeof(double));
  out_.backward(spectrum, rows);
  FlowSummary local;
  for (int i = 0; i < grid_.nx(); ++i) {
    const double* column = rows + i * slot::count * block_levels;
    double* r = flow + grid_.node(std::size_t(i), first) * Flow::width;
    for (int k = 0; k < last - first; ++k, r += Flow::width) {
      const auto value = [&](int f) { return column[f * block_levels + k]; };
      r[Flow::u] = value(slot::u);
      r[Flow::w] = value(slot::w);
      r[Flow::u_x] = value(slot::u_x);
      r[Flow::w_x] = value(slot::w_x);
      r[Flow::u_z] = value(slot::w_x) - value(slot::zeta);
      for (int f = Flow::tendency; f < Flow::width; ++f) r[f] = 0;
      const double shear = r[Flow::u_z] + r[Flow::w_x];
      local.strain = std::max(local.strain, r[Flow::u_x] * r[Flow::u_x] + 0.25 * shear * shear);
      local.vorticity = std::max(local.vorticity, std::abs(value(slot::zeta)));
      local.speed[0] = std::max(local.speed[0], std::abs(r[Flow::u]));
      local.speed[1] = std::max(local.speed[1], std::abs(r[Flow::w]));
    }
  }
  local.strain = std::sqrt(local.strain);
  if (summary != nullptr) *summary = local;
}

void Inversion2D::extrapolate(int i, double* flow) const {
  const auto record = [&](int k) { return flow + grid_.node(std::size_t(i), k) * Flow::width; };
  const auto halo = [](double* out, const double* wall, const double* inner) {
    for (const int f : {Flow::u, Flow::u_x}) out[f] = 2 * wall[f] - inner[f];
    for (const int f : {Flow::w, Flow::w_x}) out[f] = -inner[f];
    const auto zeta = [](const double* r) { return r[Flow::w_x] - r[Flow::u_z]; };
    out[Flow::u_z] = out[Flow::w_x] - (2 * zeta(wall) - zeta(inner));
    for (int f = Flow::tendency; f < Flow::width; ++f) out[f] = 0;
  };
  const int nz = grid_.nz();
  halo(record(-1), record(0), record(1));
  halo(record(nz + 1), record(nz), record(nz - 1));
}

Tendency2D::Tendency2D(const Grid<2>& grid, const FlowOptions& options)
    : grid_(grid),
      stratification_(std::size_t(grid.nz()) + 1),
      blocks_(block_count(grid)),
      line_(grid.nx(), block_levels / 2),
      column_gradient_(std::size_t(grid.nx())),
      scratch_(2 * aligned_doubles(line_.doubles())) {
  stratification_.fill(0);
  std::copy(options.reference_stratification.begin(), options.reference_stratification.end(),
            stratification_.data());
}

void Tendency2D::solve(const double* deposited, double* flow, FlowSummary* summary) {
  scratch_.reserve();
  parallel_tasks(std::size_t(blocks_),
                 [&](std::size_t block) { solve_levels(deposited, int(block), flow); });
  parallel_chunks(
      std::size_t(grid_.nx()),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const auto tendency = [&](int k) -> double& {
            return flow[grid_.node(i, k) * Flow::width + Flow::tendency];
          };
          const int nz = grid_.nz();
          tendency(-1) = 2 * tendency(0) - tendency(1);
          tendency(nz + 1) = 2 * tendency(nz) - tendency(nz - 1);
          if (summary != nullptr)
            column_gradient_[i] = largest_buoyancy_gradient(deposited, int(i));
        }
      },
      64);
  if (summary == nullptr) return;
  for (const double gradient : column_gradient_)
    summary->buoyancy_gradient = std::max(summary->buoyancy_gradient, gradient);
}

void Tendency2D::solve_levels(const double* deposited, int block, double* flow) {
  double* rows = scratch_.mine();
  double* spectrum = rows + aligned_doubles(line_.doubles());
  const auto [first, last] = levels_of(block, grid_.nz());
  const int nx = grid_.nx();
  for (int i = 0; i < nx; ++i) {
    const double* record = deposited + grid_.node(std::size_t(i), first) * Deposit::width;
    double* column = rows + i * block_levels;
    std::fill_n(column, block_levels, 0.0);
    for (int k = first; k < last; ++k, record += Deposit::width)
      column[k - first] = record[Deposit::buoyancy];
  }
  line_.forward(rows, spectrum);
  for (int i = 0; i < nx; ++i) {
    const double k = derivative_wavenumber(i, nx, grid_.extent[0]) / nx;
    for (int z = 0; z < block_levels; z += 2) {
      double* value = spectrum + i * block_levels + z;
      const double real = value[0], imaginary = value[1];
      value[0] = -k * imaginary;
      value[1] = k * real;
    }
  }
  line_.backward(spectrum, rows);
  for (int i = 0; i < nx; ++i)
    for (int k = first; k < last; ++k)
      flow[grid_.node(std::size_t(i), k) * Flow::width + Flow::tendency] =
          rows[i * block_levels + k - first];
}

double Tendency2D::largest_buoyancy_gradient(const double* deposited, int i) const {
  const int nx = grid_.nx(), nz = grid_.nz();
  const auto b = [&](int ci, int k) {
    return deposited[grid_.node(std::size_t((ci + nx) % nx), k) * Deposit::width +
                     Deposit::buoyancy];
  };
  double largest = 0;
  for (int k = 0; k <= nz; ++k) {
    const int above = std::min(k + 1, nz), below = std::max(k - 1, 0);
    const double b_x = 0.5 * grid_.inverse_spacing[0] * (b(i + 1, k) - b(i - 1, k));
    const double b_z = grid_.inverse_spacing[1] * (b(i, above) - b(i, below)) / (above - below) +
                       stratification_[std::size_t(k)];
    largest = std::max(largest, b_x * b_x + b_z * b_z);
  }
  return std::sqrt(largest);
}

}  // namespace pileus::mesh
