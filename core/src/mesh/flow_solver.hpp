// Velocity, velocity gradient and vorticity tendency from the deposited vorticity and buoyancy.
#pragma once
#include <array>
#include <memory>
#include <vector>

#include "base/phase_timer.hpp"
#include "mesh/flow_options.hpp"
#include "mesh/grid.hpp"

namespace pileus::mesh {

/// 3D: the inversion of Frey, Dritschel & Böing 2023 (J. Comput. Phys. X 17, 100136) in
/// the mixed sine/end-function form with solenoidal projection, and the tendency in flux form
/// (tendency_3d.hpp states which quadrature makes the budget of the net vorticity exact).
/// The horizontal mean of ζ, which a periodic box cannot have, is dropped.
/// 2D: stream function ∇²ψ = ζ, u = −ψ_z, w = ψ_x in the same form, tendency ∂b/∂x.
///
/// Nothing is allocated after construction unless the number of threads grows. Every bit of the
/// result is independent of the number of threads.
template <int D>
class FlowSolver {
 public:
  /// Throws Error (usage) when the grid has no cells in a direction, or the reference
  /// stratification does not have n_z + 1 values.
  FlowSolver(const Grid<D>& grid, const FlowOptions& options);
  ~FlowSolver();
  FlowSolver(FlowSolver&&) noexcept;
  FlowSolver& operator=(FlowSolver&&) noexcept;

  /// `deposited`: DepositRecord<D> per node, means; only the levels 0 … n_z are read. `mean_wind`
  /// (m/s): domain mean of u and v (2D: the first entry). `flow`: FlowRecord<D> per node, filled
  /// at all levels −1 … n_z + 1; beyond the walls u, v and the vorticity are extrapolated
  /// linearly, w is odd. `summary` may be null. Times are charged to inversion and tendency.
  void solve(const double* deposited, std::array<double, 2> mean_wind, double* flow,
             FlowSummary* summary, PhaseTimes& times);

  /// Velocity and velocity gradient alone: the tendencies in `flow` are left as they are.
  void invert(const double* deposited, std::array<double, 2> mean_wind, double* flow,
              PhaseTimes& times);

  std::size_t allocated_bytes() const;

 private:
  struct Stages;
  std::unique_ptr<Stages> stages_;
};

/// Filtered, solenoidal vorticity of the flow records: 3 (2D: 1) values per node, all levels.
template <int D>
void grid_vorticity(const Grid<D>& grid, const double* flow, double* vorticity);

/// Horizontal means at the levels 0 … n_z of the value at `offset` of records of `width` doubles.
template <int D>
std::vector<double> horizontal_mean(const Grid<D>& grid, const double* records, int width,
                                    int offset);

}  // namespace pileus::mesh
