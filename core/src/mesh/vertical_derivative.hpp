// First derivatives along z on the levels 0 … n_z, and the quadratures that undo them exactly.
#pragma once
#include <vector>

#include "mesh/column_matrix.hpp"

namespace pileus::mesh {

enum class VerticalDerivative {
  /// Second-order centred differences, first-order one-sided at the walls.
  centred,
  /// Fourth-order compact differences with the third-order wall closure 2d_0 + 4d_1 (Lele 1992,
  /// J. Comput. Phys. 103, 16–42, eq. 2.1.6 and 4.1.1), asymptotically stable in the combination
  /// 3–4–3 (Carpenter, Gottlieb & Abarbanel 1993, J. Comput. Phys. 108, 272–295). Two cells use
  /// the parabola through the three levels, one cell the only difference there is.
  compact,
};

/// The derivative as a matrix over the levels; `spacing` in m.
ColumnMatrix vertical_derivative(VerticalDerivative kind, int nz, double spacing);

/// Weights q_k in cells (Σ q_k = n_z) with Σ_k q_k (∂_z f)_k Δz = f_{n_z} − f_0 to round-off for
/// every f: the trapezoidal rule for centred differences; for compact ones the third-order Gregory
/// rule 3/8, 7/6, 23/24, 1, … (its two ends overlap, and still hold, for few levels); Simpson's
/// rule for the parabola of two cells.
std::vector<double> derivative_quadrature(VerticalDerivative kind, int nz);

}  // namespace pileus::mesh
