// Derivatives of gridded fields outside the time step.
#pragma once
#include "mesh/grid.hpp"
#include "mesh/vertical_derivative.hpp"

namespace pileus::mesh {

/// Spectral derivative of a field along a horizontal axis (0: x, 1: y), levels −1 … n_z + 1;
/// `out` must not be `field`. The Nyquist wavenumber has none.
template <int D>
void horizontal_derivative(const Grid<D>& grid, int axis, const double* field, double* out);

/// Vorticity of a velocity field at the levels 0 … n_z, `velocity` as [node*D + component];
/// `vorticity` as [node*3 + component] in 3D and w_x − u_z as [node] in 2D, extrapolated linearly
/// beyond the walls. Spectral along the horizontal, `kind` along z.
template <int D>
void curl(const Grid<D>& grid, VerticalDerivative kind, const double* velocity, double* vorticity);

}  // namespace pileus::mesh
