// Fields sampled on a mesh, solved, and compared with what they should give.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "base/aligned_array.hpp"
#include "mesh/flow_solver.hpp"

namespace pileus::mesh::test {

template <int D>
using Point = std::array<double, D>;

template <int D>
Point<D> position(const Grid<D>& grid, int i, int j, int k) {
  if constexpr (D == 3)
    return {grid.lower[0] + i * grid.spacing[0], grid.lower[1] + j * grid.spacing[1],
            grid.lower[2] + k * grid.spacing[2]};
  else
    return {grid.lower[0] + i * grid.spacing[0], grid.lower[1] + k * grid.spacing[1]};
}

/// Deposited and flow records of one mesh. What a solver must not read is NaN.
template <int D>
class SampledFlow {
 public:
  using Deposit = DepositRecord<D>;
  using Flow = FlowRecord<D>;

  explicit SampledFlow(const Grid<D>& g)
      : grid(g), deposited(g.nodes() * Deposit::width), flow(g.nodes() * Flow::width) {
    deposited.fill(std::numeric_limits<double>::quiet_NaN());
    flow.fill(std::numeric_limits<double>::quiet_NaN());
  }

  double* deposit(int i, int j, int k) {
    return deposited.data() + grid.node(grid.column(i, j), k) * Deposit::width;
  }
  const double* record(int i, int j, int k) const {
    return flow.data() + grid.node(grid.column(i, j), k) * Flow::width;
  }

  /// Calls f(i, j, k) for the levels first … last.
  template <class F>
  void for_nodes(int first, int last, F&& f) const {
    for (int j = 0; j < grid.ny(); ++j)
      for (int i = 0; i < grid.nx(); ++i)
        for (int k = first; k <= last; ++k) f(i, j, k);
  }

  /// Deposits vorticity(point) (an array) and buoyancy(point).
  template <class Vorticity, class Buoyancy>
  void sample(Vorticity&& vorticity, Buoyancy&& buoyancy) {
    for_nodes(0, grid.nz(), [&](int i, int j, int k) {
      const auto x = position(grid, i, j, k);
      double* r = deposit(i, j, k);
      r[Deposit::volume] = grid.cell_volume();
      const auto omega = vorticity(x);
      for (int c = 0; c < Deposit::vorticity_components; ++c)
        r[Deposit::vorticity + c] = omega[std::size_t(c)];
      r[Deposit::buoyancy] = buoyancy(x);
    });
  }
  template <class Vorticity>
  void sample(Vorticity&& vorticity) {
    sample(vorticity, [](const auto&) { return 0.0; });
  }

  void sample_noise(unsigned seed) {
    std::mt19937_64 engine(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const auto noise = [&](const auto&) {
      std::array<double, 3> omega{};
      for (int c = 0; c < Deposit::vorticity_components; ++c)
        omega[std::size_t(c)] = uniform(engine);
      return omega;
    };
    sample(noise, [&](const auto&) { return uniform(engine); });
  }

  FlowSummary solve(const FlowOptions& options, std::array<double, 2> wind = {0, 0}) {
    FlowSolver<D> solver(grid, options);
    FlowSummary summary;
    PhaseTimes times;
    solver.solve(deposited.data(), wind, flow.data(), &summary, times);
    return summary;
  }

  /// Largest |record[field] − expected(point)| over levels first … last.
  template <class Expected>
  double error(int field, int first, int last, Expected&& expected) const {
    double largest = 0;
    for_nodes(first, last, [&](int i, int j, int k) {
      const double difference =
          std::abs(record(i, j, k)[field] - expected(position(grid, i, j, k)));
      largest = difference > largest || std::isnan(difference) ? difference : largest;
    });
    return largest;
  }
  template <class Expected>
  double error(int field, Expected&& expected) const {
    return error(field, 0, grid.nz(), expected);
  }

  Grid<D> grid;
  AlignedArray<double> deposited, flow;
};

inline FlowOptions unfiltered() {
  FlowOptions options;
  options.filter = false;
  return options;
}

inline double convergence_order(double coarse, double fine) {
  return std::log2(coarse / fine);
}

}  // namespace pileus::mesh::test
