#include "mesh/tendency_3d.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/parallel.hpp"
#include "mesh/mode_columns.hpp"
#include "mesh/node_extrema.hpp"
#include "mesh/vector_clones.hpp"

namespace pileus::mesh {

namespace {

using Deposit = DepositRecord<3>;
using Flow = FlowRecord<3>;

constexpr int components = 3;

/// Multiplies `count` packed values by ik.
PILEUS_VECTOR_CLONES
void differentiate(double* values, double k, int count) {
  for (int n = 0; n < count; n += 2) {
    const double real = values[n], imaginary = values[n + 1];
    values[n] = -k * imaginary;
    values[n + 1] = k * real;
  }
}

/// Derivative along the lines of a transform; `scaled` are wavenumbers over the number of points.
void differentiate_lines(const LineTransform& lines, const std::vector<double>& scaled,
                         double* values, double* spectrum) {
  lines.forward(values, spectrum);
  const int count = 2 * lines.batch();
  for (int m = 0; m < lines.length(); ++m)
    differentiate(spectrum + std::size_t(m) * std::size_t(count), scaled[std::size_t(m)], count);
  lines.backward(spectrum, values);
}

std::vector<double> scaled_wavenumbers(int n, double extent) {
  std::vector<double> k;
  for (int m = 0; m < n; ++m) k.push_back(derivative_wavenumber(m, n, extent) / n);
  return k;
}

}  // namespace

Tendency3D::Tendency3D(const Grid<3>& grid, const FlowOptions& options)
    : grid_(grid),
      options_(options),
      levels_(packed_levels(grid.nz())),
      derivative_(vertical_derivative(options.vertical_derivative, grid.nz(), grid.spacing[2])),
      x_(grid.nx(), components * levels_ / 2),
      y_(grid.ny(), components * levels_ / 2),
      k_(scaled_wavenumbers(grid.nx(), grid.extent[0])),
      l_(scaled_wavenumbers(grid.ny(), grid.extent[1])),
      y_flux_(grid.columns() * std::size_t(components * levels_)),
      stratification_(std::size_t(grid.nz()) + 1),
      row_summary_(std::size_t(grid.ny())) {
  stratification_.fill(0);
  std::copy(options.reference_stratification.begin(), options.reference_stratification.end(),
            stratification_.data());
  const std::size_t columns = 2 * (components + 1) * column_pitch(grid.nz());
  scratch_ = ThreadScratch(2 * aligned_doubles(std::max(x_.doubles(), y_.doubles())) + columns);
}

std::size_t Tendency3D::allocated_bytes() const {
  return y_flux_.allocated_bytes() + scratch_.allocated_bytes();
}

void Tendency3D::solve(const double* deposited, const std::array<double, 2>& mean_wind,
                       double* flow, FlowSummary* summary) {
  mean_wind_ = mean_wind;
  scratch_.reserve();
  parallel_tasks(std::size_t(grid_.ny()), [&](std::size_t j) {
    row_summary_[j] = {};
    finish_rows(deposited, flow, int(j), summary != nullptr ? &row_summary_[j] : nullptr);
  });
  parallel_tasks(std::size_t(grid_.nx()), [&](std::size_t i) { finish_strip(int(i), flow); });
  if (summary == nullptr) return;
  std::array<double, 2> sum{0, 0};
  for (const FlowSummary& row : row_summary_) {
    merge_extrema(*summary, row);
    for (std::size_t d = 0; d < 2; ++d) sum[d] += row.net_vorticity_rate[d];
  }
  for (std::size_t d = 0; d < 2; ++d)
    summary->net_vorticity_rate[d] = sum[d] / (double(grid_.columns()) * grid_.extent[2]);
}

void Tendency3D::flux_columns(const double* deposit, const double* flow, double* x_flux,
                              double* y_flux, double* z_flux) const {
  const auto [f_x, f_y, f_z] = options_.planetary_vorticity;
  const auto [mean_u, mean_v] = mean_wind_;
  const std::size_t pitch = column_pitch(grid_.nz());
  const int levels = levels_;
  for (int k = 0; k <= grid_.nz(); ++k) {
    const double* r = flow + k * Flow::width;
    const double b = deposit[k * Deposit::width + Deposit::buoyancy];
    const double xi = r[Flow::w_y] - r[Flow::v_z] + f_x;
    const double eta = r[Flow::u_z] - r[Flow::w_x] + f_y;
    const double zeta = r[Flow::v_x] - r[Flow::u_y] + f_z;
    x_flux[k] = xi * r[Flow::u];
    x_flux[levels + k] = (r[Flow::w_y] + f_x) * r[Flow::v] - mean_v * r[Flow::v_z] - b;
    x_flux[2 * levels + k] = (f_x - r[Flow::v_z]) * r[Flow::w];
    y_flux[k] = (f_y - r[Flow::w_x]) * r[Flow::u] + mean_u * r[Flow::u_z] + b;
    y_flux[levels + k] = eta * r[Flow::v];
    y_flux[2 * levels + k] = (r[Flow::u_z] + f_y) * r[Flow::w];
    z_flux[std::size_t(k)] = (r[Flow::v_x] + f_z) * r[Flow::u] - mean_u * r[Flow::u_y];
    z_flux[pitch + std::size_t(k)] = (f_z - r[Flow::u_y]) * r[Flow::v] + mean_v * r[Flow::v_x];
    z_flux[2 * pitch + std::size_t(k)] = zeta * r[Flow::w];
  }
  if (levels > grid_.nz() + 1)
    for (int c = 1; c <= components; ++c) x_flux[c * levels - 1] = y_flux[c * levels - 1] = 0;
}

double Tendency3D::largest_buoyancy_gradient(const double* deposited, int i, int j) const {
  const int nx = grid_.nx(), ny = grid_.ny(), nz = grid_.nz();
  const auto column = [&](int ci, int cj) {
    return deposited +
           grid_.node(grid_.column((ci + nx) % nx, (cj + ny) % ny), 0) * Deposit::width +
           Deposit::buoyancy;
  };
  const double *east = column(i + 1, j), *west = column(i - 1, j);
  const double *north = column(i, j + 1), *south = column(i, j - 1), *here = column(i, j);
  double largest = 0;
  for (int k = 0; k <= nz; ++k) {
    const int at = k * Deposit::width;
    const int above = (k < nz ? k + 1 : nz) * Deposit::width;
    const int below = (k > 0 ? k - 1 : 0) * Deposit::width;
    const double step = k > 0 && k < nz ? 0.5 : 1;
    const double b_x = 0.5 * grid_.inverse_spacing[0] * (east[at] - west[at]);
    const double b_y = 0.5 * grid_.inverse_spacing[1] * (north[at] - south[at]);
    const double b_z = step * grid_.inverse_spacing[2] * (here[above] - here[below]) +
                       stratification_[std::size_t(k)];
    const double squared = b_x * b_x + b_y * b_y + b_z * b_z;
    largest = squared > largest ? squared : largest;
  }
  return std::sqrt(largest);
}

void Tendency3D::finish_rows(const double* deposited, double* flow, int j, FlowSummary* summary) {
  const std::size_t pitch = column_pitch(grid_.nz());
  const std::size_t chunk = std::size_t(components * levels_);
  double* x_flux = scratch_.mine();
  double* spectrum = x_flux + aligned_doubles(std::max(x_.doubles(), y_.doubles()));
  double* z_flux = spectrum + aligned_doubles(std::max(x_.doubles(), y_.doubles()));
  double* z_derivative = z_flux + (components + 1) * pitch;
  const int nz = grid_.nz();
  for (int i = 0; i < grid_.nx(); ++i) {
    const std::size_t column = grid_.column(i, j), node = grid_.node(column, 0);
    double* record = flow + node * Flow::width;
    flux_columns(deposited + node * Deposit::width, record, x_flux + std::size_t(i) * chunk,
                 y_flux_.data() + column * chunk, z_flux);
    derivative_.apply(z_flux, z_derivative, components + 1);
    for (int k = 0; k <= nz; ++k)
      for (int c = 0; c < components; ++c)
        record[k * Flow::width + Flow::tendency + c] =
            z_derivative[std::size_t(c) * pitch + std::size_t(k)];
    if (summary == nullptr) continue;
    for (std::size_t d = 0; d < 2; ++d)
      summary->net_vorticity_rate[d] += z_flux[d * pitch + std::size_t(nz)] - z_flux[d * pitch];
    summary->buoyancy_gradient =
        std::max(summary->buoyancy_gradient, largest_buoyancy_gradient(deposited, i, j));
  }
  differentiate_lines(x_, k_, x_flux, spectrum);
  for (int i = 0; i < grid_.nx(); ++i) {
    double* record = flow + grid_.node(grid_.column(i, j), 0) * Flow::width + Flow::tendency;
    const double* column = x_flux + std::size_t(i) * chunk;
    for (int k = 0; k <= nz; ++k)
      for (int c = 0; c < components; ++c) record[k * Flow::width + c] += column[c * levels_ + k];
  }
}

void Tendency3D::finish_strip(int i, double* flow) {
  const std::size_t chunk = std::size_t(components * levels_);
  double* y_flux = scratch_.mine();
  double* spectrum = y_flux + aligned_doubles(std::max(x_.doubles(), y_.doubles()));
  for (int j = 0; j < grid_.ny(); ++j)
    std::memcpy(y_flux + std::size_t(j) * chunk, y_flux_.data() + grid_.column(i, j) * chunk,
                chunk * sizeof(double));
  differentiate_lines(y_, l_, y_flux, spectrum);
  const int nz = grid_.nz(), width = Flow::width;
  for (int j = 0; j < grid_.ny(); ++j) {
    double* record = flow + grid_.node(grid_.column(i, j), 0) * Flow::width + Flow::tendency;
    const double* column = y_flux + std::size_t(j) * chunk;
    for (int k = 0; k <= nz; ++k)
      for (int c = 0; c < components; ++c) record[k * width + c] += column[c * levels_ + k];
    if (options_.zero_vertical_vorticity[0]) record[2] = 0;
    if (options_.zero_vertical_vorticity[1]) record[nz * width + 2] = 0;
    for (int c = 0; c < components; ++c) {
      record[c - width] = 2 * record[c] - record[c + width];
      record[(nz + 1) * width + c] = 2 * record[nz * width + c] - record[(nz - 1) * width + c];
    }
  }
}

}  // namespace pileus::mesh
