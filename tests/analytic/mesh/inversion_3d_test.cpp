// Velocity and its gradient against flows known in closed form.
#include <gtest/gtest.h>

#include "../../unit/mesh/sampled_flow.hpp"
#include "exact_flows.hpp"

namespace pileus::mesh::test {
namespace {

using Flow = FlowRecord<3>;

// Sums of some hundred terms of order one, twice transformed.
constexpr double round_off = 5e-15;

template <class Exact>
double velocity_error(const SampledFlow<3>& s, int component, Exact&& exact) {
  return s.error(Flow::u + component,
                 [&](const Vector& x) { return exact(x)[std::size_t(component)]; });
}

TEST(Inversion3D, BeltramiFlowIsExactForAnyNumberOfLevels) {
  // D and ζ are made of sin z and cos z: on [−π/2, π/2] the latter is the first sine mode and
  // the end functions solve for the former exactly. One cell does not see cos z at all.
  for (const int nz : {2, 3, 11, 32}) {
    SampledFlow<3> s(Beltrami::grid(16, 20, nz));
    s.sample(Beltrami::vorticity);
    s.solve(unfiltered());
    for (int c = 0; c < 3; ++c)
      EXPECT_LT(velocity_error(s, c, Beltrami::velocity), round_off) << nz << " levels";
  }
}

TEST(Inversion3D, StrainOfBeltramiFlow) {
  // Largest strain rate of the continuous flow: 1.59097. The nearest node lies within half a
  // spacing of it; the curvature of the strain along z (frequency 2 in its square) costs at most
  // 1.59·(2·π/128)²/2 ≈ 2e-3.
  SampledFlow<3> s(Beltrami::grid(64, 64, 64));
  s.sample(Beltrami::vorticity);
  FlowOptions options = unfiltered();
  options.vertical_derivative = VerticalDerivative::compact;
  EXPECT_NEAR(s.solve(options).strain, 1.59097, 2e-3);
}

TEST(Inversion3D, TaylorGreenFlowWithoutFilterIsExact) {
  for (const TaylorGreen flow : {TaylorGreen{1, 1, -2, 1, 1, 1}, TaylorGreen{1, -1, 1, 2, 1, -1}}) {
    SampledFlow<3> s(TaylorGreen::grid(16, 16, 32));
    s.sample([&](const Vector& x) { return flow.vorticity(x); });
    s.solve(unfiltered());
    for (int c = 0; c < 3; ++c)
      EXPECT_LT(velocity_error(s, c, [&](const Vector& x) { return flow.velocity(x); }), round_off);
  }
}

TEST(Inversion3D, StrainOfTaylorGreenFlow) {
  // S of (1, −1, 1), (2, 1, −1) has the node value diag(−2, 1, 1) at sx sy sz = 1.
  const TaylorGreen flow{1, -1, 1, 2, 1, -1};
  SampledFlow<3> s(TaylorGreen::grid(32, 32, 32));
  s.sample([&](const Vector& x) { return flow.vorticity(x); });
  EXPECT_NEAR(s.solve(unfiltered()).strain, 2, 1e-13);
}

TEST(Inversion3D, FilterCostsTaylorGreenItsPublishedError) {
  // The vertical filter acts on the slowly decaying sine remainder of ζ's wall values. Errors of
  // max |Δu| found with EPIC's own code for 16, 32 and 64 levels, to the digits they were printed
  // with (± half a unit).
  const TaylorGreen flow{1, -1, 1, 2, 1, -1};
  const std::array<std::array<double, 3>, 3> published{
      {{16, 1.4e-3, 0.05e-3}, {32, 2.8e-4, 0.05e-4}, {64, 7.1e-5, 0.05e-5}}};
  for (const auto& [nz, error, half_unit] : published) {
    SampledFlow<3> s(TaylorGreen::grid(16, 16, int(nz)));
    s.sample([&](const Vector& x) { return flow.vorticity(x); });
    s.solve(FlowOptions{});
    EXPECT_NEAR(velocity_error(s, 0, [&](const Vector& x) { return flow.velocity(x); }), error,
                half_unit);
  }
}

TEST(Inversion3D, PolynomialFlowTable) {
  // max |Δu| and max |Δw| with the filter, k = 1, l = 2 on 2π×2π×1, printed to three digits.
  const PolynomialFlow flow{1, 2};
  struct Row {
    int nz;
    double u, w;
  };
  for (const Row row :
       {Row{16, 2.19e-4, 1.68e-5}, Row{32, 5.11e-5, 1.11e-6}, Row{64, 1.29e-5, 7.11e-8}}) {
    SampledFlow<3> s(Grid<3>({16, 16, row.nz}, {0, 0, 0}, {2 * pi, 2 * pi, 1}));
    s.sample([&](const Vector& x) { return flow.vorticity(x); });
    s.solve(FlowOptions{});
    const auto exact = [&](const Vector& x) { return flow.velocity(x); };
    EXPECT_NEAR(velocity_error(s, 0, exact), row.u, 0.005 * row.u);
    EXPECT_NEAR(velocity_error(s, 2, exact), row.w, 0.005 * row.w);
  }
}

TEST(Inversion3D, PolynomialFlowOfPs3d) {
  // 32³ on [−½, ½]²×[0, 1]; PS3D's own test allows 1.2e-2.
  const PolynomialFlow flow{2 * pi, 2 * pi};
  SampledFlow<3> s(Grid<3>({32, 32, 32}, {-0.5, -0.5, 0}, {1, 1, 1}));
  s.sample([&](const Vector& x) { return flow.vorticity(x); });
  s.solve(FlowOptions{});
  for (int c = 0; c < 3; ++c)
    EXPECT_LT(velocity_error(s, c, [&](const Vector& x) { return flow.velocity(x); }), 1.2e-2);
}

TEST(Inversion3D, MeanFlows) {
  // ū = z − ½ and z² − ⅓ are exact; z³ − ¼ is off by 2.67e-5, 3.35e-6, 4.19e-7 at 16, 32, 64
  // levels (third order), printed to three digits. v̄ follows from −ξ̄ with the same numbers.
  const std::array<std::array<double, 2>, 3> cubic{{{16, 2.67e-5}, {32, 3.35e-6}, {64, 4.19e-7}}};
  for (const auto& [levels, cubic_error] : cubic)
    for (int power = 1; power <= 3; ++power) {
      SampledFlow<3> s(Grid<3>({4, 3, int(levels)}, {0, 0, 0}, {1, 1, 1}));
      const auto shear = [&](double z) { return power * std::pow(z, power - 1); };
      s.sample([&](const Vector& x) { return Vector{-shear(x[2]), shear(x[2]), 0}; });
      s.solve(FlowOptions{});
      for (const int field : {Flow::u, Flow::v}) {
        const double error = s.error(
            field, [&](const Vector& x) { return std::pow(x[2], power) - 1.0 / (power + 1); });
        if (power < 3)
          EXPECT_LT(error, 1e-15);
        else
          EXPECT_NEAR(error, cubic_error, 0.005 * cubic_error);
      }
      EXPECT_EQ(s.error(Flow::w, [](const Vector&) { return 0.0; }), 0);
    }
}

class GradientOrder : public ::testing::TestWithParam<VerticalDerivative> {};

TEST_P(GradientOrder, TaylorGreenGradient) {
  // Everything that does not see the vertical vorticity's z-derivative is exact; u_z and v_z take
  // ξ and η from the solenoidal projection and inherit its derivative's order.
  const TaylorGreen flow{1, -1, 1, 2, 1, -1};
  double interior[2], wall[2];
  for (int n = 0; n < 2; ++n) {
    const int nz = 64 << n;
    SampledFlow<3> s(TaylorGreen::grid(32, 16, nz));
    s.sample([&](const Vector& x) { return flow.vorticity(x); });
    FlowOptions options = unfiltered();
    options.vertical_derivative = GetParam();
    s.solve(options);
    const auto error = [&](int entry, int first, int last) {
      return s.error(Flow::u_x + entry, first, last,
                     [&](const Vector& x) { return flow.gradient(x)[std::size_t(entry)]; });
    };
    for (const int entry : {0, 1, 3, 4, 6, 7}) EXPECT_LT(error(entry, 0, nz), 2e-14) << entry;
    // Ten levels from the wall the closure's error has decayed by (2 − √3)^10 = 2e-6.
    interior[n] = std::max(error(2, 10, nz - 10), error(5, 10, nz - 10));
    wall[n] = std::max(error(2, 0, 0), error(5, nz, nz));
  }
  const bool compact = GetParam() == VerticalDerivative::compact;
  EXPECT_GT(convergence_order(interior[0], interior[1]), compact ? 3.8 : 1.9);
  EXPECT_GT(convergence_order(wall[0], wall[1]), compact ? 2.9 : 0.9);
}

INSTANTIATE_TEST_SUITE_P(Derivatives, GradientOrder,
                         ::testing::Values(VerticalDerivative::centred,
                                           VerticalDerivative::compact));

TEST(Inversion3D, WideDomainKeepsAccuracy) {
  // K L = 2π·10⁻³: the particular solutions are differences of terms (K L)⁻² = 2.5e4 times larger;
  // computed in double precision w would lose five digits.
  const double k = 2 * pi * 1e-3, L = 1;
  SampledFlow<3> s(Grid<3>({8, 1, 16}, {0, 0, 0}, {1000, 1000, L}));
  // u = cos kx · π cos πz, w = k sin kx sin πz is solenoidal; η = u_z − w_x.
  s.sample([&](const Vector& x) {
    return Vector{0, -(pi * pi + k * k) * std::cos(k * x[0]) * std::sin(pi * x[2]), 0};
  });
  s.solve(unfiltered());
  EXPECT_LT(s.error(Flow::w,
                    [&](const Vector& x) { return k * std::sin(k * x[0]) * std::sin(pi * x[2]); }),
            1e-14 * k);
  EXPECT_LT(s.error(Flow::u,
                    [&](const Vector& x) { return pi * std::cos(k * x[0]) * std::cos(pi * x[2]); }),
            1e-12);
}

}  // namespace
}  // namespace pileus::mesh::test
