// Verdicts for schemes that carry vapour, drops and rain apart, and what mixing means for bounds.
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "moist_operator.hpp"

namespace pileus::planner {
namespace {

using test::humid_scene;
using test::load;
using test::plan_of;

void set_choice(test::Loaded& op, const char* name, int position, const char* word) {
  op.values.set_choice(op.table->find_parameter(name), position, word);
}

test::Loaded raining_clouds() {
  test::Loaded clouds = load<test::Clouds>();
  set_choice(clouds, "collection", 1, "some");
  return clouds;
}

// By Bolton's formula the coldest air under the lid (Π = 1 − 9.81·500/(1005·300) = 0.98373, 285.3 K
// at 944.2 hPa) saturates at 0.622·1415/(94420 − 0.378·1415) = 0.00937: 0.005 is 0.53 of it.
TEST(PlanOfClouds, leaves_everything_out_where_nothing_can_saturate_by_any_formula) {
  const test::Loaded fall = load<test::Fall>();
  const char* const words[] = {"bolton", "tetens", "magnus", "buck", "murphy_koop"};
  for (int formula = 0; formula < 5; ++formula) {
    test::Loaded clouds = raining_clouds();
    set_choice(clouds, "saturation_pressure", formula, words[formula]);
    const Plan plan = plan_of(humid_scene(), {&clouds, &fall});
    for (const char* name : {"condensation", "activation", "collection", "sedimentation"}) {
      EXPECT_EQ(plan.find(name)->verdict, Verdict::off) << name << ' ' << words[formula];
      EXPECT_EQ(plan.find(name)->evidence, Evidence::bound) << name;
    }
    // The formulas differ by less than one per cent at 12 °C.
    EXPECT_NEAR(*plan.find("condensation")->number, 0.005 / 0.00937, 0.01 * 0.534);
    EXPECT_FALSE(plan.operators[0].present);
    EXPECT_FALSE(plan.operators[1].present);
  }
}

TEST(PlanOfClouds, claims_nothing_for_a_formula_nobody_has_bounded) {
  test::Loaded clouds = raining_clouds();
  set_choice(clouds, "saturation_pressure", 5, "wexler");
  EXPECT_EQ(plan_of(humid_scene(), {&clouds}).find("condensation")->verdict, Verdict::on);
  test::Loaded prescribed = raining_clouds();
  set_choice(prescribed, "temperature", 1, "reference_profile");
  EXPECT_EQ(plan_of(humid_scene(), {&prescribed}).find("condensation")->verdict, Verdict::on);
}

TEST(PlanOfClouds, sees_drops_and_rain_of_the_initial_state) {
  const test::Loaded clouds = raining_clouds(), dry = load<test::Clouds>(),
                     fall = load<test::Fall>();
  const char* cloud = "  mass_fraction_of_cloud_liquid_water_in_air: 1e-9*(z > 400)\n";
  const Plan cloudy = plan_of(humid_scene(cloud), {&clouds, &fall});
  for (const char* name : {"condensation", "activation", "collection", "sedimentation"})
    EXPECT_EQ(cloudy.find(name)->verdict, Verdict::on) << name;
  const char* rain = "  mass_fraction_of_rain_in_air: 1e-9*(z > 400)\n";
  const Plan rainy = plan_of(humid_scene(rain), {&clouds, &fall});
  EXPECT_EQ(rainy.find("condensation")->verdict, Verdict::on) << "it evaporates rain";
  EXPECT_EQ(rainy.find("sedimentation")->verdict, Verdict::on);
  // Rain falls although nothing forms it: neither here nor without any clouds.
  EXPECT_EQ(plan_of(humid_scene(rain), {&dry, &fall}).find("sedimentation")->verdict, Verdict::on);
  EXPECT_EQ(plan_of(humid_scene(rain), {&fall}).find("sedimentation")->verdict, Verdict::on);
}

TEST(PlanOfClouds, leaves_rain_out_on_demand_and_with_it_what_needs_it) {
  const test::Loaded clouds = raining_clouds(), fall = load<test::Fall>();
  const char* cloud = "  mass_fraction_of_cloud_liquid_water_in_air: 1e-9*(z > 400)\n";
  const Plan plan = plan_of(humid_scene(cloud, "effects: {collection: off}\n"), {&clouds, &fall});
  EXPECT_EQ(plan.find("condensation")->verdict, Verdict::on);
  EXPECT_EQ(plan.find("collection")->verdict, Verdict::off);
  EXPECT_EQ(plan.find("sedimentation")->verdict, Verdict::off);
  EXPECT_FALSE(plan.operators[1].present);
}

// The operator has nothing it could leave out with activation alone.
TEST(PlanOfClouds, refuses_to_claim_what_an_operator_cannot_leave_out) {
  const test::Loaded clouds = raining_clouds();
  const char* cloud = "  mass_fraction_of_cloud_liquid_water_in_air: 1e-9*(z > 400)\n";
  try {
    plan_of(humid_scene(cloud, "effects: {activation: off}\n"), {&clouds});
    FAIL() << "it was accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::usage);
    for (const char* phrase : {"humid.yaml:7:", "'activation'", "test.clouds", "condensation"})
      EXPECT_NE(std::string(error.what()).find(phrase), std::string::npos) << error.what();
  }
  const Plan listed = plan_of(humid_scene(cloud, "effects: [condensation]\n"), {&clouds});
  EXPECT_EQ(listed.find("activation")->verdict, Verdict::on) << "it comes with condensation";
  EXPECT_EQ(listed.find("collection")->verdict, Verdict::off);
  EXPECT_EQ(plan_of(humid_scene("", "effects: {activation: off}\n"), {&clouds})
                .find("activation")
                ->verdict,
            Verdict::off)
      << "condensation is off as well";
}

TEST(PlanOfClouds, refuses_an_effect_without_what_it_needs) {
  const test::Loaded clouds = raining_clouds();
  for (const char* effects :
       {"effects: [collection]\n", "effects: {condensation: off, collection: on}\n"}) {
    try {
      plan_of(humid_scene("", effects), {&clouds});
      FAIL() << "it was accepted: " << effects;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ExitCode::usage);
      for (const char* phrase : {"humid.yaml:6:", "'collection'", "'condensation'"})
        EXPECT_NE(std::string(error.what()).find(phrase), std::string::npos) << error.what();
    }
  }
  EXPECT_NO_THROW(plan_of(humid_scene("", "effects: [condensation, collection]\n"), {&clouds}));
}

// It is not in the tables, but it can be asked for, and what follows from it is off.
TEST(PlanOfClouds, knows_effects_that_nobody_provides) {
  const test::Loaded fall = load<test::Fall>();
  const Plan plan = plan_of(humid_scene(), {&fall});
  const EffectPlan* mixing = plan.find("small_scale_mixing");
  ASSERT_NE(mixing, nullptr);
  EXPECT_TRUE(mixing->silent);
  EXPECT_EQ(mixing->verdict, Verdict::off);
  EXPECT_FALSE(plan.find("sedimentation")->silent);
}

TEST(PlanOfClouds, calls_for_all_that_what_the_scene_wants_to_see_follows_from) {
  const test::Loaded clouds = raining_clouds(), fall = load<test::Fall>();
  const Plan plan = plan_of(humid_scene("", "output: {fields: {variables: [rainfall_amount]}}\n"),
                            {&clouds, &fall});
  for (const char* name : {"condensation", "collection", "sedimentation"})
    EXPECT_EQ(plan.find(name)->verdict, Verdict::on) << name;
}

TEST(PlanOfMixing, keeps_bounds_unless_it_relaxes_towards_a_profile) {
  const test::Loaded clouds = raining_clouds();
  test::Loaded mixer = load<test::Mixer>();
  EXPECT_EQ(plan_of(humid_scene(), {&clouds, &mixer}).find("condensation")->verdict, Verdict::off);
  const int profile = mixer.table->find_parameter("reference_potential_temperature");
  mixer.values.set_list(profile, {0.0, 290.0});
  const Plan plan = plan_of(humid_scene(), {&clouds, &mixer});
  EXPECT_EQ(plan.find("condensation")->verdict, Verdict::watch);
  EXPECT_EQ(plan.find("small_scale_mixing")->verdict, Verdict::on);
  mixer.values.set_number(mixer.table->find_parameter("rate"), 0);
  const Plan still = plan_of(humid_scene(), {&mixer});
  EXPECT_EQ(still.find("small_scale_mixing")->verdict, Verdict::off);
  EXPECT_FALSE(still.operators[0].present);
}

}  // namespace
}  // namespace pileus::planner
