// Vorticity tendency in flux form, 3D.
#pragma once
#include "mesh/flow_options.hpp"
#include "mesh/grid.hpp"
#include "mesh/line_transform.hpp"
#include "mesh/thread_scratch.hpp"

namespace pileus::mesh {

/// Material tendency of the vorticity on the nodes (ω·∇u + f·∇u plus the curl of the buoyancy,
/// rewritten with ∇·ω = ∇·f = 0): Dω_i/Dt = ∇·[(ω + f) u_i − ½∇×(u′_i² e_i)] + buoyancy terms,
/// where u′ is the velocity less the mean wind and the curl, e_i the unit vector, takes from the
/// flux what cancels in its divergence. Without a mean wind that is
///   Dξ/Dt = ∂x[(ξ+f_x)u]       + ∂y[(f_y−w_x)u + b] + ∂z[(v_x+f_z)u]
///   Dη/Dt = ∂x[(w_y+f_x)v − b] + ∂y[(η+f_y)v]       + ∂z[(f_z−u_y)v]
///   Dζ/Dt = ∂x[(f_x−v_z)w]     + ∂y[(u_z+f_y)w]     + ∂z[(ζ+f_z)w].
/// On the mesh, where products of short waves alias, it would not cancel: ∂x(w w_y) − ∂y(w w_x) is
/// of the order of w²/Δ² for updraughts as narrow as a cell. In cells many times as high as wide,
/// where the tilting u_z w_y − v_z w_x is small, updraughts would turn about their own axes. The
/// mean wind adds its multiple of ∇·ω, which is zero on the mesh as well: it changes nothing.
///
/// Horizontal derivatives are spectral, so that their sum over a level vanishes to round-off; the
/// vertical one is FlowOptions::vertical_derivative. Weighted over the levels with that
/// derivative's quadrature (derivative_quadrature: the trapezoidal rule for the centred one), the
/// sum of the tendency of ξ and η over all nodes therefore equals FlowSummary::net_vorticity_rate
/// to round-off, and that of ζ vanishes, whatever the fields; where the tendency of ζ is zeroed on
/// a wall only the former holds. With other weights (parcel volumes) both hold to truncation.
class Tendency3D {
 public:
  Tendency3D(const Grid<3>& grid, const FlowOptions& options);

  /// Fills the tendency of the flow records at all levels from their velocity and gradient and
  /// from the deposited buoyancy. `mean_wind`: of the whole domain, m s⁻¹.
  void solve(const double* deposited, const std::array<double, 2>& mean_wind, double* flow,
             FlowSummary* summary);

  std::size_t allocated_bytes() const;

 private:
  void finish_rows(const double* deposited, double* flow, int j, FlowSummary* summary);
  void finish_strip(int i, double* flow);
  void flux_columns(const double* deposit, const double* flow, double* x_flux, double* y_flux,
                    double* z_flux) const;
  double largest_buoyancy_gradient(const double* deposited, int i, int j) const;

  Grid<3> grid_;
  FlowOptions options_;
  std::array<double, 2> mean_wind_{};
  int levels_;
  ColumnMatrix derivative_;
  LineTransform x_, y_;
  std::vector<double> k_, l_;    // rad/m over the number of points
  AlignedArray<double> y_flux_;  // [j][i][3][levels]
  AlignedArray<double> stratification_;
  std::vector<FlowSummary> row_summary_;
  ThreadScratch scratch_;
};

}  // namespace pileus::mesh
