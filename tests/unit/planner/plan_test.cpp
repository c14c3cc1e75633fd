// Verdicts and what they rest on.
#include "planner/plan.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"
#include "moist_operator.hpp"
#include "planner/plan_text.hpp"

namespace pileus::planner {
namespace {

using test::load;
using test::plan_of;
using test::wet_scene;

// In a box of 2 km saturation at the lid is 0.015 e^-2 = 0.0020300; the wettest air has 0.005.
TEST(Plan, switches_condensation_on_when_the_lid_saturates_the_wettest_air) {
  const test::Loaded moist = load<test::MoistAir>();
  const Plan plan = plan_of(wet_scene(), {&moist});
  const EffectPlan& effect = *plan.find("condensation");
  EXPECT_EQ(effect.verdict, Verdict::on);
  ASSERT_TRUE(effect.number.has_value());
  EXPECT_NEAR(*effect.number, 0.005 / (0.015 * std::exp(-2.0)), 1e-12);
  EXPECT_EQ(plan.operators.front().on, (std::vector<std::string>{"condensation", "buoyancy"}));
}

// Saturation at the lid is 0.03 e^-2 = 0.00406 < 0.005 there, 0.04 e^-2 = 0.005413 > 0.005.
TEST(Plan, leaves_condensation_out_by_bound_and_says_what_would_change_that) {
  test::Loaded moist = load<test::MoistAir>();
  moist.values.set_number(moist.table->find_parameter("surface_humidity"), 0.04);
  const Plan plan = plan_of(wet_scene(), {&moist});
  const EffectPlan& effect = *plan.find("condensation");
  EXPECT_EQ(effect.verdict, Verdict::off);
  EXPECT_EQ(effect.evidence, Evidence::bound);
  EXPECT_TRUE(plan.operators.front().present) << "buoyancy still needs it";
  EXPECT_EQ(plan.operators.front().off, std::vector<std::string>{"condensation"});
  ASSERT_FALSE(effect.flips.empty());
  for (const Flip& flip : effect.flips) {
    if (flip.what == "height of the lid (m)") {
      EXPECT_NEAR(flip.to, 1000 * std::log(0.04 / 0.005), 1e-6);
    } else if (flip.what == "highest initial total_water_mass_fraction") {
      EXPECT_NEAR(flip.to, 0.04 * std::exp(-2.0), 1e-12);
    }
  }
  const std::string why = explain_effect(plan, effect);
  EXPECT_NE(why.find("schemas/effects.yaml"), std::string::npos);
  EXPECT_NE(why.find("wet.yaml:4"), std::string::npos) << why;
}

TEST(Plan, only_watches_what_another_operator_may_take_out_of_bounds) {
  test::Loaded moist = load<test::MoistAir>();
  moist.values.set_number(moist.table->find_parameter("surface_humidity"), 0.04);
  const test::Loaded source = load<test::WaterSource>();
  const Plan plan = plan_of(wet_scene(), {&moist, &source});
  const EffectPlan& effect = *plan.find("condensation");
  EXPECT_EQ(effect.verdict, Verdict::watch);
  EXPECT_EQ(effect.evidence, Evidence::estimate);
  EXPECT_EQ(plan.find("irrigation")->verdict, Verdict::on);
}

TEST(Plan, calls_for_what_the_scene_wants_to_see) {
  test::Loaded moist = load<test::MoistAir>();
  moist.values.set_number(moist.table->find_parameter("surface_humidity"), 0.04);
  for (const char* wish :
       {"expect: [{diagnostic: cloud_fraction, at_most: 0}]\n",
        "output: {fields: {variables: [mass_fraction_of_cloud_liquid_water_in_air]}}\n"}) {
    const Plan plan = plan_of(wet_scene(wish), {&moist});
    EXPECT_EQ(plan.find("condensation")->verdict, Verdict::on) << wish;
  }
}

TEST(Plan, obeys_the_scene_and_says_when_that_is_against_the_rules) {
  const test::Loaded moist = load<test::MoistAir>();
  const Plan off = plan_of(wet_scene("effects: {condensation: off}\n"), {&moist});
  EXPECT_EQ(off.find("condensation")->verdict, Verdict::off);
  EXPECT_TRUE(off.find("condensation")->against_evidence);
  const Plan watch =
      plan_of(wet_scene("effects: {condensation: {mode: watch, on_trip: stop}}\n"), {&moist});
  EXPECT_EQ(watch.find("condensation")->verdict, Verdict::watch);
  EXPECT_TRUE(watch.find("condensation")->stop_on_trip);
  const Plan list = plan_of(wet_scene("effects: []\n"), {&moist});
  EXPECT_EQ(list.find("condensation")->verdict, Verdict::off);
  EXPECT_EQ(list.find("buoyancy")->verdict, Verdict::on) << "no run can be without it";
}

TEST(Plan, refuses_effects_nobody_knows_or_provides) {
  const test::Loaded moist = load<test::MoistAir>();
  const auto complaint = [&](const char* text) -> std::string {
    try {
      plan_of(wet_scene(text), {&moist});
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  };
  EXPECT_NE(complaint("effects: {condensatoin: on}\n").find("did you mean 'condensation'"),
            std::string::npos);
  EXPECT_NE(complaint("effects: {sedimentation: on}\n").find("no operator of the scene provides"),
            std::string::npos);
}

TEST(Plan, of_dry_air_has_no_condensation_and_nothing_that_needs_it) {
  scene::Problems problems;
  const scene::Scene dry = scene::read_scene_text(
      "dry.yaml", "domain: {extent: [1 m, 1 m], cells: [2, 2]}\ntime: {end: 1 s}\n", {}, problems);
  const Plan plan = plan_of(dry, {});
  for (const char* name : {"condensation", "sedimentation", "freezing"}) {
    EXPECT_EQ(plan.find(name)->verdict, Verdict::off) << name;
    EXPECT_EQ(plan.find(name)->evidence, Evidence::exact) << name;
  }
}

TEST(Plan, finds_the_differences_of_two) {
  const test::Loaded moist = load<test::MoistAir>();
  const Plan on = plan_of(wet_scene(), {&moist});
  const Plan off = plan_of(wet_scene("effects: {condensation: off}\n"), {&moist});
  EXPECT_NE(compare_plans(on, off).find("condensation"), std::string::npos);
  EXPECT_NE(compare_plans(on, on).find("the same"), std::string::npos);
}

}  // namespace
}  // namespace pileus::planner
