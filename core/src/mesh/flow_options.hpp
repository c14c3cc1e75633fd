// What a flow solve is told and what it reports.
#pragma once
#include <array>
#include <vector>

#include "mesh/vertical_derivative.hpp"

namespace pileus::mesh {

struct FlowOptions {
  /// Planetary vorticity f (s⁻¹); 3D only.
  std::array<double, 3> planetary_vorticity{0, 0, 0};
  /// Vertical vorticity and its tendency are kept zero on the lower and upper wall; 3D only.
  std::array<bool, 2> zero_vertical_vorticity{false, false};
  /// Hou–Li filter on the gridded vorticity.
  bool filter = true;
  /// For the vertical derivatives of the tendency and of the solenoidal projection; 3D only.
  VerticalDerivative vertical_derivative = VerticalDerivative::centred;
  /// Vertical gradient of the reference buoyancy at the levels 0 … n_z (s⁻²), added to the
  /// deposited buoyancy's where its magnitude is reported; empty: zero.
  std::vector<double> reference_stratification;
};

/// Extrema over the nodes of levels 0 … n_z and the budget of the net vorticity.
struct FlowSummary {
  double strain = 0;             // s⁻¹, largest |eigenvalue| of the strain rate
  double buoyancy_gradient = 0;  // s⁻², largest |∇b|, centred differences, one-sided at walls
  std::array<double, 3> speed{0, 0, 0};  // m s⁻¹, largest |u|, |v|, |w| (2D: |u|, |w|)
  double vorticity = 0;                  // s⁻¹, largest |ω|
  /// Rate of change of the domain-mean horizontal vorticity (s⁻²), 3D:
  /// (1/V) [∮_top (ζ + f_z) u_h dA − ∮_bottom (ζ + f_z) u_h dA].
  std::array<double, 2> net_vorticity_rate{0, 0};
};

}  // namespace pileus::mesh
