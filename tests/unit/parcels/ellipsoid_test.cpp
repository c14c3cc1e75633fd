// Principal axes and support points against Eigen's eigen-solver and the moments of the ellipsoid.
#include "parcels/ellipsoid.hpp"

#include <gtest/gtest.h>

#include "parcel_cloud.hpp"

namespace pileus {
namespace {

using namespace baseline;
using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

Symmetric3<double> symmetric(const Matrix3d& b) {
  return {b(0, 0), b(0, 1), b(0, 2), b(1, 1), b(1, 2), b(2, 2)};
}
Symmetric2<double> symmetric(const Matrix2d& b) {
  return {b(0, 0), b(0, 1), b(1, 1)};
}
Vector3d vector(const Vector3<double>& v) {
  return {v.x, v.y, v.z};
}

/// Backward stability: eigenvalues to `eps`·‖B‖, and ‖B v − λ v‖ as small, v orthonormal.
void expect_axes_of(const Matrix3d& b, double eps) {
  const auto axes = principal_axes(symmetric(b));
  const Vector3d reference = Eigen::SelfAdjointEigenSolver<Matrix3d>(b).eigenvalues();
  const double size = b.norm();
  EXPECT_NEAR(axes.a2 / size, reference(2) / size, eps) << b;
  EXPECT_NEAR(axes.b2 / size, reference(1) / size, eps) << b;
  EXPECT_NEAR(axes.c2 / size, reference(0) / size, eps) << b;
  const Vector3d major = vector(axes.major), middle = vector(axes.middle);
  EXPECT_NEAR(major.norm(), 1, 4e-15);
  EXPECT_NEAR(middle.norm(), 1, 4e-15);
  EXPECT_NEAR(major.dot(middle), 0, 4e-15);
  EXPECT_LT((b * major - axes.a2 * major).norm() / size, eps) << b;
  EXPECT_LT((b * middle - axes.b2 * middle).norm() / size, eps) << b;
}
void expect_axes_of(const Matrix2d& b, double eps) {
  const auto axes = principal_axes(symmetric(b));
  const Vector2d reference = Eigen::SelfAdjointEigenSolver<Matrix2d>(b).eigenvalues();
  const double size = b.norm();
  EXPECT_NEAR(axes.a2 / size, reference(1) / size, eps) << b;
  EXPECT_NEAR(axes.b2 / size, reference(0) / size, eps) << b;
  const Vector2d major(axes.major_x, axes.major_z);
  EXPECT_NEAR(major.norm(), 1, 4e-15);
  EXPECT_LT((b * major - axes.a2 * major).norm() / size, eps) << b;
}

// A dozen operations of relative error ½ulp, amplified by the separation of the deflated
// eigenvalue (at least √3 of the deviator's own scale): 1e-14 leaves a factor of ten.
constexpr double rounding = 1e-14;

// Reference dossier 2.3: random orthogonal × random positive spectra; EPIC accepts 1e-9.
TEST(PrincipalAxes, RandomSpectraInSpace) {
  testing::Random random(1);
  for (int draw = 0; draw < 20000; ++draw) {
    Vector3d spectrum;
    for (int i = 0; i < 3; ++i) spectrum(i) = std::exp(testing::uniform(random, -6, 6));
    expect_axes_of(testing::random_shape<3>(random, spectrum), rounding);
  }
}
TEST(PrincipalAxes, RandomSpectraInThePlane) {
  testing::Random random(2);
  for (int draw = 0; draw < 20000; ++draw) {
    const Vector2d spectrum(std::exp(testing::uniform(random, -6, 6)),
                            std::exp(testing::uniform(random, -6, 6)));
    expect_axes_of(testing::random_shape<2>(random, spectrum), rounding);
  }
}

// Nearly equal axes at every distance from equality, in every orientation.
TEST(PrincipalAxes, NearlyDegenerateSpectra) {
  testing::Random random(3);
  for (double gap = 1e-1; gap > 1e-18; gap *= 0.1)
    for (int draw = 0; draw < 200; ++draw) {
      expect_axes_of(testing::random_shape<3>(random, Vector3d(2, 2 - gap, 1)), rounding);
      expect_axes_of(testing::random_shape<3>(random, Vector3d(2, 1 + gap, 1)), rounding);
      expect_axes_of(testing::random_shape<3>(random, Vector3d(1 + gap, 1 + 0.3 * gap, 1)),
                     rounding);
      expect_axes_of(testing::random_shape<2>(random, Vector2d(1 + gap, 1)), rounding);
    }
}

TEST(PrincipalAxes, ExactlyDegenerateSpectra) {
  for (const Vector3d& d : {Vector3d(2, 2, 1), Vector3d(2, 1, 1), Vector3d(1, 2, 2),
                            Vector3d(1, 2, 1), Vector3d(1, 1, 2), Vector3d(2, 1, 2)})
    expect_axes_of(Matrix3d(d.asDiagonal()), 1e-15);
}

// Dossier 2.3: spheres, "vectors only orthonormal". A sphere collapses to its centre (3.1): to the
// square root of rounding, as the offsets are square roots of differences.
TEST(PrincipalAxes, SpheresAndCircles) {
  for (const double r2 : {1e-24, 0.3, 1.0, 7.0, 1e24}) {
    expect_axes_of(Matrix3d(r2 * Matrix3d::Identity()), 1e-15);
    expect_axes_of(Matrix2d(r2 * Matrix2d::Identity()), 1e-15);
    const auto o = support_offsets(symmetric(Matrix3d(r2 * Matrix3d::Identity())));
    for (const double x : {o.first.x, o.first.y, o.first.z, o.second.x, o.second.y, o.second.z})
      EXPECT_LT(std::abs(x), 4e-8 * std::sqrt(r2));
    const auto plane = support_offsets(symmetric(Matrix2d(r2 * Matrix2d::Identity())));
    EXPECT_EQ(plane.x, 0);
    EXPECT_EQ(plane.z, 0);
  }
}

// The peers' indefinite matrix [[0,0,1],[0,0,0],[1,0,0]] with eigenvalues 1, 0, −1, shifted by two
// to be a shape: 3, 2, 1 to the 1e-15 they ask for.
TEST(PrincipalAxes, ShiftedAntidiagonalMatrix) {
  Matrix3d b = 2 * Matrix3d::Identity();
  b(0, 2) = b(2, 0) = 1;
  const auto axes = principal_axes(symmetric(b));
  EXPECT_NEAR(axes.a2, 3, 3e-15);
  EXPECT_NEAR(axes.b2, 2, 3e-15);
  EXPECT_NEAR(axes.c2, 1, 3e-15);
}

// Dossier, acceptance 2: scaled by 1e±12 in length "must still pass"; powers of two bitwise.
TEST(PrincipalAxes, UnitsOfLengthDoNotMatter) {
  testing::Random random(4);
  for (int draw = 0; draw < 1000; ++draw) {
    const Matrix3d b =
        testing::random_shape<3>(random, Vector3d(testing::uniform(random, 0.1, 4), 1, 0.2));
    for (const double length2 : {1e24, 1e-24, 1e100, 1e-100})
      expect_axes_of(Matrix3d(length2 * b), rounding);
    const auto here = principal_axes(symmetric(b)),
               there = principal_axes(symmetric(Matrix3d(0x1p-80 * b)));
    EXPECT_EQ(0x1p-80 * here.a2, there.a2);
    EXPECT_EQ(0x1p-80 * here.c2, there.c2);
    EXPECT_EQ(here.major.x, there.major.x);
    EXPECT_EQ(here.middle.z, there.middle.z);
    const Matrix2d plane = testing::random_shape<2>(random, Vector2d(3, 0.4));
    for (const double length2 : {1e24, 1e-24, 1e100, 1e-100})
      expect_axes_of(Matrix2d(length2 * plane), rounding);
  }
}

// Dossier A.1: the angle of the major axis is the angle put in, modulo π, at 1e-13.
TEST(PrincipalAxes, OrientationOfAnEllipse) {
  for (int degree = 0; degree <= 360; ++degree) {
    const double angle = degree * std::numbers::pi / 180, c = std::cos(angle), s = std::sin(angle);
    const double a2 = 5, b2 = 0.2;
    const auto axes = principal_axes(
        Symmetric2<double>{a2 * c * c + b2 * s * s, (a2 - b2) * s * c, a2 * s * s + b2 * c * c});
    EXPECT_NEAR(axes.major_x * s - axes.major_z * c, 0, 1e-15) << degree;
  }
}

// Eight parcels in a vector are eight parcels one by one: a parcel's result must not depend on its
// neighbours in memory. The test is compiled for the baseline, without contraction.
TEST(PrincipalAxes, PacksEqualScalarsBitwise) {
  testing::Random random(5);
  for (int draw = 0; draw < 2000; ++draw) {
    double component[6][lanes];
    for (int lane = 0; lane < lanes; ++lane) {
      Vector3d spectrum(1, 1, 1);
      if (lane > 0)
        for (int i = 0; i < 3; ++i) spectrum(i) = std::exp(testing::uniform(random, -2, 2));
      const Matrix3d b = testing::random_shape<3>(random, spectrum);
      const double values[6] = {b(0, 0), b(0, 1), b(0, 2), b(1, 1), b(1, 2), b(2, 2)};
      for (int c = 0; c < 6; ++c) component[c][lane] = values[c];
    }
    const auto pack = principal_axes(Symmetric3<Pack>{load(component[0]), load(component[1]),
                                                      load(component[2]), load(component[3]),
                                                      load(component[4]), load(component[5])});
    const auto pack2 = principal_axes(
        Symmetric2<Pack>{load(component[0]), load(component[1]), load(component[3])});
    for (int lane = 0; lane < lanes; ++lane) {
      const auto one = principal_axes(Symmetric3<double>{component[0][lane], component[1][lane],
                                                         component[2][lane], component[3][lane],
                                                         component[4][lane], component[5][lane]});
      EXPECT_EQ(pack.a2[lane], one.a2);
      EXPECT_EQ(pack.b2[lane], one.b2);
      EXPECT_EQ(pack.c2[lane], one.c2);
      EXPECT_EQ(pack.major.x[lane], one.major.x);
      EXPECT_EQ(pack.major.z[lane], one.major.z);
      EXPECT_EQ(pack.middle.y[lane], one.middle.y);
      const auto flat = principal_axes(
          Symmetric2<double>{component[0][lane], component[1][lane], component[3][lane]});
      EXPECT_EQ(pack2.a2[lane], flat.a2);
      EXPECT_EQ(pack2.major_x[lane], flat.major_x);
      EXPECT_EQ(pack2.major_z[lane], flat.major_z);
    }
  }
}

// Dossier 3.1: the four points reproduce the second moment B/5 less the isotropic part c²/5, the
// two points B/4 less b²/4, at 1e-14; the offsets come in ± pairs, so first moments vanish exactly.
TEST(SupportPoints, SecondMoments) {
  testing::Random random(6);
  for (int draw = 0; draw < 5000; ++draw) {
    Vector3d spectrum;
    for (int i = 0; i < 3; ++i) spectrum(i) = std::exp(testing::uniform(random, -2, 2));
    const Matrix3d b = testing::random_shape<3>(random, spectrum);
    const auto o = support_offsets(symmetric(b));
    const Vector3d first = vector(o.first), second = vector(o.second);
    const Matrix3d moment = 0.5 * (first * first.transpose() + second * second.transpose());
    const Matrix3d exact = (b - spectrum.minCoeff() * Matrix3d::Identity()) / 5;
    EXPECT_LT((moment - exact).norm(), 1e-14 * b.norm()) << b;

    const Vector2d flat_spectrum = spectrum.head<2>();
    const Matrix2d flat = testing::random_shape<2>(random, flat_spectrum);
    const auto f = support_offsets(symmetric(flat));
    const Vector2d offset(f.x, f.z);
    EXPECT_LT(
        (offset * offset.transpose() - (flat - flat_spectrum.minCoeff() * Matrix2d::Identity()) / 4)
            .norm(),
        1e-14 * flat.norm());
  }
}

// The corners of a rectangle with sides along the two longer axes (dossier 3.1, θ = π/4, …): the
// sum and the difference of the offsets are parallel to them.
TEST(SupportPoints, AreCornersOfARectangleInThePlaneOfTheLongAxes) {
  testing::Random random(7);
  for (int draw = 0; draw < 1000; ++draw) {
    const auto b = testing::random_shape<3>(random, Vector3d(5, 2.5, 1));
    const auto o = support_offsets(symmetric(b));
    const Vector3d eta = 0.5 * (vector(o.first) + vector(o.second)),
                   tau = 0.5 * (vector(o.first) - vector(o.second));
    EXPECT_LT((b * eta - 5 * eta).norm(), 1e-13);
    EXPECT_LT((b * tau - 2.5 * tau).norm(), 1e-13);
    EXPECT_NEAR(eta.squaredNorm(), (5.0 - 1.0) / 5, 1e-14);
    EXPECT_NEAR(tau.squaredNorm(), (2.5 - 1.0) / 5, 1e-14);
  }
}

TEST(Determinant, IsTheProductOfTheSquaredAxes) {
  testing::Random random(8);
  for (int draw = 0; draw < 1000; ++draw) {
    const Vector3d spectrum(testing::uniform(random, 0.5, 4), 1, testing::uniform(random, 0.5, 4));
    const auto b = testing::random_shape<3>(random, spectrum);
    EXPECT_NEAR(determinant(symmetric(b)), spectrum.prod(), 1e-14 * std::pow(b.norm(), 3));
    const Vector2d flat(spectrum(0), spectrum(2));
    EXPECT_NEAR(determinant(symmetric(testing::random_shape<2>(random, flat))), flat.prod(),
                1e-14 * 16);
  }
}

}  // namespace
}  // namespace pileus
