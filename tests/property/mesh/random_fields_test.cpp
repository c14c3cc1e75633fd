// Laws that hold for any deposited field on any grid.
#include <gtest/gtest.h>
#include <omp.h>

#include <cstring>

#include "../../unit/mesh/sampled_flow.hpp"
#include "mesh/derivatives.hpp"
#include "mesh/volume_potential.hpp"

namespace pileus::mesh::test {
namespace {

using Flow = FlowRecord<3>;

const std::array<Grid<3>, 9>& grids() {
  static const std::array<Grid<3>, 9> all{
      Grid<3>({8, 8, 8}, {0, 0, 0}, {1, 1, 1}),         Grid<3>({7, 5, 9}, {-1, 2, 3}, {3, 1, 0.5}),
      Grid<3>({13, 11, 7}, {0, 0, 0}, {1, 2, 3}),       Grid<3>({12, 6, 1}, {0, 0, 0}, {1, 1, 1}),
      Grid<3>({1, 9, 6}, {0, 0, 0}, {1, 4, 2}),         Grid<3>({9, 1, 6}, {0, 0, 0}, {4, 1, 2}),
      Grid<3>({2, 2, 2}, {0, 0, 0}, {1, 1, 1}),         Grid<3>({1, 1, 5}, {0, 0, 0}, {1, 1, 1}),
      Grid<3>({6, 10, 3}, {0, 0, 0}, {5000, 7000, 100})};
  return all;
}

const std::array<FlowOptions, 4>& option_sets() {
  static const auto all = [] {
    std::array<FlowOptions, 4> sets;
    for (std::size_t n = 0; n < 4; ++n) {
      sets[n].filter = n % 2 == 0;
      sets[n].vertical_derivative =
          n < 2 ? VerticalDerivative::centred : VerticalDerivative::compact;
      sets[n].planetary_vorticity = {0.3, -0.2, 0.7};
    }
    return sets;
  }();
  return all;
}

/// Largest |record field| over the levels 0 … n_z.
double magnitude(const SampledFlow<3>& s, int field) {
  return s.error(field, [](const auto&) { return 0.0; });
}

TEST(RandomFields, EveryLevelOfEveryGridIsFilledWithFiniteNumbers) {
  for (const Grid<3>& grid : grids())
    for (const FlowOptions& options : option_sets()) {
      SampledFlow<3> s(grid);
      s.sample_noise(1);
      s.solve(options, {1, 2});
      for (std::size_t n = 0; n < s.flow.size(); ++n) ASSERT_TRUE(std::isfinite(s.flow[n]));
    }
}

TEST(RandomFields, VorticityIsSolenoidalInItsOwnDiscreteSense) {
  // ξ_x + η_y + δ_z ζ = 0 with spectral horizontal derivatives and the δ_z of the options, at
  // every level, walls included.
  for (const Grid<3>& grid : grids())
    for (const FlowOptions& options : option_sets()) {
      SampledFlow<3> s(grid);
      s.sample_noise(2);
      s.solve(options);
      AlignedArray<double> omega(3 * grid.nodes()), part(grid.nodes()), derivative(grid.nodes()),
          divergence(grid.nodes());
      grid_vorticity(grid, s.flow.data(), omega.data());
      divergence.fill(0);
      double scale = 0;
      for (int axis = 0; axis < 2; ++axis) {
        for (std::size_t n = 0; n < grid.nodes(); ++n) part[n] = omega[3 * n + std::size_t(axis)];
        horizontal_derivative(grid, axis, part.data(), derivative.data());
        for (std::size_t n = 0; n < grid.nodes(); ++n) divergence[n] += derivative[n];
      }
      const ColumnMatrix d =
          vertical_derivative(options.vertical_derivative, grid.nz(), grid.spacing[2]);
      for (std::size_t column = 0; column < grid.columns(); ++column)
        for (int k = 0; k <= grid.nz(); ++k) {
          double sum = 0;
          for (int m = 0; m <= grid.nz(); ++m) sum += d(k, m) * omega[3 * grid.node(column, m) + 2];
          divergence[grid.node(column, k)] += sum;
          scale = std::max(scale, std::abs(sum));
        }
      // Random vorticity of order one, differentiated: scale/ε, amplified by 1/K·max(K).
      for (std::size_t column = 0; column < grid.columns(); ++column)
        for (int k = 0; k <= grid.nz(); ++k)
          ASSERT_LE(std::abs(divergence[grid.node(column, k)]),
                    2e-12 * (scale + 1 / grid.spacing[2]));
    }
}

TEST(RandomFields, GradientIsTheDerivativeOfTheVelocity) {
  for (const Grid<3>& grid : grids()) {
    SampledFlow<3> s(grid);
    s.sample_noise(3);
    s.solve(FlowOptions{}, {1, 2});
    AlignedArray<double> part(grid.nodes()), derivative(grid.nodes());
    const std::array<std::array<int, 3>, 6> pairs{{{Flow::u, 0, Flow::u_x},
                                                   {Flow::u, 1, Flow::u_y},
                                                   {Flow::v, 0, Flow::v_x},
                                                   {Flow::v, 1, Flow::v_y},
                                                   {Flow::w, 0, Flow::w_x},
                                                   {Flow::w, 1, Flow::w_y}}};
    for (const auto& [field, axis, gradient] : pairs) {
      for (std::size_t n = 0; n < grid.nodes(); ++n)
        part[n] = s.flow[n * Flow::width + std::size_t(field)];
      horizontal_derivative(grid, axis, part.data(), derivative.data());
      const double bound =
          1e-13 * (1 + magnitude(s, gradient)) * (1 + 3 / grid.spacing[std::size_t(axis)]);
      for (std::size_t n = 0; n < grid.nodes(); ++n)
        ASSERT_NEAR(s.flow[n * Flow::width + std::size_t(gradient)], derivative[n], bound);
    }
  }
}

TEST(RandomFields, NetVorticityBudgetIsExactInItsQuadrature) {
  for (const Grid<3>& grid : grids())
    for (const FlowOptions& options : option_sets()) {
      SampledFlow<3> s(grid);
      s.sample_noise(4);
      const FlowSummary summary = s.solve(options, {0.5, -1});
      const auto q = derivative_quadrature(options.vertical_derivative, grid.nz());
      std::array<double, 3> sum{0, 0, 0};
      double scale = 0;
      s.for_nodes(0, grid.nz(), [&](int i, int j, int k) {
        for (std::size_t c = 0; c < 3; ++c) {
          const double term =
              q[std::size_t(k)] * s.record(i, j, k)[std::size_t(Flow::tendency) + c];
          sum[c] += term;
          scale += std::abs(term);
        }
      });
      const double cells = double(grid.cell_count());
      // Sums of as many terms as nodes.
      const double bound = 1e-14 * scale / cells + 1e-15;
      EXPECT_NEAR(sum[0] / cells, summary.net_vorticity_rate[0], bound);
      EXPECT_NEAR(sum[1] / cells, summary.net_vorticity_rate[1], bound);
      EXPECT_NEAR(sum[2] / cells, 0, bound);
    }
}

TEST(RandomFields, NetVorticityBudgetHoldsToTruncationWithOtherWeights) {
  // Trapezoidal weights on compact derivatives of a smooth flow whose wall values of ζ and u are
  // correlated: the trapezoidal rule is of second order, so that halving the spacing must cut the
  // defect about fourfold.
  double defect[2];
  for (int n = 0; n < 2; ++n) {
    SampledFlow<3> s(Grid<3>({8, 8, 16 << n}, {0, 0, 0}, {1, 1, 1}));
    const double tau = 2 * std::acos(-1.0);
    s.sample([&](const auto& x) {
      return std::array{0.0, std::cos(tau * x[0]) * (1 + x[2] * x[2]),
                        std::cos(tau * x[0]) * std::exp(x[2])};
    });
    FlowOptions options = unfiltered();
    options.vertical_derivative = VerticalDerivative::compact;
    const FlowSummary summary = s.solve(options);
    double sum = 0;
    s.for_nodes(0, s.grid.nz(), [&](int i, int j, int k) {
      sum += (k == 0 || k == s.grid.nz() ? 0.5 : 1) * s.record(i, j, k)[Flow::tendency];
    });
    defect[n] = std::abs(sum / double(s.grid.cell_count()) - summary.net_vorticity_rate[0]);
  }
  EXPECT_GT(defect[0], 1e-9);
  EXPECT_LT(defect[1], defect[0] / 3.5);
}

TEST(RandomFields, StrainIsTheLargestEigenvalue) {
  // Against the characteristic polynomial: |λ| is a root and no trial value beyond it is one.
  SampledFlow<3> s(Grid<3>({7, 6, 5}, {0, 0, 0}, {1, 1, 1}));
  s.sample_noise(6);
  const double found = s.solve(FlowOptions{}).strain;
  double largest = 0;
  s.for_nodes(0, 5, [&](int i, int j, int k) {
    const double* r = s.record(i, j, k);
    const double a = r[Flow::u_x], b = r[Flow::v_y], c = -a - b;
    const double d = 0.5 * (r[Flow::u_y] + r[Flow::v_x]), e = 0.5 * (r[Flow::u_z] + r[Flow::w_x]),
                 f = 0.5 * (r[Flow::v_z] + r[Flow::w_y]);
    // Power iteration on S² finds the largest |eigenvalue| squared.
    std::array<double, 3> v{0.3, 0.5, 0.7};
    const auto apply = [&](const std::array<double, 3>& x) {
      return std::array{a * x[0] + d * x[1] + e * x[2], d * x[0] + b * x[1] + f * x[2],
                        e * x[0] + f * x[1] + c * x[2]};
    };
    double norm = 0;
    for (int n = 0; n < 2000; ++n) {
      v = apply(v);
      norm = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
      for (double& x : v) x /= norm;
    }
    // The average of two steps' growth irons out alternation between ±λ.
    const auto next = apply(apply(v));
    norm = std::sqrt(std::sqrt(next[0] * next[0] + next[1] * next[1] + next[2] * next[2]));
    largest = std::max(largest, norm);
  });
  EXPECT_NEAR(found, largest, 1e-9 * largest);
}

template <class Solve>
void expect_same_bits_for_any_thread_count(std::size_t size, Solve&& solve) {
  const int before = omp_get_max_threads();
  AlignedArray<double> one(size), other(size);
  for (const int threads : {1, 2, 3}) {
    omp_set_num_threads(threads);
    AlignedArray<double>& out = threads == 1 ? one : other;
    out.fill(0);
    solve(out.data());
    EXPECT_EQ(std::memcmp(one.data(), out.data(), size * sizeof(double)), 0) << threads;
  }
  omp_set_num_threads(before);
}

TEST(Threads, GiveTheSameBits) {
  for (const Grid<3>& grid : {grids()[0], grids()[1]}) {
    FlowSummary first;
    SampledFlow<3> s(grid);
    s.sample_noise(7);
    FlowSolver<3> solver(grid, option_sets()[2]);
    expect_same_bits_for_any_thread_count(s.flow.size(), [&](double* flow) {
      FlowSummary summary;
      PhaseTimes times;
      solver.solve(s.deposited.data(), {1, 2}, flow, &summary, times);
      if (omp_get_max_threads() == 1) first = summary;
      EXPECT_EQ(first.strain, summary.strain);
      EXPECT_EQ(first.buoyancy_gradient, summary.buoyancy_gradient);
      EXPECT_EQ(first.net_vorticity_rate, summary.net_vorticity_rate);
    });
    VolumePotential<3> potential(grid);
    AlignedArray<double> room(potential.room_needed());
    expect_same_bits_for_any_thread_count(4 * grid.nodes(), [&](double* gradient) {
      potential.solve(s.deposited.data(), gradient, room.data());
    });
  }
}

TEST(Threads, GiveTheSameBitsInThePlane) {
  for (const auto& cells : {std::array{37, 41}, {16, 64}, {1, 5}, {2, 1}}) {
    const Grid<2> grid(cells, {0, 0}, {3, 1});
    SampledFlow<2> s(grid);
    s.sample_noise(8);
    FlowSolver<2> solver(grid, FlowOptions{});
    expect_same_bits_for_any_thread_count(s.flow.size(), [&](double* flow) {
      PhaseTimes times;
      solver.solve(s.deposited.data(), {1, 0}, flow, nullptr, times);
      for (std::size_t n = 0; n < s.flow.size(); ++n) ASSERT_TRUE(std::isfinite(flow[n]));
    });
  }
}

}  // namespace
}  // namespace pileus::mesh::test
