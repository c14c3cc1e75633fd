// Extrema of the flow over a column.
#pragma once
#include "mesh/flow_options.hpp"

namespace pileus::mesh {

/// Columns of n_z + 1 levels of the velocity gradient and what goes with it, 3D.
struct GradientColumns {
  const double *u_x, *u_y, *v_x, *v_y, *w_x, *w_y, *xi, *eta;
  int levels;
};

/// Largest |eigenvalue| of the symmetric part of ∇u, whose trace is zero, over the column (s⁻¹);
/// NaN if any entry is, so that a broken flow cannot pass for a calm one.
double largest_strain(const GradientColumns& g);
/// Largest ξ² + η² + ζ² over the column (s⁻²).
double largest_squared_vorticity(const GradientColumns& g);
/// Largest |f| of `count` values.
double largest_magnitude(const double* f, int count);

/// Takes the larger of every extremum; a strain that is not a number stays so.
void merge_extrema(FlowSummary& into, const FlowSummary& from);

}  // namespace pileus::mesh
