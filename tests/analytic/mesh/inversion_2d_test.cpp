// The plane: the stream function against a flow known in closed form and against the compact
// scheme of EPIC's 2D model, whose published errors the sine/end-function form undercuts.
#include <gtest/gtest.h>

#include <numbers>
#include <vector>

#include "../../unit/mesh/sampled_flow.hpp"

namespace pileus::mesh::test {
namespace {

using Flow = FlowRecord<2>;
constexpr double pi = std::numbers::pi;

/// EPIC's test on [−2, 2]×[−1, 1]: u = e^{az}(m sin mz − a cos mz) sin kx,
/// w = k e^{az} cos mz cos kx, ζ = −2ma e^{az} sin mz sin kx with a² = m² + k².
struct Exponential {
  double k = pi / 2, m = pi / 2, a = std::sqrt(m * m + k * k);
  static Grid<2> grid(int nx, int nz) { return {{nx, nz}, {-2, -1}, {4, 2}}; }
  double u_amplitude(double z) const {
    return std::exp(a * z) * (m * std::sin(m * z) - a * std::cos(m * z));
  }
  double w_amplitude(double z) const { return k * std::exp(a * z) * std::cos(m * z); }
  double zeta_amplitude(double z) const { return -2 * m * a * std::exp(a * z) * std::sin(m * z); }
};

struct Errors {
  double u, w, rms_u, rms_w;
};

Errors errors(const SampledFlow<2>& s) {
  const Exponential flow;
  Errors e{0, 0, 0, 0};
  s.for_nodes(0, s.grid.nz(), [&](int i, int j, int k) {
    const Point<2> x = position(s.grid, i, j, k);
    const double du = s.record(i, j, k)[Flow::u] - flow.u_amplitude(x[1]) * std::sin(flow.k * x[0]);
    const double dw = s.record(i, j, k)[Flow::w] - flow.w_amplitude(x[1]) * std::cos(flow.k * x[0]);
    e.u = std::max(e.u, std::abs(du));
    e.w = std::max(e.w, std::abs(dw));
    const bool wall = k == 0 || k == s.grid.nz();
    e.rms_u += du * du * (wall ? 0.5 : 1);
    e.rms_w += wall ? 0 : dw * dw;
  });
  e.rms_u = std::sqrt(e.rms_u / double(s.grid.cell_count()));
  e.rms_w = std::sqrt(e.rms_w / double(s.grid.cell_count()));
  return e;
}

Errors solve_exponential(int nx, int nz) {
  const Exponential flow;
  SampledFlow<2> s(Exponential::grid(nx, nz));
  s.sample([&](const Point<2>& x) {
    return std::array{flow.zeta_amplitude(x[1]) * std::sin(flow.k * x[0])};
  });
  s.solve(unfiltered());
  return errors(s);
}

/// Thomas algorithm; lower[k] x[k−1] + diagonal[k] x[k] + upper[k] x[k+1] = right[k].
std::vector<double> solve_tridiagonal(std::vector<double> lower, std::vector<double> diagonal,
                                      std::vector<double> upper, std::vector<double> right) {
  const std::size_t n = right.size();
  for (std::size_t k = 1; k < n; ++k) {
    const double factor = lower[k] / diagonal[k - 1];
    diagonal[k] -= factor * upper[k - 1];
    right[k] -= factor * right[k - 1];
  }
  right[n - 1] /= diagonal[n - 1];
  for (std::size_t k = n - 1; k-- > 0;)
    right[k] = (right[k] - upper[k] * right[k + 1]) / diagonal[k];
  return right;
}

/// Amplitude of ψ and ψ_z by the fourth-order compact scheme with its wall closure.
Errors compact_errors(int nx, int nz) {
  const Exponential flow;
  const double dz = 2.0 / nz, kk = flow.k * flow.k;
  const auto count = std::size_t(nz) + 1;
  std::vector<double> zeta(count), low(count, 1 / (dz * dz) - kk / 12), diagonal(count),
      right(count);
  for (std::size_t k = 0; k < count; ++k) zeta[k] = flow.zeta_amplitude(-1 + dz * double(k));
  std::vector<double> up = low;
  for (std::size_t k = 1; k + 1 < count; ++k) {
    diagonal[k] = -2 / (dz * dz) - 5 * kk / 6;
    right[k] = (zeta[k - 1] + 10 * zeta[k] + zeta[k + 1]) / 12;
  }
  diagonal[0] = diagonal[count - 1] = 1;
  up[0] = low[count - 1] = right[0] = right[count - 1] = 0;
  const std::vector<double> psi = solve_tridiagonal(low, diagonal, up, right);
  std::fill(low.begin(), low.end(), 1.0 / 6);
  std::fill(up.begin(), up.end(), 1.0 / 6);
  std::fill(diagonal.begin(), diagonal.end(), 4.0 / 6);
  for (std::size_t k = 1; k + 1 < count; ++k) right[k] = (psi[k + 1] - psi[k - 1]) / (2 * dz);
  diagonal[0] = diagonal[count - 1] = 2.0 / 3;
  up[0] = low[count - 1] = 1.0 / 3;
  right[0] = psi[1] / dz - dz / 6 * zeta[0];
  right[count - 1] = -psi[count - 2] / dz + dz / 6 * zeta[count - 1];
  const std::vector<double> psi_z = solve_tridiagonal(low, diagonal, up, right);

  SampledFlow<2> s(Exponential::grid(nx, nz));
  s.for_nodes(0, nz, [&](int i, int j, int k) {
    const Point<2> x = position(s.grid, i, j, k);
    auto* record = const_cast<double*>(s.record(i, j, k));
    record[Flow::u] = -psi_z[std::size_t(k)] * std::sin(flow.k * x[0]);
    record[Flow::w] = flow.k * psi[std::size_t(k)] * std::cos(flow.k * x[0]);
  });
  return errors(s);
}

TEST(Inversion2D, SineFormUndercutsTheCompactScheme) {
  // Four numbers of EPIC's own 2D test at 40×20, which the compact scheme written out above
  // reproduces to all printed digits: this is the peer, not a caricature of it.
  const Errors compact = compact_errors(40, 20);
  EXPECT_NEAR(compact.u, 0.00756272334146, 1e-13);
  EXPECT_NEAR(compact.w, 3.91978052831e-5, 1e-15);
  EXPECT_NEAR(compact.rms_u, 0.0009190338250263, 1e-14);
  EXPECT_NEAR(compact.rms_w, 1.81041574751e-5, 1e-15);
  // The reason for the choice of the sine form: two hundred and thirty times less error.
  const Errors sine = solve_exponential(40, 20);
  EXPECT_LT(sine.u, compact.u / 200);
  EXPECT_LT(sine.w, compact.w / 30);
  EXPECT_LT(sine.rms_u, compact.rms_u / 150);
  EXPECT_LT(sine.rms_w, compact.rms_w / 70);
}

TEST(Inversion2D, ConvergesWithFifthAndSixthOrder) {
  // The sine coefficients decay like m⁻³, hence those of ψ like m⁻⁵; aliasing takes them to the
  // fifth order for ψ_z on the wall and the sixth for ψ.
  const Errors coarse = solve_exponential(16, 20), fine = solve_exponential(16, 40);
  EXPECT_GT(convergence_order(coarse.u, fine.u), 4.8);
  EXPECT_GT(convergence_order(coarse.w, fine.w), 5.8);
}

TEST(Inversion2D, MeanShear) {
  // ū_z = −ζ̄ with zero vertical mean; the mean wind is added to u and to nothing else.
  SampledFlow<2> s(Grid<2>({6, 9}, {0, 0}, {1, 1}));
  s.sample([](const Point<2>& x) { return std::array{2 * x[1]}; });
  s.solve(unfiltered(), {5, 0});
  EXPECT_LT(s.error(Flow::u, [](const Point<2>& x) { return 5 + 1.0 / 3 - x[1] * x[1]; }), 5e-15);
  EXPECT_EQ(s.error(Flow::w, [](const Point<2>&) { return 0.0; }), 0);
}

TEST(Inversion2D, TaylorGreenGradientAndSummary) {
  // u = ½ cos(2x + π/2) sin z, w = −sin(2x + π/2) cos z: strain 1 on the walls, |ζ| at most 2.5.
  SampledFlow<2> s(Grid<2>({16, 24}, {-pi / 2, -pi / 2}, {pi, pi}));
  const auto phase = [](const Point<2>& x) { return 2 * x[0] + pi / 2; };
  s.sample(
      [&](const Point<2>& x) { return std::array{-2.5 * std::cos(phase(x)) * std::cos(x[1])}; });
  const FlowSummary summary = s.solve(unfiltered());
  EXPECT_LT(
      s.error(Flow::u_x, [&](const Point<2>& x) { return -std::sin(phase(x)) * std::sin(x[1]); }),
      1e-14);
  EXPECT_LT(s.error(Flow::u_z,
                    [&](const Point<2>& x) { return 0.5 * std::cos(phase(x)) * std::cos(x[1]); }),
            1e-14);
  EXPECT_LT(s.error(Flow::w_x,
                    [&](const Point<2>& x) { return -2 * std::cos(phase(x)) * std::cos(x[1]); }),
            1e-14);
  EXPECT_NEAR(summary.strain, 1, 1e-14);
  EXPECT_NEAR(summary.vorticity, 2.5, 1e-14);
  EXPECT_NEAR(summary.speed[0], 0.5, 1e-14);
  EXPECT_NEAR(summary.speed[1], 1, 1e-14);
}

TEST(Tendency2D, IsTheSpectralBuoyancyGradient) {
  const double k = 2 * pi / 3;
  SampledFlow<2> s(Grid<2>({15, 20}, {0, 0}, {3, 2}));
  s.sample([](const Point<2>&) { return std::array{0.0}; },
           [&](const Point<2>& x) { return std::sin(2 * k * x[0]) * (1 + x[1]) + x[1]; });
  FlowOptions options = unfiltered();
  options.reference_stratification.assign(21, 0.25);
  const FlowSummary summary = s.solve(options);
  EXPECT_LT(s.error(Flow::tendency, -1, 21,
                    [&](const Point<2>& x) { return 2 * k * std::cos(2 * k * x[0]) * (1 + x[1]); }),
            1e-13);
  // Centred differences of the sampled field at the node where they are largest.
  const double h = s.grid.spacing[0];
  double expected = 0;
  s.for_nodes(0, 20, [&](int i, int j, int l) {
    const Point<2> x = position(s.grid, i, j, l);
    const double b_x = std::cos(2 * k * x[0]) * std::sin(2 * k * h) / h * (1 + x[1]);
    expected = std::max(expected, std::hypot(b_x, std::sin(2 * k * x[0]) + 1.25));
  });
  EXPECT_NEAR(summary.buoyancy_gradient, expected, 1e-13);
}

}  // namespace
}  // namespace pileus::mesh::test
