// Dense column operators and the one-dimensional tools built on them.
#include "mesh/column_matrix.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <random>
#include <vector>

#include "mesh/vertical_basis.hpp"
#include "mesh/vertical_derivative.hpp"

namespace pileus::mesh {
namespace {

AlignedArray<double> random_columns(int nz, int count, unsigned seed) {
  AlignedArray<double> columns(std::size_t(count) * column_pitch(nz));
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (std::size_t i = 0; i < columns.size(); ++i) columns[i] = uniform(engine);
  return columns;
}

TEST(ColumnMatrix, EqualsTheDoubleLoopToTheBit) {
  // Contraction is off and every sum runs in column order, so that no rounding may differ.
  for (const int nz : {1, 2, 6, 7, 8, 15, 16, 31, 65})
    for (const int count : {2, 4, 6, 8}) {
      std::mt19937_64 engine(unsigned(nz * 10 + count));
      std::uniform_real_distribution<double> uniform(-1, 1);
      std::vector<double> m(std::size_t(nz + 1) * std::size_t(nz + 1));
      for (double& element : m) element = uniform(engine);
      const ColumnMatrix matrix(
          nz, [&](int row, int column) { return m[std::size_t(row * (nz + 1) + column)]; });
      const auto in = random_columns(nz, count, 5);
      AlignedArray<double> out(in.size());
      out.fill(7);
      matrix.apply(in.data(), out.data(), count);
      for (int c = 0; c < count; ++c)
        for (std::size_t row = 0; row < column_pitch(nz); ++row) {
          double expected = 0;
          if (int(row) <= nz)
            for (int k = 0; k <= nz; ++k)
              expected += m[row * std::size_t(nz + 1) + std::size_t(k)] *
                          in[std::size_t(c) * column_pitch(nz) + std::size_t(k)];
          ASSERT_EQ(out[std::size_t(c) * column_pitch(nz) + row], expected);
        }
    }
}

TEST(VerticalBasis, SineAnalysisInvertsSynthesisInside) {
  for (const int nz : {2, 5, 12, 64}) {
    const VerticalBasis basis(nz, 1.5, {});
    const auto in = random_columns(nz, 2, 3);
    AlignedArray<double> coefficients(in.size()), out(in.size());
    basis.sine_analysis().apply(in.data(), coefficients.data(), 2);
    basis.sine_synthesis().apply(coefficients.data(), out.data(), 2);
    for (std::size_t k = 1; k < std::size_t(nz); ++k) EXPECT_NEAR(out[k], in[k], 1e-14);
    EXPECT_EQ(out[0], 0);
    EXPECT_EQ(out[std::size_t(nz)], 0);
  }
}

TEST(VerticalBasis, EndFunctionsSolveTheirEquations) {
  // Against hyperbolic functions where those neither overflow nor cancel, K L = 2.6.
  const int nz = 10;
  const double K = 1.3, L = 2;
  const VerticalBasis basis(nz, L, {K * K, 4.0, K * K * (1 + 1e-15)});
  const EndFunctions f = basis.end_functions(basis.find(K * K));
  for (int k = 0; k <= nz; ++k) {
    const auto at = std::size_t(k);
    const double z = L * k / nz, sh = std::sinh(K * L), ch = std::cosh(K * L);
    EXPECT_NEAR(f.upper[at], std::sinh(K * z) / sh, 1e-15);
    EXPECT_NEAR(f.lower[at], std::sinh(K * (L - z)) / sh, 1e-15);
    // θ+ = [z cosh Kz − L coth KL sinh Kz]/(2K sinh KL) by undetermined coefficients.
    const double inverse = (z * std::cosh(K * z) - L * ch / sh * std::sinh(K * z)) / (2 * K * sh);
    const double slope =
        (std::cosh(K * z) + z * K * std::sinh(K * z) - K * L * ch / sh * std::cosh(K * z)) /
        (2 * K * sh);
    EXPECT_NEAR(f.upper_inverse[at], inverse, 1e-15);
    EXPECT_NEAR(f.upper_inverse_z[at], slope, 1e-15);
    EXPECT_NEAR(f.lower_inverse[std::size_t(nz - k)], inverse, 1e-15);
    EXPECT_NEAR(f.lower_inverse_z[std::size_t(nz - k)], -slope, 1e-15);
  }
}

TEST(VerticalBasis, SurvivesLargeAndSmallWavenumbers) {
  const VerticalBasis basis(8, 1, {1e10, 1e-8});
  const EndFunctions large = basis.end_functions(basis.find(1e10));
  EXPECT_EQ(large.lower[0], 1);
  EXPECT_EQ(large.upper[8], 1);
  EXPECT_EQ(large.lower[4], 0);
  // K → 0: θ+ → (z³ − z)/6 on [0, 1], with a correction of order K² = 1e-8.
  const EndFunctions small = basis.end_functions(basis.find(1e-8));
  for (std::size_t k = 0; k <= 8; ++k) {
    const double z = double(k) / 8;
    EXPECT_NEAR(small.upper_inverse[k], (z * z * z - z) / 6, 1e-9);
    EXPECT_NEAR(small.upper_inverse_z[k], (3 * z * z - 1) / 6, 1e-9);
  }
}

class Derivative : public ::testing::TestWithParam<VerticalDerivative> {};

TEST_P(Derivative, QuadratureUndoesItExactly) {
  for (const int nz : {1, 2, 3, 4, 5, 6, 7, 12, 33}) {
    const double dz = 0.37;
    const ColumnMatrix d = vertical_derivative(GetParam(), nz, dz);
    const std::vector<double> q = derivative_quadrature(GetParam(), nz);
    double total = 0;
    for (const double weight : q) total += weight;
    EXPECT_NEAR(total, nz, 1e-13 * nz);
    for (int column = 0; column <= nz; ++column) {
      double sum = 0;
      for (int row = 0; row <= nz; ++row) sum += q[std::size_t(row)] * dz * d(row, column);
      EXPECT_NEAR(sum, column == nz ? 1 : column == 0 ? -1 : 0, 2e-15 * (nz + 1)) << nz << column;
    }
  }
}

TEST_P(Derivative, IsExactForPolynomials) {
  // The least exact row decides: degree 1 for one-sided differences, 3 for the compact closure
  // (2 and 1 on two cells and one).
  for (const int nz : {1, 2, 3, 4, 9}) {
    const int degree = GetParam() == VerticalDerivative::centred ? 1 : std::min(nz, 3);
    const ColumnMatrix d = vertical_derivative(GetParam(), nz, 1.0 / nz);
    for (int power = 0; power <= degree; ++power)
      for (int row = 0; row <= nz; ++row) {
        const double z = double(row) / nz;
        double sum = 0;
        for (int k = 0; k <= nz; ++k) sum += d(row, k) * std::pow(double(k) / nz, power);
        EXPECT_NEAR(sum, power == 0 ? 0 : power * std::pow(z, power - 1), 1e-13) << nz << power;
      }
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, Derivative,
                         ::testing::Values(VerticalDerivative::centred,
                                           VerticalDerivative::compact));

}  // namespace
}  // namespace pileus::mesh
