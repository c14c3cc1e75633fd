// Velocities from a scene's formulas: values, gradients, times, and what is reported.
#include "model/prescribed_velocity.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "../scene/scene_text.hpp"
#include "base/error.hpp"

namespace pileus::model {
namespace {

const std::string box =
    "constants: {k: 2*pi/1000, c: 3}\n"
    "formulas: {wave: sin(k*x)*sin(pi*z/1000)}\n"
    "domain: {extent: 1 km, cells: [10, 10, 10]}\ntime: {end: 10 min}\n";
const mesh::Grid<3> grid({10, 10, 10}, {0, 0, 0}, {1000, 1000, 1000});

/// What a field gives at one point: velocity, then the gradient.
std::array<double, 11> sample(PrescribedVelocity<3>& field, std::array<double, 3> at, double time) {
  std::array<double, 11> out{};
  dynamics::FlowSamples<3> samples;
  for (std::size_t d = 0; d < 3; ++d) samples.velocity[d] = &out[d];
  for (std::size_t c = 0; c < 8; ++c) samples.gradient[c] = &out[3 + c];
  field.sample(time, 1, {&at[0], &at[1], &at[2]}, samples);
  return out;
}

PrescribedVelocity<3> field_of(const std::string& flow) {
  return PrescribedVelocity<3>(scene::scene_of(box + "flow: {prescribed: " + flow + "}\n"), grid);
}

TEST(PrescribedVelocity, EvaluatesNamedFormulasConstantsAndTime) {
  auto field = field_of("{x: 'c*wave*cos(t)', y: 2 km/h, z: 't'}");
  const auto out = sample(field, {250, 700, 500}, 1.0);
  EXPECT_DOUBLE_EQ(out[0], 3 * std::cos(1.0));
  EXPECT_DOUBLE_EQ(out[1], 2 / 3.6);
  EXPECT_EQ(out[2], 1.0);
  EXPECT_FALSE(field.steady());
  EXPECT_TRUE(field_of("{x: wave}").steady());
}

// The wave has ten spacings: (k h)⁶/140 with h = Δ/64 is 6e-15 of the derivative, and rounding
// (11/6) ε |f|/h is 1.8 · 1.1e-16/1.56 = 1.3e-16 s⁻¹ per unit of f plus that of muParser's values.
TEST(PrescribedVelocity, GradientIsThatOfTheFormula) {
  auto field = field_of("{x: 'wave*(1 + y/1000)', z: '0.5*y'}");
  const double k = 2 * M_PI / 1000, x = 123, y = 456, z = 789;
  const auto out = sample(field, {x, y, z}, 0);
  const double stretch = 1 + y / 1000, sz = std::sin(M_PI * z / 1000);
  EXPECT_NEAR(out[3], k * std::cos(k * x) * sz * stretch, 2e-15);
  EXPECT_NEAR(out[4], std::sin(k * x) * sz / 1000, 2e-15);
  EXPECT_NEAR(out[5], M_PI / 1000 * std::sin(k * x) * std::cos(M_PI * z / 1000) * stretch, 2e-15);
  EXPECT_EQ(out[6], 0);              // v_x
  EXPECT_EQ(out[9], 0);              // w_x: no x in the formula, no rounding
  EXPECT_NEAR(out[10], 0.5, 1e-13);  // w_y: 228 ε/h
}

TEST(PrescribedVelocity, DivergenceIsSeen) {
  EXPECT_LT(field_of("{x: 'sin(k*x)*cos(pi*z/1000)', z: '-2*cos(k*x)*sin(pi*z/1000)'}")
                .relative_divergence(0),
            1e-10);
  EXPECT_GT(field_of("{z: 'z/1000'}").relative_divergence(0), 0.99);
  EXPECT_EQ(field_of("{z: 'sin(t)'}").relative_divergence(1), 0);
}

TEST(PrescribedVelocity, NamesThePlaceWhereItIsNotFinite) {
  auto field = field_of("{x: 'sqrt(z - 500)'}");
  try {
    sample(field, {1, 2, 499}, 3);
    FAIL() << "a root of a negative number passed";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::numerical);
    const std::string text = error.what();
    EXPECT_NE(text.find("scene.yaml:5:"), std::string::npos) << text;
    EXPECT_NE(text.find("not a number at x = 1 m, y = 2 m, z = 499 m, t = 3 s"), std::string::npos)
        << text;
  }
}

}  // namespace
}  // namespace pileus::model
