// Stochastic stretching against the exact moments of the Batchelor–Kraichnan flow. With n samples
// of a quantity of standard deviation s the mean is tested to 4 s/√n; biases of the time step are
// bounded beside each test.
#include <gtest/gtest.h>
#include <omp.h>

#include <Eigen/Dense>
#include <cmath>

#include "../../../plugins/stochastic_stretching/stretching.hpp"
#include "../../unit/coupling/sampled_mesh.hpp"
#include "pileus/normal.hpp"

namespace pileus::testing {
namespace {

template <int D>
using Square = Eigen::Matrix<double, D, D>;

template <int D>
Square<D> as_eigen(const Matrix<D>& a) {
  return Eigen::Map<const Eigen::Matrix<double, D, D, Eigen::RowMajor>>(a.data());
}

struct Mean {
  double sum = 0, squares = 0;
  int count = 0;
  void add(double x) { sum += x, squares += x * x, ++count; }
  double value() const { return sum / count; }
  double error() const { return std::sqrt((squares / count - value() * value()) / count); }
};

void draw(std::uint64_t sample, std::uint64_t step, std::uint32_t n, double* out) {
  pileus_step at{};
  at.seed = 5;
  at.number = step;
  draw_normal(at, sample, 0, n, out);
}

// ---- the random gradient -------------------------------------------------------------------

/// ⟨G_ij G_kl⟩ = D[(d+1) δ_ik δ_jl − δ_ij δ_kl − δ_il δ_jk]; no trace.
template <int D>
void expect_isotropic_gradient() {
  constexpr int n = 40000;
  constexpr double intensity = 0.1;
  std::array<Mean, D * D * D * D> moments;
  Mean magnitude;                 // G:G
  std::array<Mean, D * D> twice;  // G²
  for (int sample = 0; sample < n; ++sample) {
    double normal[D * D];
    draw(static_cast<std::uint64_t>(sample), 0, D * D, normal);
    const auto g = stretching::random_gradient<D>(intensity, normal);
    double trace = 0;
    for (int i = 0; i < D; ++i) trace += g[i * D + i];
    EXPECT_NEAR(trace, 0.0, 1e-14);
    for (int a = 0; a < D * D; ++a)
      for (int b = 0; b < D * D; ++b) moments[a * D * D + b].add(g[a] * g[b]);
    double square = 0;
    for (const double x : g) square += x * x;
    magnitude.add(square);
    const Matrix<D> second = product<D>(g, g);
    for (std::size_t a = 0; a < D * D; ++a) twice[a].add(second[a]);
  }
  // ⟨G:G⟩ = D d(d+2)(d−1), 8D in the plane and 30D in space; ⟨G²⟩ = 0, so that the Itô and the
  // Stratonovich equation of the deformation are the same.
  EXPECT_NEAR(magnitude.value(), (D == 2 ? 8 : 30) * intensity, 4 * magnitude.error());
  for (const Mean& m : twice) EXPECT_NEAR(m.value(), 0, 4.5 * m.error());
  for (int a = 0; a < D * D; ++a)
    for (int b = 0; b < D * D; ++b) {
      const int i = a / D, j = a % D, k = b / D, l = b % D;
      const double expected =
          intensity * ((D + 1) * (i == k) * (j == l) - (i == j) * (k == l) - (i == l) * (j == k));
      const Mean& m = moments[a * D * D + b];
      EXPECT_NEAR(m.value(), expected, 4.5 * m.error() + 1e-15) << i << j << k << l;
    }
}
TEST(Stretching, GradientIsIsotropicAndIncompressible) {
  expect_isotropic_gradient<2>();
  expect_isotropic_gradient<3>();
}

TEST(Stretching, ExponentialOfATracelessMatrixHasDeterminantOne) {
  Random random(21);
  for (int n = 0; n < 1000; ++n) {
    Matrix<3> a;
    for (double& x : a) x = uniform(random, -2, 2);
    a[8] = -a[0] - a[4];
    const auto e = exponential<3>(a), inverse = exponential<3>([&] {
                                        auto minus = a;
                                        for (double& x : minus) x = -x;
                                        return minus;
                                      }());
    const double size = as_eigen<3>(e).norm() * as_eigen<3>(inverse).norm();
    EXPECT_NEAR(determinant(e), 1.0, 1e-14 * size * size);
    EXPECT_LT((as_eigen<3>(e) * as_eigen<3>(inverse) - Square<3>::Identity()).norm(), 1e-13 * size);
  }
}

// ---- the stochastic differential equation ---------------------------------------------------

/// ⟨tr B(t)⟩ = tr B(0) exp(D(d+2)(d−1)t): with D = 0.1, t = 1 that is 1.4918 in the plane and
/// 2.7183 in space; det B stays to 2e-12 and the rounding of its evaluation; the traceless part of
/// ⟨B⟩ decays as exp(−2Dt), for d⟨B⟩/dt = D[(d+1) tr⟨B⟩ I − 2⟨B⟩]. The scheme's weak error is of
/// the order of D dt (d+2)(d−1) = 0.02 of the exponent's increment per step, below 1 % of the mean.
template <int D>
void expect_moments() {
  constexpr int n = 40000, steps = 50;
  constexpr double intensity = 0.1, dt = 0.02;
  Mean trace, anisotropy;
  for (int sample = 0; sample < n; ++sample) {
    Matrix<D> b{};
    for (int i = 0; i < D; ++i) b[i * D + i] = i == 0 ? 2.0 : 1.0;
    const double before = determinant(b);
    for (int step = 0; step < steps; ++step) {
      double normal[D * D];
      draw(static_cast<std::uint64_t>(sample), static_cast<std::uint64_t>(step), D * D, normal);
      b = stretching::stretched<D>(b, intensity, dt, normal);
    }
    const Square<D> m = as_eigen<D>(b);
    // The determinant itself is only known to the rounding of its products, each below (tr B)^d.
    const double rounding = 16 * 2.2e-16 * std::pow(m.trace(), D) / before;
    EXPECT_NEAR(determinant(b) / before, 1.0, 2e-12 + rounding);
    trace.add(m.trace());
    anisotropy.add(m(0, 0) - m(1, 1));
    EXPECT_EQ(m.llt().info(), Eigen::Success);
  }
  const double growth = std::exp(intensity * (D + 2) * (D - 1) * dt * steps);
  EXPECT_NEAR(trace.value(), (D + 1) * growth, 4 * trace.error() + 0.01 * (D + 1) * growth);
  const double decay = std::exp(-2 * intensity * dt * steps);
  EXPECT_NEAR(anisotropy.value(), decay, 4 * anisotropy.error() + 0.005);
}
TEST(Stretching, MeanTraceGrowsAndAnisotropyDecaysAtTheTheoreticalRates) {
  expect_moments<2>();
  expect_moments<3>();
}

/// Lyapunov exponents λ_i = D d(d − 2i + 1)/2: ±D in the plane; 3D, 0, −3D in space. ⟨½ ln of the
/// eigenvalues of F Fᵀ⟩/t approaches them as 1/t: after t = 40/D the remainder is below 0.05 D d.
template <int D>
void expect_lyapunov_exponents() {
  constexpr int n = 400;
  constexpr double intensity = 0.1, dt = 0.05, end = 100;
  std::array<Mean, D> exponent;
  for (int sample = 0; sample < n; ++sample) {
    // Eigenvalues of B spread over too many decades: accumulate a triangular decomposition of F.
    Square<D> q = Square<D>::Identity();
    std::array<double, D> logarithm{};
    for (int step = 0; step < static_cast<int>(end / dt); ++step) {
      double normal[D * D];
      draw(static_cast<std::uint64_t>(sample), static_cast<std::uint64_t>(step), D * D, normal);
      auto g = stretching::random_gradient<D>(intensity, normal);
      for (double& x : g) x *= std::sqrt(dt);
      const Eigen::HouseholderQR<Square<D>> qr(as_eigen<D>(exponential<D>(g)) * q);
      q = qr.householderQ();
      for (int i = 0; i < D; ++i) logarithm[i] += std::log(std::abs(qr.matrixQR()(i, i)));
    }
    for (int i = 0; i < D; ++i) exponent[i].add(logarithm[i] / end);
  }
  for (int i = 0; i < D; ++i) {
    const double theory = intensity * D * (D - 2 * (i + 1) + 1) / 2.0;
    EXPECT_NEAR(exponent[i].value(), theory, 4 * exponent[i].error() + 0.02 * intensity) << i;
  }
}
TEST(Stretching, LyapunovExponents) {
  expect_lyapunov_exponents<2>();
  expect_lyapunov_exponents<3>();
}

/// Increments of variance dt: the moments do not depend on the step, to the scheme's order.
TEST(Stretching, DoesNotDependOnTheTimeStep) {
  const auto mean_trace = [](int steps) {
    Mean trace;
    for (int sample = 0; sample < 20000; ++sample) {
      Matrix<2> b{1, 0, 0, 1};
      for (int step = 0; step < steps; ++step) {
        double normal[4];
        draw(static_cast<std::uint64_t>(sample), static_cast<std::uint64_t>(step), 4, normal);
        b = stretching::stretched<2>(b, 0.1, 1.0 / steps, normal);
      }
      trace.add(b[0] + b[3]);
    }
    return trace;
  };
  const Mean coarse = mean_trace(10), fine = mean_trace(80);
  EXPECT_NEAR(coarse.value(), fine.value(), 4 * (coarse.error() + fine.error()) + 0.03);
}

// ---- the plugin -----------------------------------------------------------------------------

template <int D>
void expect_plugin_stretches(const mesh::Grid<D>& grid) {
  MeshRun<D> run(grid, "org.pileus.stochastic_stretching", {{"coefficient", "2"}}, {},
                 [](std::string_view, std::size_t) { return 0.5; });
  run.fill(4000, 1.0, 22);
  run.bind();
  Mean before, after;
  for (std::size_t p = 0; p < run.store.size(); ++p)
    before.add(get_shape<D>(run.store, p).trace() / std::pow(run.store.volume()[p], 2.0 / D));
  for (std::uint64_t step = 0; step < 10; ++step) run.step(0.1, step);
  for (std::size_t p = 0; p < run.store.size(); ++p) {
    const auto b = get_shape<D>(run.store, p);
    after.add(b.trace() / std::pow(run.store.volume()[p], 2.0 / D));
    EXPECT_NEAR(b.determinant() / squared_axes_product<D>(run.store.volume()[p]), 1.0, 1e-11);
    EXPECT_EQ(b.llt().info(), Eigen::Success);
  }
  // D = c|S|/(d(d+2)(d−1)), so ln⟨tr B⟩ grows at D(d+2)(d−1) = c|S|/d. Ten steps of 0.1/d.
  EXPECT_NEAR(after.value() / before.value(), std::exp(2.0 * 0.5 / D),
              4 * after.error() / before.value() + 0.02);
}
TEST(Stretching, PluginFollowsTheStrainOfTheMesh) {
  expect_plugin_stretches<2>(mesh::Grid<2>({10, 10}, {0, 0}, {1, 1}));
  expect_plugin_stretches<3>(mesh::Grid<3>({8, 8, 8}, {0, 0, 0}, {1, 1, 1}));
}

TEST(Stretching, SameBitsForAnyNumberOfThreads) {
  const int before = omp_get_max_threads();
  std::vector<double> first;
  for (const int threads : {1, 2, 3}) {
    omp_set_num_threads(threads);
    MeshRun<3> run(mesh::Grid<3>({8, 8, 8}, {0, 0, 0}, {1, 1, 1}),
                   "org.pileus.stochastic_stretching", {{"coefficient", "1"}}, {},
                   [](std::string_view, std::size_t) { return 0.5; });
    run.fill(5000, 2, 23);
    run.bind();
    for (std::uint64_t step = 0; step < 3; ++step) run.step(0.1, step);
    std::vector<double> now;
    for (int c = 0; c < 6; ++c)
      now.insert(now.end(), run.store.shape(c), run.store.shape(c) + run.store.size());
    if (first.empty()) first = now;
    EXPECT_EQ(first, now) << threads << " threads";
  }
  omp_set_num_threads(before);
}

}  // namespace
}  // namespace pileus::testing
