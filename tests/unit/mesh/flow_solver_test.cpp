// What the flow solver promises around the mathematics: halos, winds, walls, refusals, sizes.
#include "mesh/flow_solver.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "sampled_flow.hpp"

namespace pileus::mesh::test {
namespace {

using Flow = FlowRecord<3>;

TEST(FlowSolver, HaloContinuesTheFlow) {
  SampledFlow<3> s(Grid<3>({6, 5, 4}, {0, 0, 0}, {3, 2, 1}));
  s.sample_noise(1);
  s.solve(FlowOptions{});
  const int nz = 4;
  s.for_nodes(0, 0, [&](int i, int j, int) {
    const auto check = [&](const double* halo, const double* wall, const double* inner) {
      for (const int f : {Flow::u, Flow::v, Flow::u_x, Flow::u_y, Flow::v_x, Flow::v_y,
                          Flow::tendency, Flow::tendency + 1, Flow::tendency + 2})
        EXPECT_NEAR(halo[f], 2 * wall[f] - inner[f], 1e-13);
      for (const int f : {Flow::w, Flow::w_x, Flow::w_y}) EXPECT_EQ(halo[f], -inner[f]);
      for (const int f : {Flow::w, Flow::w_x, Flow::w_y}) EXPECT_EQ(wall[f], 0);
      // Vorticity is continued linearly, not left as deposited.
      const auto xi = [](const double* r) { return r[Flow::w_y] - r[Flow::v_z]; };
      const auto eta = [](const double* r) { return r[Flow::u_z] - r[Flow::w_x]; };
      EXPECT_NEAR(xi(halo), 2 * xi(wall) - xi(inner), 1e-13);
      EXPECT_NEAR(eta(halo), 2 * eta(wall) - eta(inner), 1e-13);
      EXPECT_EQ(halo[14], 0);
      EXPECT_EQ(halo[15], 0);
    };
    check(s.record(i, j, -1), s.record(i, j, 0), s.record(i, j, 1));
    check(s.record(i, j, nz + 1), s.record(i, j, nz), s.record(i, j, nz - 1));
  });
}

TEST(FlowSolver, MeanWindMovesOnlyTheWind) {
  SampledFlow<3> still(Grid<3>({6, 5, 4}, {0, 0, 0}, {3, 2, 1})), windy(still.grid);
  for (SampledFlow<3>* s : {&still, &windy}) s->sample_noise(2);
  still.solve(FlowOptions{});
  windy.solve(FlowOptions{}, {3, -2});
  // A wind of order one changes u and v by itself to round-off of the sums, everything else that
  // does not contain u or v (all up to the tendency) not at all.
  still.for_nodes(-1, 5, [&](int i, int j, int k) {
    const double *a = still.record(i, j, k), *b = windy.record(i, j, k);
    EXPECT_NEAR(b[Flow::u] - a[Flow::u], 3, 1e-14);
    EXPECT_NEAR(b[Flow::v] - a[Flow::v], -2, 1e-14);
    for (int f = Flow::w; f < Flow::tendency; ++f) EXPECT_EQ(a[f], b[f]);
  });
}

TEST(FlowSolver, MeanWindLeavesTheTendencyAloneWhereItShould) {
  // ∇·(ω (u + U)) − ∇·(ω u) = U ∇·ω, zero for the projected vorticity in its own discrete sense;
  // walls, where ω differs from the projected one by nothing, included.
  SampledFlow<3> still(Grid<3>({8, 7, 9}, {0, 0, 0}, {3, 2, 1})), windy(still.grid);
  for (SampledFlow<3>* s : {&still, &windy}) s->sample_noise(3);
  still.solve(FlowOptions{});
  windy.solve(FlowOptions{}, {3, -2});
  still.for_nodes(0, 9, [&](int i, int j, int k) {
    for (int f = Flow::tendency; f < Flow::tendency + 3; ++f)
      EXPECT_NEAR(still.record(i, j, k)[f], windy.record(i, j, k)[f], 1e-11);
  });
}

TEST(FlowSolver, WallFlagKeepsVerticalVorticityZero) {
  SampledFlow<3> s(Grid<3>({6, 6, 5}, {0, 0, 0}, {1, 1, 1}));
  s.sample_noise(4);
  FlowOptions options;
  options.zero_vertical_vorticity = {true, false};
  options.planetary_vorticity = {0, 0, 1};
  s.solve(options);
  double free_wall = 0;
  s.for_nodes(0, 0, [&](int i, int j, int) {
    const double *bottom = s.record(i, j, 0), *top = s.record(i, j, 5);
    EXPECT_EQ(bottom[Flow::v_x] - bottom[Flow::u_y], 0);
    EXPECT_EQ(bottom[Flow::tendency + 2], 0);
    free_wall = std::max(free_wall, std::abs(top[Flow::v_x] - top[Flow::u_y]));
    EXPECT_NE(top[Flow::tendency + 2], 0);
  });
  EXPECT_GT(free_wall, 1e-3);
}

TEST(FlowSolver, BrokenFlowDoesNotPassForACalmOne) {
  SampledFlow<3> s(Grid<3>({6, 6, 12}, {0, 0, 0}, {1, 1, 1}));
  s.sample_noise(9);
  s.deposit(3, 4, 5)[DepositRecord<3>::vorticity] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(s.solve(FlowOptions{}).strain));
}

TEST(FlowSolver, BuoyancyGradientIncludesTheReference) {
  SampledFlow<3> s(Grid<3>({4, 4, 6}, {0, 0, 0}, {1, 1, 3}));
  s.sample(
      [](const auto&) {
        return std::array{0.0, 0.0, 0.0};
      },
      [](const auto& x) { return -0.5 * x[2]; });
  FlowOptions options;
  options.reference_stratification = {2, 2, 2, 2, 2, 2, 2.5};
  EXPECT_NEAR(s.solve(options).buoyancy_gradient, 2, 1e-14);
}

TEST(FlowSolver, RefusesImpossibleGrids) {
  EXPECT_THROW(FlowSolver<3>(Grid<3>({0, 4, 4}, {0, 0, 0}, {1, 1, 1}), {}), Error);
  EXPECT_THROW(FlowSolver<3>(Grid<3>({4, 4, 0}, {0, 0, 0}, {1, 1, 1}), {}), Error);
  EXPECT_THROW(FlowSolver<2>(Grid<2>({4, 4}, {0, 0}, {1, -1}), {}), Error);
  FlowOptions options;
  options.reference_stratification = {1, 2};
  EXPECT_THROW(FlowSolver<3>(Grid<3>({4, 4, 4}, {0, 0, 0}, {1, 1, 1}), options), Error);
}

TEST(FlowSolver, ChargesItsPhases) {
  SampledFlow<2> s(Grid<2>({4, 4}, {0, 0}, {1, 1}));
  s.sample_noise(5);
  FlowSolver<2> solver(s.grid, {});
  PhaseTimes times;
  solver.solve(s.deposited.data(), {0, 0}, s.flow.data(), nullptr, times);
  EXPECT_EQ(times[Phase::inversion].calls, 1u);
  EXPECT_EQ(times[Phase::tendency].calls, 1u);
  EXPECT_GT(solver.allocated_bytes(), 0u);
}

TEST(GridDiagnostics, VorticityAndHorizontalMean) {
  SampledFlow<3> s(Grid<3>({4, 3, 5}, {0, 0, 0}, {1, 1, 1}));
  s.sample([](const auto& x) { return std::array{x[2], 1 - x[2], 0.0}; });
  s.solve(FlowOptions{});
  AlignedArray<double> vorticity(3 * s.grid.nodes());
  grid_vorticity(s.grid, s.flow.data(), vorticity.data());
  const auto xi = horizontal_mean(s.grid, vorticity.data(), 3, 0);
  const auto eta = horizontal_mean(s.grid, vorticity.data(), 3, 1);
  ASSERT_EQ(xi.size(), 6u);
  for (int k = 0; k <= 5; ++k) {
    EXPECT_NEAR(xi[std::size_t(k)], 0.2 * k, 1e-15);
    EXPECT_NEAR(eta[std::size_t(k)], 1 - 0.2 * k, 1e-15);
  }
}

}  // namespace
}  // namespace pileus::mesh::test
