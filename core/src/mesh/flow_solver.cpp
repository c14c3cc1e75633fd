#include "mesh/flow_solver.hpp"

#include <string>

#include "base/error.hpp"
#include "mesh/flow_2d.hpp"
#include "mesh/inversion_3d.hpp"
#include "mesh/tendency_3d.hpp"

namespace pileus::mesh {

namespace {

template <int D>
const FlowOptions& checked(const Grid<D>& grid, const FlowOptions& options) {
  for (int d = 0; d < D; ++d)
    if (grid.cells[d] < 1 || !(grid.extent[d] > 0))
      throw Error(ExitCode::usage,
                  "The domain needs at least one cell and a positive extent in every direction.");
  const std::size_t given = options.reference_stratification.size();
  if (given != 0 && given != std::size_t(grid.nz()) + 1)
    throw Error(ExitCode::usage, "The reference stratification has " + std::to_string(given) +
                                     " values; the grid has " + std::to_string(grid.nz() + 1) +
                                     " levels.");
  return options;
}

}  // namespace

template <>
struct FlowSolver<3>::Stages {
  Inversion3D inversion;
  Tendency3D tendency;

  Stages(const Grid<3>& grid, const FlowOptions& options)
      : inversion(grid, checked(grid, options)), tendency(grid, options) {}
  void invert(const double* deposited, std::array<double, 2> wind, double* flow,
              FlowSummary* summary) {
    inversion.solve(deposited, wind, flow, summary);
  }
};

template <>
struct FlowSolver<2>::Stages {
  Inversion2D inversion;
  Tendency2D tendency;

  Stages(const Grid<2>& grid, const FlowOptions& options)
      : inversion(grid, checked(grid, options)), tendency(grid, options) {}
  void invert(const double* deposited, std::array<double, 2> wind, double* flow,
              FlowSummary* summary) {
    inversion.solve(deposited, wind[0], flow, summary);
  }
};

template <int D>
FlowSolver<D>::FlowSolver(const Grid<D>& grid, const FlowOptions& options)
    : stages_(std::make_unique<Stages>(grid, options)) {}
template <int D>
FlowSolver<D>::~FlowSolver() = default;
template <int D>
FlowSolver<D>::FlowSolver(FlowSolver&&) noexcept = default;
template <int D>
FlowSolver<D>& FlowSolver<D>::operator=(FlowSolver&&) noexcept = default;

template <int D>
void FlowSolver<D>::solve(const double* deposited, std::array<double, 2> mean_wind, double* flow,
                          FlowSummary* summary, PhaseTimes& times) {
  if (summary != nullptr) *summary = {};
  {
    const PhaseScope scope(times, Phase::inversion);
    stages_->invert(deposited, mean_wind, flow, summary);
  }
  const PhaseScope scope(times, Phase::tendency);
  if constexpr (D == 3)
    stages_->tendency.solve(deposited, mean_wind, flow, summary);
  else
    stages_->tendency.solve(deposited, flow, summary);
}

template <int D>
void FlowSolver<D>::invert(const double* deposited, std::array<double, 2> mean_wind, double* flow,
                           PhaseTimes& times) {
  const PhaseScope scope(times, Phase::inversion);
  stages_->invert(deposited, mean_wind, flow, nullptr);
}

template <int D>
std::size_t FlowSolver<D>::allocated_bytes() const {
  return stages_->inversion.allocated_bytes() + stages_->tendency.allocated_bytes();
}

template <int D>
void grid_vorticity(const Grid<D>& grid, const double* flow, double* vorticity) {
  using Flow = FlowRecord<D>;
  for (std::size_t node = 0; node < grid.nodes(); ++node) {
    const double* r = flow + node * Flow::width;
    if constexpr (D == 3) {
      vorticity[3 * node] = r[Flow::w_y] - r[Flow::v_z];
      vorticity[3 * node + 1] = r[Flow::u_z] - r[Flow::w_x];
      vorticity[3 * node + 2] = r[Flow::v_x] - r[Flow::u_y];
    } else {
      vorticity[node] = r[Flow::w_x] - r[Flow::u_z];
    }
  }
}

template <int D>
std::vector<double> horizontal_mean(const Grid<D>& grid, const double* records, int width,
                                    int offset) {
  std::vector<double> mean(std::size_t(grid.nz()) + 1, 0.0);
  for (std::size_t column = 0; column < grid.columns(); ++column)
    for (int k = 0; k <= grid.nz(); ++k)
      mean[std::size_t(k)] +=
          records[grid.node(column, k) * std::size_t(width) + std::size_t(offset)];
  for (double& value : mean) value /= double(grid.columns());
  return mean;
}

template class FlowSolver<2>;
template class FlowSolver<3>;
template void grid_vorticity(const Grid<2>&, const double*, double*);
template void grid_vorticity(const Grid<3>&, const double*, double*);
template std::vector<double> horizontal_mean(const Grid<2>&, const double*, int, int);
template std::vector<double> horizontal_mean(const Grid<3>&, const double*, int, int);

}  // namespace pileus::mesh
