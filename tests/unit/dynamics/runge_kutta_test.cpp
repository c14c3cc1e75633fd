// The low-storage tableaux: their order, on an equation that depends on time and state.
#include "dynamics/runge_kutta.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace pileus::dynamics {
namespace {

/// y' = y cos t, y(0) = 1, exact e^{sin t}: error at t = 2 after n steps.
double error_of(const LowStorageScheme& scheme, int n) {
  const double dt = 2.0 / n;
  double y = 1, k = 0;
  for (int step = 0; step < n; ++step)
    for (std::size_t s = 0; s < scheme.stages(); ++s) {
      k = scheme.a[s] * k + y * std::cos((step + scheme.c[s]) * dt);
      y += scheme.b[s] * dt * k;
    }
  return std::abs(y - std::exp(std::sin(2.0)));
}

// Acceptance 9: order 3 and 4 on a scalar ODE. The error constants of neighbouring step sizes
// differ by O(Δt), a few hundredths at 1/40.
TEST(LowStorageScheme, OrderOnAScalarEquation) {
  for (const auto* scheme : {&williamson_3(), &carpenter_kennedy_4()})
    for (const int n : {40, 80, 160}) {
      const double rate = std::log2(error_of(*scheme, n) / error_of(*scheme, 2 * n));
      EXPECT_NEAR(rate, scheme->order, 0.15) << n;
    }
}

/// Butcher form of a 2N scheme: y = y0 + Δt Σ b_j f_j, stage s at y0 + Δt Σ a_sj f_j.
struct Butcher {
  double a[5][5] = {}, b[5] = {};
  explicit Butcher(const LowStorageScheme& scheme) {
    double k[5] = {}, y[5] = {};
    for (std::size_t s = 0; s < scheme.stages(); ++s) {
      for (int j = 0; j < 5; ++j) a[s][j] = y[j];
      for (double& kj : k) kj *= scheme.a[s];
      k[s] += 1;
      for (int j = 0; j < 5; ++j) y[j] += scheme.b[s] * k[j];
    }
    for (int j = 0; j < 5; ++j) b[j] = y[j];
  }
};

// The order conditions (Hairer, Nørsett and Wanner, Solving ODEs I, table II.2.1), to the rounding
// of the rational coefficients, which are given to 1e-13 or so; and c_s = Σ_j a_sj.
TEST(LowStorageScheme, OrderConditions) {
  for (const auto* scheme : {&williamson_3(), &carpenter_kennedy_4()}) {
    const Butcher t(*scheme);
    double c[5] = {};
    for (int i = 0; i < 5; ++i)
      for (int j = 0; j < 5; ++j) c[i] += t.a[i][j];
    for (std::size_t s = 0; s < scheme->stages(); ++s) EXPECT_NEAR(c[s], scheme->c[s], 1e-12);
    double sum[8] = {};
    for (int i = 0; i < 5; ++i) {
      sum[0] += t.b[i];
      sum[1] += t.b[i] * c[i];
      sum[2] += t.b[i] * c[i] * c[i];
      sum[4] += t.b[i] * c[i] * c[i] * c[i];
      for (int j = 0; j < 5; ++j) {
        sum[3] += t.b[i] * t.a[i][j] * c[j];
        sum[5] += t.b[i] * c[i] * t.a[i][j] * c[j];
        sum[6] += t.b[i] * t.a[i][j] * c[j] * c[j];
        for (int k = 0; k < 5; ++k) sum[7] += t.b[i] * t.a[i][j] * t.a[j][k] * c[k];
      }
    }
    const double exact[8] = {1, 1.0 / 2, 1.0 / 3, 1.0 / 6, 1.0 / 4, 1.0 / 8, 1.0 / 12, 1.0 / 24};
    for (int m = 0; m < (scheme->order == 4 ? 8 : 4); ++m)
      EXPECT_NEAR(sum[m], exact[m], 1e-12) << m;
  }
}

}  // namespace
}  // namespace pileus::dynamics
