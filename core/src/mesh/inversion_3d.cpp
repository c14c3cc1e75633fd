#include "mesh/inversion_3d.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/parallel.hpp"
#include "mesh/mode_columns.hpp"
#include "mesh/node_extrema.hpp"

namespace pileus::mesh {

namespace {

using Deposit = DepositRecord<3>;
using Flow = FlowRecord<3>;

constexpr int derivative_count = 3;  // u_x, v_x, w_x

std::vector<double> wavenumbers(int n, double extent) {
  std::vector<double> k;
  for (int m = 0; m < n; ++m) k.push_back(derivative_wavenumber(m, n, extent));
  return k;
}

std::vector<double> filter_factors(int n, bool filter) {
  std::vector<double> f;
  for (int m = 0; m < n; ++m) f.push_back(filter ? hou_li_factor(2.0 * signed_index(m, n) / n) : 1);
  return f;
}

std::vector<double> squared_wavenumbers(const Grid<3>& grid) {
  std::vector<double> squared;
  for (const double k : wavenumbers(grid.nx(), grid.extent[0]))
    for (const double l : wavenumbers(grid.ny(), grid.extent[1]))
      if (k >= 0 && l >= 0 && k + l > 0) squared.push_back(k * k + l * l);
  return squared;
}

int conjugate(int m, int n) {
  return m == 0 ? 0 : n - m;
}

}  // namespace

/// Working memory of one strip: all y of wavenumber k and of its conjugate.
struct Inversion3D::Strip {
  double *gather, *in, *in_conjugate, *out, *out_conjugate, *line, *work;
};

Inversion3D::Inversion3D(const Grid<3>& grid, const FlowOptions& options)
    : grid_(grid),
      options_(options),
      levels_(packed_levels(grid.nz())),
      k_(wavenumbers(grid.nx(), grid.extent[0])),
      l_(wavenumbers(grid.ny(), grid.extent[1])),
      filter_k_(filter_factors(grid.nx(), options.filter)),
      filter_l_(filter_factors(grid.ny(), options.filter)),
      modes_(grid, options, squared_wavenumbers(grid)),
      x_in_(grid.nx(), mode_slot::input_count * levels_ / 2),
      x_out_(grid.nx(), mode_slot::count * levels_ / 2),
      x_derivative_(grid.nx(), derivative_count * levels_ / 2),
      y_in_(grid.ny(), mode_slot::input_count * levels_ / 2),
      y_out_(grid.ny(), mode_slot::count * levels_ / 2),
      vorticity_(grid.columns() * std::size_t(mode_slot::input_count * levels_)),
      flow_(grid.columns() * std::size_t(mode_slot::count * levels_)),
      row_summary_(std::size_t(grid.ny())) {
  for (int j = 0; j < grid.ny(); ++j)
    for (int i = 0; i < grid.nx(); ++i) {
      const double squared =
          k_[std::size_t(i)] * k_[std::size_t(i)] + l_[std::size_t(j)] * l_[std::size_t(j)];
      end_functions_.push_back(squared > 0 ? modes_.basis().find(squared) : -1);
    }
  const std::size_t strip = 3 * aligned_doubles(y_in_.doubles()) +
                            3 * aligned_doubles(y_out_.doubles()) + modes_.work_doubles();
  const std::size_t row =
      aligned_doubles(x_out_.doubles()) + 2 * aligned_doubles(x_derivative_.doubles());
  scratch_ = ThreadScratch(std::max(strip, row));
}

std::size_t Inversion3D::allocated_bytes() const {
  return vorticity_.allocated_bytes() + flow_.allocated_bytes() + scratch_.allocated_bytes() +
         modes_.basis().allocated_bytes();
}

void Inversion3D::solve(const double* deposited, std::array<double, 2> wind, double* flow,
                        FlowSummary* summary) {
  scratch_.reserve();
  parallel_tasks(std::size_t(grid_.ny()), [&](std::size_t j) { transform_row(deposited, int(j)); });
  // Strip i serves its conjugate too.
  parallel_tasks(std::size_t(grid_.nx() / 2 + 1),
                 [&](std::size_t i) { solve_strip(int(i), wind); });
  parallel_tasks(std::size_t(grid_.ny()), [&](std::size_t j) {
    row_summary_[j] = {};
    finish_row(int(j), flow, summary != nullptr ? &row_summary_[j] : nullptr);
  });
  if (summary == nullptr) return;
  for (const FlowSummary& row : row_summary_) merge_extrema(*summary, row);
}

void Inversion3D::transform_row(const double* deposited, int j) {
  double* row = scratch_.mine();
  const int nz = grid_.nz();
  for (int i = 0; i < grid_.nx(); ++i) {
    const double* record =
        deposited + grid_.node(grid_.column(i, j), 0) * Deposit::width + Deposit::vorticity;
    double* column = row + std::size_t(i * mode_slot::input_count * levels_);
    for (int f = 0; f < mode_slot::input_count; ++f, column += levels_) {
      for (int k = 0; k <= nz; ++k) column[k] = record[k * Deposit::width + f];
      if (levels_ > nz + 1) column[nz + 1] = 0;
    }
    column -= levels_;
    if (options_.zero_vertical_vorticity[0]) column[0] = 0;
    if (options_.zero_vertical_vorticity[1]) column[nz] = 0;
  }
  x_in_.forward(row, vorticity_.data() + std::size_t(j) * x_in_.doubles());
}

void Inversion3D::solve_strip(int i, std::array<double, 2> wind) {
  Strip s{};
  s.gather = scratch_.mine();
  s.in = s.gather + aligned_doubles(y_in_.doubles());
  s.in_conjugate = s.in + aligned_doubles(y_in_.doubles());
  s.out = s.in_conjugate + aligned_doubles(y_in_.doubles());
  s.out_conjugate = s.out + aligned_doubles(y_out_.doubles());
  s.line = s.out_conjugate + aligned_doubles(y_out_.doubles());
  s.work = s.line + aligned_doubles(y_out_.doubles());

  const int partner = conjugate(i, grid_.nx());
  if (is_nyquist(i, grid_.nx())) {
    std::memset(s.out, 0, y_out_.doubles() * sizeof(double));
  } else {
    const std::size_t chunk = std::size_t(mode_slot::input_count * levels_);
    const auto read = [&](int column, double* out) {
      for (int j = 0; j < grid_.ny(); ++j)
        std::memcpy(s.gather + std::size_t(j) * chunk,
                    vorticity_.data() + grid_.column(column, j) * chunk, chunk * sizeof(double));
      y_in_.forward(s.gather, out);
    };
    read(i, s.in);
    if (partner != i) {
      read(partner, s.in_conjugate);
    } else {
      s.in_conjugate = s.in;
      s.out_conjugate = s.out;
    }
    for (int j = 0; j < grid_.ny(); ++j)
      if (partner != i || j <= conjugate(j, grid_.ny())) solve_mode(i, j, wind, s);
  }
  const std::size_t chunk = std::size_t(mode_slot::count * levels_);
  const auto write = [&](int column, const double* in) {
    y_out_.backward(in, s.line);
    for (int j = 0; j < grid_.ny(); ++j)
      std::memcpy(flow_.data() + grid_.column(column, j) * chunk, s.line + std::size_t(j) * chunk,
                  chunk * sizeof(double));
  };
  write(i, s.out);
  if (partner != i) write(partner, s.out_conjugate);
}

void Inversion3D::solve_mode(int i, int j, std::array<double, 2> wind, const Strip& s) {
  const int partner = conjugate(j, grid_.ny());
  const auto in = std::size_t(mode_slot::input_count * levels_);
  const auto out = std::size_t(mode_slot::count * levels_);
  double* to = s.out + std::size_t(j) * out;
  double* to_conjugate = s.out_conjugate + std::size_t(partner) * out;
  const double scale = 1.0 / double(grid_.columns());
  if (i == 0 && j == 0) {
    modes_.solve_mean(scale, wind, s.in, to, s.work);
  } else if (is_nyquist(j, grid_.ny())) {
    // The highest wavenumber of an even count has no derivative, hence no flow.
    std::memset(to, 0, out * sizeof(double));
    std::memset(to_conjugate, 0, out * sizeof(double));
  } else {
    const Mode3D mode{k_[std::size_t(i)], l_[std::size_t(j)],
                      scale * filter_k_[std::size_t(i)] * filter_l_[std::size_t(j)],
                      end_functions_[grid_.column(i, j)]};
    modes_.solve(mode, s.in + std::size_t(j) * in, s.in_conjugate + std::size_t(partner) * in, to,
                 to_conjugate, s.work);
  }
}

void Inversion3D::finish_row(int j, double* flow, FlowSummary* summary) {
  double* slots = scratch_.mine();
  double* spectrum = slots + aligned_doubles(x_out_.doubles());
  double* derivatives = spectrum + aligned_doubles(x_derivative_.doubles());
  const double* row = flow_.data() + std::size_t(j) * x_out_.doubles();
  const int nx = grid_.nx(), levels = levels_;
  for (int i = 0; i < nx; ++i) {
    const double k = k_[std::size_t(i)];
    // u, v and w come first in a column of slots.
    const double* from = row + std::size_t(i * mode_slot::count * levels);
    double* to = spectrum + std::size_t(i * derivative_count * levels);
    for (int z = 0; z < derivative_count * levels; z += 2) {
      to[z] = -k * from[z + 1];
      to[z + 1] = k * from[z];
    }
  }
  x_out_.backward(row, slots);
  x_derivative_.backward(spectrum, derivatives);
  for (int i = 0; i < nx; ++i) {
    double* s = slots + std::size_t(i * mode_slot::count * levels);
    double* d = derivatives + std::size_t(i * derivative_count * levels);
    const int nz = grid_.nz();
    // ζ = v_x − u_y is exactly zero where it is to be kept so.
    double* u_y = s + mode_slot::u_y * levels;
    if (options_.zero_vertical_vorticity[0]) u_y[0] = d[levels];
    if (options_.zero_vertical_vorticity[1]) u_y[nz] = d[levels + nz];
    write_record(s, d, flow + grid_.node(grid_.column(i, j), -1) * Flow::width);
    if (summary != nullptr) merge_extrema(*summary, column_extrema(s, d));
  }
}

FlowSummary Inversion3D::column_extrema(const double* slots, const double* derivatives) const {
  const int count = grid_.nz() + 1;
  const auto slot = [&](int index) { return slots + index * levels_; };
  const GradientColumns g{.u_x = derivatives,
                          .u_y = slot(mode_slot::u_y),
                          .v_x = derivatives + levels_,
                          .v_y = slot(mode_slot::v_y),
                          .w_x = derivatives + 2 * levels_,
                          .w_y = slot(mode_slot::w_y),
                          .xi = slot(mode_slot::xi),
                          .eta = slot(mode_slot::eta),
                          .levels = count};
  FlowSummary column;
  column.strain = largest_strain(g);
  column.vorticity = std::sqrt(largest_squared_vorticity(g));
  for (int f = 0; f < 3; ++f)
    column.speed[std::size_t(f)] = largest_magnitude(slot(mode_slot::u + f), count);
  return column;
}

void Inversion3D::write_record(const double* slots, const double* derivatives,
                               double* record) const {
  const int nz = grid_.nz(), levels = levels_;
  const auto slot = [&](int index) { return slots + index * levels; };
  const double *u = slot(mode_slot::u), *v = slot(mode_slot::v), *w = slot(mode_slot::w);
  const double *u_y = slot(mode_slot::u_y), *v_y = slot(mode_slot::v_y),
               *w_y = slot(mode_slot::w_y), *xi = slot(mode_slot::xi), *eta = slot(mode_slot::eta);
  const double *u_x = derivatives, *v_x = u_x + levels, *w_x = v_x + levels;
  double* r = record + Flow::width;
  for (int k = 0; k <= nz; ++k, r += Flow::width) {
    r[Flow::u] = u[k];
    r[Flow::v] = v[k];
    r[Flow::w] = w[k];
    r[Flow::u_x] = u_x[k];
    r[Flow::u_y] = u_y[k];
    r[Flow::u_z] = w_x[k] + eta[k];
    r[Flow::v_x] = v_x[k];
    r[Flow::v_y] = v_y[k];
    r[Flow::v_z] = w_y[k] - xi[k];
    r[Flow::w_x] = w_x[k];
    r[Flow::w_y] = w_y[k];
    for (int f = Flow::tendency; f < Flow::width; ++f) r[f] = 0;
  }
  // Beyond the walls w, w_x and w_y are odd; the rest, vorticity included, is extrapolated
  // linearly, so that u_z = w_x + η takes its η from there and its w_x from the odd continuation.
  const auto extrapolate = [&](double* halo, int wall, int inner) {
    const double* at = record + (wall + 1) * Flow::width;
    const double* in = record + (inner + 1) * Flow::width;
    for (const int f : {Flow::u, Flow::v, Flow::u_x, Flow::u_y, Flow::v_x, Flow::v_y})
      halo[f] = 2 * at[f] - in[f];
    for (const int f : {Flow::w, Flow::w_x, Flow::w_y}) halo[f] = -in[f];
    halo[Flow::u_z] = halo[Flow::w_x] + 2 * eta[wall] - eta[inner];
    halo[Flow::v_z] = halo[Flow::w_y] - 2 * xi[wall] + xi[inner];
    for (int f = Flow::tendency; f < Flow::width; ++f) halo[f] = 0;
  };
  extrapolate(record, 0, 1);
  extrapolate(record + (nz + 2) * Flow::width, nz, nz - 1);
}

}  // namespace pileus::mesh
