// The section 'flow': what it means, what is wrong with it, and that it survives being resolved.
#include <gtest/gtest.h>

#include "scene_text.hpp"

namespace pileus::scene {
namespace {

const std::string plane = "domain: {extent: [2 km, 1 km], cells: [16, 8]}\ntime: {end: 1}\n";

void expect_problem(const std::string& text, const std::string& phrase) {
  const std::string found = problems_of(text);
  EXPECT_NE(found.find(phrase), std::string::npos) << found;
}

TEST(Flow, IsThatOfTheParcelsUnlessItIsPrescribed) {
  EXPECT_FALSE(scene_of(cube).flow.prescribed);
  EXPECT_FALSE(scene_of(cube + "flow: {}\n").flow.prescribed);
  EXPECT_EQ(scene_of(cube).resolved_yaml.find("flow:"), std::string::npos);
}

TEST(Flow, TakesFormulasOfTimeVelocitiesAndNothing) {
  const Scene scene = scene_of("constants: {w_1: 2 m/s}\n" + cube +
                               "flow: {prescribed: {x: 36 km/h, z: 'w_1*sin(pi*t/600)'}}\n");
  EXPECT_TRUE(scene.flow.prescribed);
  EXPECT_EQ(scene.flow.x.formula, "10");
  EXPECT_EQ(scene.flow.y.formula, "0");
  EXPECT_EQ(scene.flow.z.formula, "w_1*sin(pi*t/600)");
  EXPECT_TRUE(scene_of(cube + "flow: {prescribed: {}}\n").flow.prescribed);
}

TEST(Flow, SurvivesBeingResolved) {
  const Scene scene = scene_of(plane + "flow: {prescribed: {x: -3, z: 'x*t'}}\n");
  const Scene again = scene_of(scene.resolved_yaml);
  EXPECT_TRUE(again.flow.prescribed);
  EXPECT_EQ(again.flow.x.formula, "-3");
  EXPECT_EQ(again.flow.z.formula, "x*t");
  EXPECT_EQ(again.resolved_yaml, scene.resolved_yaml);
}

TEST(Flow, MistakesArePointedAt) {
  expect_problem(plane + "flow: {prescribed: {z: 'sin(tt)'}}\n",
                 "scene.yaml:3:29: error: unknown name 'tt' in the formula");
  expect_problem(plane + "flow: {prescribed: {y: 1}}\n",
                 "a two-dimensional scene has no direction y");
  expect_problem(plane + "flow: {prescribed: {w: 1}}\n", "unknown key 'w' in 'flow.prescribed'");
  expect_problem(plane + "flow: {prescribed: {z: [1, 2]}}\n", "expects a velocity or a formula");
  expect_problem(plane + "flow: {prescribed: {z: 2 kg}}\n", "scene.yaml:3:");
  expect_problem(plane + "flow: {prescribed: {z: 1}}\ninitial: {mean_wind: 2 m/s}\n",
                 "'initial.mean_wind' has no effect when the flow is prescribed");
  expect_problem(plane + "flow: {prescribed: {z: 1}}\ninitial: {velocity: ['z', '0']}\n",
                 "'initial.velocity' has no effect when the flow is prescribed");
}

}  // namespace
}  // namespace pileus::scene
