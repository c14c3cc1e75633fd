// Stream-function inversion and vorticity tendency, 2D.
#pragma once
#include <vector>

#include "mesh/flow_options.hpp"
#include "mesh/grid.hpp"
#include "mesh/line_transform.hpp"
#include "mesh/thread_scratch.hpp"
#include "mesh/vertical_basis.hpp"

namespace pileus::mesh {

/// ∇²ψ = ζ with ψ = 0 on the walls, u = −ψ_z, w = ψ_x, in the mixed sine/end-function form of the
/// 3D inversion. Rows are transformed a few levels at a time.
class Inversion2D {
 public:
  Inversion2D(const Grid<2>& grid, const FlowOptions& options);

  /// Fills velocity and velocity gradient of the flow records at all levels; `wind` is the domain
  /// mean of u (m/s).
  void solve(const double* deposited, double wind, double* flow, FlowSummary* summary);

  std::size_t allocated_bytes() const;

 private:
  struct Columns;
  void transform_levels(const double* deposited, int block);
  void invert(const EndFunctions& ends, Columns& columns) const;
  void solve_mode(int i);
  void solve_mean(double wind);
  void finish_levels(int block, double* flow, FlowSummary* summary);
  void extrapolate(int i, double* flow) const;
  std::size_t vorticity_column(int i) const { return std::size_t(i) * std::size_t(levels_); }
  std::size_t flow_column(int i) const;

  Grid<2> grid_;
  FlowOptions options_;
  int blocks_, levels_;  // levels of a packed column: whole blocks
  VerticalBasis basis_;
  LineTransform in_, out_;
  AlignedArray<double> vorticity_;  // [i][levels], transformed along x
  AlignedArray<double> flow_;       // [i][slot][levels]
  std::vector<FlowSummary> block_summary_;
  ThreadScratch scratch_;
};

/// Material tendency of the vorticity in 2D, ∂b/∂x (spectral), extrapolated linearly beyond the
/// walls. Its sum over every level vanishes to round-off: the net vorticity is kept.
class Tendency2D {
 public:
  Tendency2D(const Grid<2>& grid, const FlowOptions& options);
  void solve(const double* deposited, double* flow, FlowSummary* summary);
  std::size_t allocated_bytes() const { return scratch_.allocated_bytes(); }

 private:
  void solve_levels(const double* deposited, int block, double* flow);
  double largest_buoyancy_gradient(const double* deposited, int i) const;

  Grid<2> grid_;
  AlignedArray<double> stratification_;
  int blocks_;
  LineTransform line_;
  std::vector<double> column_gradient_;
  ThreadScratch scratch_;
};

}  // namespace pileus::mesh
