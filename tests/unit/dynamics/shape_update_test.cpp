// Matrix exponential, its Taylor polynomial and the deformation of shapes.
#include "dynamics/shape_update.hpp"

#include <gtest/gtest.h>

#include <unsupported/Eigen/MatrixFunctions>

#include "../parcels/parcel_cloud.hpp"

namespace pileus {
namespace {

using namespace baseline;
using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Long3 = Eigen::Matrix<long double, 3, 3>;

Matrix3<double> matrix(const Matrix3d& m) {
  return {m(0, 0), m(0, 1), m(0, 2), m(1, 0), m(1, 1), m(1, 2), m(2, 0), m(2, 1), m(2, 2)};
}
Matrix3d eigen(const Matrix3<double>& m) {
  Matrix3d e;
  e << m.xx, m.xy, m.xz, m.yx, m.yy, m.yz, m.zx, m.zy, m.zz;
  return e;
}
Matrix2d eigen(const Matrix2<double>& m) {
  Matrix2d e;
  e << m.xx, m.xz, m.zx, m.zz;
  return e;
}
Symmetric3<double> symmetric(const Matrix3d& b) {
  return {b(0, 0), b(0, 1), b(0, 2), b(1, 1), b(1, 2), b(2, 2)};
}
Matrix3d eigen(const Symmetric3<double>& b) {
  Matrix3d e;
  e << b.xx, b.xy, b.xz, b.xy, b.yy, b.yz, b.xz, b.yz, b.zz;
  return e;
}
Matrix2d eigen(const Symmetric2<double>& b) {
  Matrix2d e;
  e << b.xx, b.xz, b.xz, b.zz;
  return e;
}

/// Σ A^j/j! in extended precision for small ‖A‖, then squared: independent of any rational form.
Matrix3d reference_exponential(const Matrix3d& a) {
  int squarings = 0;
  for (double norm = a.norm(); norm > 0.5; norm *= 0.5) ++squarings;
  const Long3 x = a.cast<long double>() * std::ldexp(1.0L, -squarings);
  Long3 sum = Long3::Identity(), term = Long3::Identity();
  for (int j = 1; j < 30; ++j) {
    term = term * x / static_cast<long double>(j);
    sum += term;
  }
  for (int i = 0; i < squarings; ++i) sum = (sum * sum).eval();
  return sum.cast<double>();
}

Matrix3d random_traceless(testing::Random& random, double norm) {
  Matrix3d a;
  for (int i = 0; i < 9; ++i) a(i / 3, i % 3) = testing::uniform(random, -1, 1);
  a -= a.trace() / 3 * Matrix3d::Identity();
  return a * (norm / a.norm());
}

TEST(ReferenceExponential, AgreesWithThePadeApproximantOfEigen) {
  testing::Random random(101);
  for (const double norm : {1e-3, 0.3, 4.0, 20.0}) {
    const Matrix3d a = random_traceless(random, norm), e = reference_exponential(a);
    EXPECT_LT((e - a.exp()).norm(), 1e-13 * (1 + norm) * e.norm());
  }
}

// Dossier 6.3, acceptance 10: relative error below 1e-14 for ‖A‖ ≤ 0.1 without scaling, truncation
// ‖A‖⁹/9! per evaluation: 5e-11 at 0.3, 3e-15 at 0.1, 3e-6 at 1.
TEST(Taylor8, TruncationError) {
  testing::Random random(102);
  for (const double norm : {1e-8, 0.01, 0.1, 0.3, 1.0})
    for (int draw = 0; draw < 500; ++draw) {
      const Matrix3d a = random_traceless(random, norm), e = reference_exponential(a);
      // Remainder of the series: ‖A‖⁹/9!·(1 + ‖A‖/10 + …), and some ten roundings.
      const double bound = std::pow(norm, 9) / 362880 * 1.12 + 3e-15;
      EXPECT_LT((eigen(taylor8(matrix(a))) - e).norm(), bound) << norm;
      if (norm <= 0.1) {
        EXPECT_LT((eigen(taylor8(matrix(a))) - e).norm() / e.norm(), 1e-14);
      }
    }
}

// The coefficients, by the polynomial of a nilpotent matrix: A³ = 0 leaves I + A + A²/2 exactly up
// to the rounding of the coefficients.
TEST(Taylor8, NilpotentMatrix) {
  Matrix3d a = Matrix3d::Zero();
  a(0, 1) = 3;
  a(1, 2) = 5;
  a(0, 2) = 7;
  const Matrix3d exact = Matrix3d::Identity() + a + 0.5 * a * a;
  EXPECT_LT((eigen(taylor8(matrix(a))) - exact).norm(), 1e-14);
  EXPECT_LT((eigen(exponential(matrix(a))) - exact).norm(), 1e-13);
}

// Scaling and squaring: each of the s halvings leaves ‖A/2^s‖ ≤ 0.15 with error 0.15⁹/9! = 1.1e-13,
// which s squarings double each; relative to ‖A‖-dependent growth ‖E‖ ≤ e^‖A‖.
TEST(Exponential, AnyNorm) {
  testing::Random random(103);
  for (const double norm : {1e-8, 1e-3, 0.1499, 0.1501, 1.0, 5.0, 20.0, 50.0})
    for (int draw = 0; draw < 300; ++draw) {
      const Matrix3d a = random_traceless(random, norm), e = reference_exponential(a);
      const double squared = std::max(1.0, 2 * norm / taylor8_radius);
      const double bound = squared * (std::pow(std::min(norm, taylor8_radius), 9) / 362880 * 1.1);
      // Squaring is not backward stable for every matrix: ‖E(A/2)‖² may exceed ‖E(A)‖.
      const double growth = std::pow(reference_exponential(0.5 * a).norm(), 2);
      EXPECT_LT((eigen(exponential(matrix(a))) - e).norm(), (bound + squared * 4e-15) * growth)
          << norm;
      if (norm <= 1) {
        EXPECT_LT((eigen(exponential(matrix(a))) - e).norm() / e.norm(), 1e-10);
      }
    }
}

TEST(Exponential, ZeroAndNotANumber) {
  EXPECT_EQ(eigen(exponential(matrix(Matrix3d::Zero()))), Matrix3d::Identity());
  Matrix3d a = Matrix3d::Zero();
  a(1, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(eigen(exponential(matrix(a))).sum()));
}

TEST(Exponential, DeterminantIsOne) {
  testing::Random random(104);
  for (const double norm : {0.1, 1.0, 3.0})
    for (int draw = 0; draw < 500; ++draw) {
      const Matrix3d e = eigen(exponential(matrix(random_traceless(random, norm))));
      EXPECT_NEAR(e.determinant(), 1, 1e-11);
    }
}

// A rotation by any angle about any axis (Rodrigues).
TEST(Exponential, Rotations) {
  testing::Random random(105);
  for (const double angle : {1e-6, 0.3, 3.0, 40.0}) {
    const Matrix3d q = testing::random_rotation<3>(random);
    const Eigen::Vector3d n = q.col(0);
    Matrix3d skew;
    skew << 0, -n(2), n(1), n(2), 0, -n(0), -n(1), n(0), 0;
    const Matrix3d exact = Eigen::AngleAxisd(angle, n).toRotationMatrix();
    // ‖angle·skew‖ = √2 angle; see AnyNorm for the bound.
    EXPECT_LT((eigen(exponential(matrix(angle * skew))) - exact).norm(),
              2e-13 * std::max(1.0, 20 * angle));
  }
}

// 2×2 in closed form: cosh for stretching, cos for rotating, polynomial for shear.
TEST(Exponential, PlaneAgainstTheClosedForm) {
  testing::Random random(106);
  for (const double norm : {1e-8, 0.1, 0.7, 1.0, 5.0, 20.0, 50.0})
    for (int draw = 0; draw < 500; ++draw) {
      Matrix2d a;
      a << testing::uniform(random, -1, 1), testing::uniform(random, -1, 1),
          testing::uniform(random, -1, 1), 0;
      a(1, 1) = -a(0, 0);
      a *= norm / a.norm();
      const long double q =
          static_cast<long double>(a(0, 0)) * a(0, 0) + static_cast<long double>(a(0, 1)) * a(1, 0);
      const long double r = std::sqrt(std::abs(q));
      const long double c = q >= 0 ? std::cosh(r) : std::cos(r);
      const long double h = r < 1e-6L ? 1 + q / 6 : (q >= 0 ? std::sinh(r) : std::sin(r)) / r;
      Matrix2d exact;
      exact << static_cast<double>(c + h * a(0, 0)), static_cast<double>(h * a(0, 1)),
          static_cast<double>(h * a(1, 0)), static_cast<double>(c - h * a(0, 0));
      // Doubling cos² − 1 quadruples the absolute error, the argument growing twofold: ∝ ‖A‖².
      const Matrix2d e = eigen(exponential(Matrix2<double>{a(0, 0), a(0, 1), a(1, 0), a(1, 1)}));
      EXPECT_LT((e - exact).norm(), 2e-15 * (1 + norm * norm) * exact.norm()) << norm;
      EXPECT_NEAR(e.determinant(), 1, 4e-15 * (1 + norm * norm) * e.squaredNorm());
    }
}

TEST(Exponential, PacksEqualScalarsBitwise) {
  testing::Random random(107);
  for (int draw = 0; draw < 500; ++draw) {
    double component[9][lanes];
    for (int lane = 0; lane < lanes; ++lane) {
      const Matrix3d a = random_traceless(random, std::exp(testing::uniform(random, -9, 4)));
      for (int c = 0; c < 9; ++c) component[c][lane] = a(c / 3, c % 3);
    }
    const auto pack =
        exponential(Matrix3<Pack>{load(component[0]), load(component[1]), load(component[2]),
                                  load(component[3]), load(component[4]), load(component[5]),
                                  load(component[6]), load(component[7]), load(component[8])});
    const auto plane = exponential(Matrix2<Pack>{load(component[0]), load(component[1]),
                                                 load(component[3]), -load(component[0])});
    for (int lane = 0; lane < lanes; ++lane) {
      const auto one =
          exponential(Matrix3<double>{component[0][lane], component[1][lane], component[2][lane],
                                      component[3][lane], component[4][lane], component[5][lane],
                                      component[6][lane], component[7][lane], component[8][lane]});
      EXPECT_EQ(pack.xx[lane], one.xx);
      EXPECT_EQ(pack.yz[lane], one.yz);
      EXPECT_EQ(pack.zy[lane], one.zy);
      const auto flat = exponential(Matrix2<double>{component[0][lane], component[1][lane],
                                                    component[3][lane], -component[0][lane]});
      EXPECT_EQ(plane.xx[lane], flat.xx);
      EXPECT_EQ(plane.zx[lane], flat.zx);
    }
  }
}

TEST(ShapeRate, IsSBPlusBSTransposed) {
  testing::Random random(108);
  for (int draw = 0; draw < 200; ++draw) {
    const Matrix3d s = random_traceless(random, 2);
    const Matrix3d b = testing::random_shape<3>(random, Eigen::Vector3d(3, 1, 0.4));
    EXPECT_LT((eigen(shape_rate(matrix(s), symmetric(b))) - (s * b + b * s.transpose())).norm(),
              1e-14);
    EXPECT_LT((eigen(congruence(matrix(s), symmetric(b))) - s * b * s.transpose()).norm(), 3e-14);
    const Matrix2d s2 = s.topLeftCorner<2, 2>(), b2 = b.topLeftCorner<2, 2>();
    const Matrix2<double> m{s2(0, 0), s2(0, 1), s2(1, 0), s2(1, 1)};
    const Symmetric2<double> flat{b2(0, 0), b2(0, 1), b2(1, 1)};
    EXPECT_LT((eigen(shape_rate(m, flat)) - (s2 * b2 + b2 * s2.transpose())).norm(), 1e-14);
    EXPECT_LT((eigen(congruence(m, flat)) - s2 * b2 * s2.transpose()).norm(), 3e-14);
  }
}

// Dossier 2.4: (i) rotation B → R B Rᵀ, (ii) strain B11 e^{2st}, (iii) shear of a circle:
// a/b = e^{2 asinh(γt/2)}, λ = 4 exactly at γt = 1.5. Tolerances: acceptance 1, 1e-14 for det.
TEST(ShapeUpdate, RotationStrainAndShear) {
  const Matrix3d b = Eigen::Vector3d(4, 1, 0.25).asDiagonal();
  Matrix3d spin = Matrix3d::Zero();
  spin(0, 1) = -1;
  spin(1, 0) = 1;
  const double angle = 0.7;
  const Matrix3d r = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  EXPECT_LT(
      (eigen(congruence(exponential(matrix(angle * spin)), symmetric(b))) - r * b * r.transpose())
          .norm(),
      1e-12);
  const double s = 0.3;
  const Matrix3d strain = Eigen::Vector3d(s, -s, 0).asDiagonal();
  const Matrix3d stretched = eigen(congruence(exponential(matrix(strain)), symmetric(b)));
  EXPECT_NEAR(stretched(0, 0), 4 * std::exp(2 * s), 1e-12);
  EXPECT_NEAR(stretched(1, 1), std::exp(-2 * s), 1e-12);
  EXPECT_NEAR(stretched.determinant(), 1, 1e-12);

  for (const double shear : {0.1, 1.5, 4.0}) {
    const auto e = exponential(Matrix2<double>{0, shear, 0, 0});
    const auto sheared = congruence(e, Symmetric2<double>{1, 0, 1});
    EXPECT_NEAR(determinant(sheared), 1, 1e-14 * (1 + shear * shear));
    const auto axes = principal_axes(sheared);
    EXPECT_NEAR(std::sqrt(axes.a2 / axes.b2), std::exp(2 * std::asinh(shear / 2)),
                1e-14 * std::pow(1 + shear, 4));
  }
  const auto four = principal_axes(
      congruence(exponential(Matrix2<double>{0, 1.5, 0, 0}), Symmetric2<double>{1, 0, 1}));
  EXPECT_NEAR(std::sqrt(four.a2 / four.b2), 4, 1e-14);
}

}  // namespace
}  // namespace pileus
