// The mixed sine/end-function representation of a column, per horizontal wavenumber.
//
// f(z) = f(z0) φ−(z) + f(z1) φ+(z) + Σ_{m=1}^{n_z−1} a_m sin(mπ(z − z0)/L), where the end functions
// solve φ'' = K²φ and are 1 at their own wall and 0 at the other (Frey, Dritschel & Böing 2023,
// J. Comput. Phys. X 17, 100136). Their curvature is the one a harmonic field has at the wall, so
// that a_m decays like m⁻³ or faster and no tridiagonal system is left to solve.
#pragma once
#include <vector>

#include "mesh/column_matrix.hpp"

namespace pileus::mesh {

/// Columns (levels 0 … n_z, padded to column_pitch) of one horizontal wavenumber K > 0.
struct EndFunctions {
  const double* lower;              // φ−
  const double* upper;              // φ+
  const double* lower_inverse;      // θ−: θ'' − K²θ = φ−, zero on both walls
  const double* upper_inverse;      // θ+
  const double* lower_inverse_z;    // dθ−/dz
  const double* upper_inverse_z;    // dθ+/dz
  const double* inverse_laplacian;  // −1/(K² + (mπ/L)²) at m = 1 … n_z−1, else 0
};

class VerticalBasis {
 public:
  /// `height` in m; `squared_wavenumbers` lists every K² > 0 (m⁻²) that will be asked for, in any
  /// order and with repetitions.
  VerticalBasis(int nz, double height, const std::vector<double>& squared_wavenumbers);

  int nz() const { return nz_; }
  std::size_t pitch() const { return column_pitch(nz_); }

  /// Index for end_functions(): K² within rounding of a listed one.
  int find(double squared_wavenumber) const;
  EndFunctions end_functions(int index) const;

  /// a_m = (2/n_z) Σ_k f_k sin(mkπ/n_z); rows and columns 1 … n_z−1.
  const ColumnMatrix& sine_analysis() const { return sine_analysis_; }
  /// f_k = Σ_m a_m sin(mkπ/n_z).
  const ColumnMatrix& sine_synthesis() const { return sine_synthesis_; }
  /// f_k = Σ_m a_m cos(mkπ/n_z), m = 1 … n_z−1: the derivative of a sine series.
  const ColumnMatrix& cosine_synthesis() const { return cosine_synthesis_; }
  /// Vertical wavenumber mπ/L at m = 0 … n_z.
  const double* wavenumber() const { return wavenumber_.data(); }
  /// Hou–Li factor exp(−36 (m/n_z)^36) at m = 0 … n_z (J. Comput. Phys. 226, 379–397, 2007).
  const double* filter() const { return filter_.data(); }
  /// Linear end functions (z1 − z)/L and (z − z0)/L of the horizontal mean.
  const double* mean_lower() const { return mean_lower_.data(); }
  const double* mean_upper() const { return mean_upper_.data(); }
  /// Their antiderivatives with zero vertical mean (m).
  const double* mean_lower_integral() const { return mean_lower_integral_.data(); }
  const double* mean_upper_integral() const { return mean_upper_integral_.data(); }

  std::size_t allocated_bytes() const;

 private:
  void tabulate_mean(double height);
  void tabulate(std::size_t index, double height);

  int nz_;
  std::vector<double> squared_;  // distinct, ascending
  AlignedArray<double> tables_;  // seven columns per distinct K²
  ColumnMatrix sine_analysis_, sine_synthesis_, cosine_synthesis_;
  AlignedArray<double> wavenumber_, filter_;
  AlignedArray<double> mean_lower_, mean_upper_, mean_lower_integral_, mean_upper_integral_;
};

/// Hou–Li factor of a wavenumber at the fraction `fraction` of the largest one.
double hou_li_factor(double fraction);

}  // namespace pileus::mesh
