#include "mesh/mode_inversion_3d.hpp"

#include <algorithm>

#include "mesh/mode_columns.hpp"
#include "mesh/vector_clones.hpp"

namespace pileus::mesh {

/// Working columns; a complex column is two adjacent real ones.
struct ModeInversion3D::Columns {
  double* vorticity;     // ξ, η, ζ as unpacked
  double* source;        // D = η_x − ξ_y and ζ without their end parts
  double* coefficients;  // sine coefficients of D, ζ, w; after them cosine coefficients of w_z
  double* value;         // D, ζ, w; after them w_z
  double* zeta_z;
  double* result;     // one output column
  double ends[4][2];  // of Re D, Im D, Re ζ, Im ζ at the lower and upper wall

  Columns(double* work, std::size_t pitch)
      : vorticity(work),
        source(work + 6 * pitch),
        coefficients(work + 10 * pitch),
        value(work + 18 * pitch),
        zeta_z(work + 26 * pitch),
        result(work + 28 * pitch) {}
  static constexpr std::size_t count = 30;
};

ModeInversion3D::ModeInversion3D(const Grid<3>& grid, const FlowOptions& options,
                                 const std::vector<double>& squared_wavenumbers)
    : nz_(grid.nz()),
      levels_(packed_levels(grid.nz())),
      filter_(options.filter),
      basis_(grid.nz(), grid.extent[2], squared_wavenumbers),
      derivative_(vertical_derivative(options.vertical_derivative, grid.nz(), grid.spacing[2])) {}

std::size_t ModeInversion3D::work_doubles() const {
  return Columns::count * basis_.pitch();
}

namespace {

struct EndValues {
  double lower, upper;
};

[[gnu::always_inline]] inline void add_ends(double* __restrict column, EndValues ends,
                                            const double* __restrict lower,
                                            const double* __restrict upper, std::size_t pitch) {
  for (std::size_t k = 0; k < pitch; ++k)
    column[k] += ends.lower * lower[k] + ends.upper * upper[k];
}

/// D = ikη − ilξ from complex ξ, η.
PILEUS_VECTOR_CLONES
void horizontal_curl(double k, double l, const double* __restrict vorticity, std::size_t pitch,
                     double* __restrict curl) {
  const double *xi_re = vorticity, *xi_im = xi_re + pitch;
  const double *eta_re = xi_im + pitch, *eta_im = eta_re + pitch;
  for (std::size_t z = 0; z < pitch; ++z) {
    curl[z] = l * xi_im[z] - k * eta_im[z];
    curl[pitch + z] = k * eta_re[z] - l * xi_re[z];
  }
}

PILEUS_VECTOR_CLONES
void subtract_ends(double* column, EndValues ends, const double* lower, const double* upper,
                   std::size_t pitch) {
  add_ends(column, {-ends.lower, -ends.upper}, lower, upper, pitch);
}

PILEUS_VECTOR_CLONES
void restore_ends(double* column, EndValues ends, const double* lower, const double* upper,
                  std::size_t pitch) {
  add_ends(column, ends, lower, upper, pitch);
}

/// Filters D and ζ and divides −D by the Laplacian; see ModeInversion3D::Columns for the order.
PILEUS_VECTOR_CLONES
void solve_coefficients(double* __restrict c, const double* __restrict filter,
                        const double* __restrict inverse_laplacian,
                        const double* __restrict wavenumber, std::size_t pitch) {
  for (std::size_t part = 0; part < 2; ++part) {
    double *d = c + part * pitch, *zeta = d + 2 * pitch, *w = d + 4 * pitch, *w_z = d + 6 * pitch;
    for (std::size_t m = 0; m < pitch; ++m) {
      if (filter != nullptr) {
        d[m] *= filter[m];
        zeta[m] *= filter[m];
      }
      w[m] = -d[m] * inverse_laplacian[m];
      w_z[m] = w[m] * wavenumber[m];
    }
  }
}

/// out = (ik a + il b)/K² of complex columns a, b (imaginary part one pitch after the real one).
PILEUS_VECTOR_CLONES
void gradient_sum(double k, double l, const double* __restrict a, const double* __restrict b,
                  std::size_t pitch, double* __restrict out) {
  for (std::size_t z = 0; z < pitch; ++z) {
    out[z] = -k * a[pitch + z] - l * b[pitch + z];
    out[pitch + z] = k * a[z] + l * b[z];
  }
}

/// out = il a.
PILEUS_VECTOR_CLONES
void differentiate(double l, const double* __restrict a, std::size_t pitch,
                   double* __restrict out) {
  for (std::size_t z = 0; z < pitch; ++z) {
    out[z] = -l * a[pitch + z];
    out[pitch + z] = l * a[z];
  }
}

PILEUS_VECTOR_CLONES
void unpack(const double* a, const double* b, int levels, double scale, double* column,
            std::size_t pitch) {
  unpack_mode(a, b, levels, scale, column, column + pitch);
}

PILEUS_VECTOR_CLONES
void pack(const double* column, std::size_t pitch, int levels, double* a, double* b) {
  pack_mode(column, column + pitch, levels, a, b);
}

}  // namespace

void ModeInversion3D::project_and_invert(const Mode3D& mode, const Columns& c) const {
  const std::size_t p = basis_.pitch();
  const EndFunctions ends = basis_.end_functions(mode.end_functions);
  const auto end_values = [&](std::size_t column) {
    return EndValues{c.ends[column][0], c.ends[column][1]};
  };
  for (std::size_t column = 0; column < 4; ++column)
    subtract_ends(c.source + column * p, end_values(column), ends.lower, ends.upper, p);
  basis_.sine_analysis().apply(c.source, c.coefficients, 4);
  solve_coefficients(c.coefficients, filter_ ? basis_.filter() : nullptr, ends.inverse_laplacian,
                     basis_.wavenumber(), p);
  basis_.sine_synthesis().apply(c.coefficients, c.value, 6);
  basis_.cosine_synthesis().apply(c.coefficients + 6 * p, c.value + 6 * p, 2);
  for (std::size_t column = 0; column < 4; ++column)
    restore_ends(c.value + column * p, end_values(column), ends.lower, ends.upper, p);
  // ∇²w = ξ_y − η_x = −D, hence the sign of its end part.
  for (std::size_t part = 0; part < 2; ++part) {
    subtract_ends(c.value + (4 + part) * p, end_values(part), ends.lower_inverse,
                  ends.upper_inverse, p);
    subtract_ends(c.value + (6 + part) * p, end_values(part), ends.lower_inverse_z,
                  ends.upper_inverse_z, p);
  }
  derivative_.apply(c.value + 2 * p, c.zeta_z, 2);
}

void ModeInversion3D::solve(const Mode3D& mode, const double* in, const double* in_conjugate,
                            double* out, double* out_conjugate, double* work) const {
  const std::size_t p = basis_.pitch();
  const auto stride = std::size_t(levels_), top = std::size_t(nz_);
  Columns c(work, p);
  for (std::size_t f = 0; f < mode_slot::input_count; ++f)
    unpack(in + f * stride, in_conjugate + f * stride, levels_, mode.scale, c.vorticity + 2 * f * p,
           p);
  horizontal_curl(mode.k, mode.l, c.vorticity, p, c.source);
  std::copy_n(c.vorticity + 4 * p, 2 * p, c.source + 2 * p);
  for (std::size_t column = 0; column < 4; ++column) {
    c.ends[column][0] = c.source[column * p];
    c.ends[column][1] = c.source[column * p + top];
  }
  project_and_invert(mode, c);

  const double inverse = 1 / (mode.k * mode.k + mode.l * mode.l);
  const double k = mode.k * inverse, l = mode.l * inverse;
  const double *curl = c.value, *zeta = c.value + 2 * p, *w = c.value + 4 * p;
  const double* w_z = c.value + 6 * p;
  const auto put = [&](int slot, const double* column) {
    const std::size_t at = std::size_t(slot) * stride;
    pack(column, p, levels_, out + at, out_conjugate + at);
  };
  const auto put_with_y_derivative = [&](int slot, int slot_y, const double* column) {
    put(slot, column);
    differentiate(mode.l, column, p, c.source);
    put(slot_y, c.source);
  };
  gradient_sum(k, l, w_z, zeta, p, c.result);
  put_with_y_derivative(mode_slot::u, mode_slot::u_y, c.result);
  gradient_sum(-k, l, zeta, w_z, p, c.result);
  put_with_y_derivative(mode_slot::v, mode_slot::v_y, c.result);
  put_with_y_derivative(mode_slot::w, mode_slot::w_y, w);
  gradient_sum(k, l, c.zeta_z, curl, p, c.result);
  put(mode_slot::xi, c.result);
  gradient_sum(-k, l, curl, c.zeta_z, p, c.result);
  put(mode_slot::eta, c.result);
}

void ModeInversion3D::integrate_mean(const double* vorticity, double sign, double wind,
                                     double* series, double* velocity) const {
  const std::size_t p = basis_.pitch();
  const double lower = vorticity[0], upper = vorticity[nz_];
  std::fill_n(series, 2 * p, 0.0);
  for (std::size_t k = 0; k <= std::size_t(nz_); ++k)
    series[k] = vorticity[k] - lower * basis_.mean_lower()[k] - upper * basis_.mean_upper()[k];
  basis_.sine_analysis().apply(series, velocity, 2);
  for (std::size_t m = 1; m < std::size_t(nz_); ++m)
    series[m] = -velocity[m] / basis_.wavenumber()[m];
  basis_.cosine_synthesis().apply(series, velocity, 2);
  for (std::size_t k = 0; k <= std::size_t(nz_); ++k)
    velocity[k] = wind + sign * (velocity[k] + lower * basis_.mean_lower_integral()[k] +
                                 upper * basis_.mean_upper_integral()[k]);
}

void ModeInversion3D::solve_mean(double scale, std::array<double, 2> wind, const double* in,
                                 double* out, double* work) const {
  const std::size_t p = basis_.pitch();
  const auto stride = std::size_t(levels_);
  Columns c(work, p);
  for (std::size_t f = 0; f < 2; ++f)
    unpack(in + f * stride, in + f * stride, levels_, scale, c.vorticity + 2 * f * p, p);
  const double *xi = c.vorticity, *eta = c.vorticity + 2 * p;
  std::fill_n(out, std::size_t(mode_slot::count) * stride, 0.0);
  const auto put = [&](int slot, const double* column) {
    std::copy_n(column, std::size_t(nz_) + 1, out + std::size_t(slot) * stride);
  };
  integrate_mean(eta, 1, wind[0], c.source, c.value);
  put(mode_slot::u, c.value);
  integrate_mean(xi, -1, wind[1], c.source, c.value);
  put(mode_slot::v, c.value);
  put(mode_slot::xi, xi);
  put(mode_slot::eta, eta);
}

}  // namespace pileus::mesh
