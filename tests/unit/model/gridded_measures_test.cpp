// Modes, fronts and mirror images on fields that are known.
#include "model/gridded_measures.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "base/error.hpp"

namespace pileus::model {
namespace {

constexpr double pi = std::numbers::pi;

/// Nodes of a box [−π, π) × [0, π] with a field on them.
NodeField field_of(int nx, int nz, const std::function<double(double, double)>& f) {
  NodeField field;
  field.period = 2 * pi;
  field.y = {0.0};
  for (int i = 0; i < nx; ++i) field.x.push_back(-pi + 2 * pi * i / nx);
  for (int k = 0; k <= nz; ++k) field.z.push_back(pi * k / nz);
  for (const double z : field.z)
    for (const double x : field.x) field.values.push_back(f(x, z));
  return field;
}

scene::ModeControl travelling() {
  return {"wave", "z_velocity", "cos(2*x)*sin(z)", "sin(2*x)*sin(z)", {}};
}

TEST(Mode, AmplitudeAndPhaseOfAWaveAmongOthers) {
  const double phase = 0.7;
  // The mean, another wavenumber and another vertical mode are orthogonal to it on the nodes.
  const NodeField field = field_of(16, 8, [&](double x, double z) {
    return 3 * std::cos(2 * x - phase) * std::sin(z) + 5 + std::sin(3 * x) * std::sin(z) +
           std::cos(2 * x) * std::sin(2 * z);
  });
  const Mode mode(travelling(), {}, field);
  const std::vector<double> found = mode.measure(field);
  EXPECT_NEAR(found[0], 3, 1e-13);
  EXPECT_NEAR(found[1], phase, 1e-13);
}

TEST(Mode, ShapesNeedNotBeOrthogonal) {
  const NodeField field =
      field_of(16, 8, [](double x, double) { return 2 * std::cos(x) + std::cos(x - 1); });
  scene::ModeControl control{"wave", "z_velocity", "cos(x)", "cos(x - 1)", {}};
  const std::vector<double> found = Mode(control, {}, field).measure(field);
  EXPECT_NEAR(found[0], std::sqrt(5.0), 1e-13);
  EXPECT_NEAR(found[1], std::atan2(1, 2), 1e-13);
}

TEST(Mode, WallsCountHalf) {
  // Constant and cos(2z) are orthogonal under the trapezoidal rule, not under the plain sum.
  const NodeField field = field_of(4, 8, [](double, double z) { return 1 + std::cos(2 * z); });
  scene::ModeControl control{"mean", "z_velocity", "1", "", {}};
  EXPECT_NEAR(Mode(control, {}, field).measure(field)[0], 1, 1e-14);
}

TEST(Mode, RefusesShapesThatCannotBeTold) {
  const NodeField field = field_of(8, 4, [](double, double) { return 0.0; });
  // On eight nodes sin 4x vanishes at every node, and cos 4x and cos 12x are the same.
  for (const auto& [cosine, sine] : {std::pair{"0", ""}, std::pair{"sin(4*x)*0", "cos(x)"},
                                     std::pair{"cos(4*x)", "cos(12*x)"}, std::pair{"1/0", ""}}) {
    scene::ModeControl control{"wave", "z_velocity", cosine, sine, {}};
    EXPECT_THROW(Mode(control, {}, field), Error) << cosine << ", " << sine;
  }
}

TEST(Front, IsFoundBetweenNodes) {
  // A line is interpolated exactly: −|x|·10 … falls below −10 at |x| = 1, so 'above' ends there.
  const NodeField field = field_of(64, 8, [](double x, double z) { return -10 * std::abs(x) - z; });
  scene::FrontControl front{"front", "buoyancy", -10, scene::FrontControl::Side::above, {}, {}};
  EXPECT_NEAR(front_position(field, front), 1.0, 1e-14);
  front.height = 0.3;  // between levels
  EXPECT_NEAR(front_position(field, front), 0.97, 1e-14);
}

TEST(Front, EitherSideOfTheCentreAndEitherSideOfTheThreshold) {
  const auto cold = [](double x) { return x > -2 && x < 1.5 ? -1.0 : 0.0; };
  const NodeField field = field_of(1024, 4, [&](double x, double) { return cold(x); });
  scene::FrontControl front{"front", "buoyancy", -0.5, scene::FrontControl::Side::below, {}, {}};
  EXPECT_NEAR(front_position(field, front), 2.0, 2 * pi / 1024);
  front.threshold = -2;  // nowhere that cold
  EXPECT_EQ(front_position(field, front), 0);
  front.threshold = 1;  // everywhere: the edge of the domain
  EXPECT_DOUBLE_EQ(front_position(field, front), pi);
}

TEST(Asymmetry, OfEvenOddAndOtherFields) {
  // Mirrored nodes are the negatives of each other to rounding only.
  const NodeField even = field_of(16, 4, [](double x, double z) { return std::cos(3 * x) + z; });
  const NodeField odd = field_of(16, 4, [](double x, double z) { return std::sin(3 * x) * z; });
  EXPECT_LT(asymmetry(even, false), 1e-14);
  EXPECT_LT(asymmetry(odd, true), 1e-14);
  EXPECT_NEAR(asymmetry(odd, false), 2, 1e-14);
  const NodeField shifted = field_of(16, 4, [](double x, double) { return 1 + 0.1 * std::sin(x); });
  EXPECT_NEAR(asymmetry(shifted, false), 0.2 / 1.1, 1e-14);
  EXPECT_EQ(asymmetry(field_of(8, 2, [](double, double) { return 0.0; }), true), 0);
}

}  // namespace
}  // namespace pileus::model
