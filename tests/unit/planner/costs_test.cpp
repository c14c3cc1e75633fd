// What a step is predicted to take, and what leaving effects out saves, from measured costs alone.
#include "planner/costs.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace pileus::planner {
namespace {

Plan plan_with(std::vector<OperatorPlan> operators) {
  Plan plan;
  plan.operators = std::move(operators);
  plan.flow.parcels = 1000;
  return plan;
}

OperatorPlan clouds(std::vector<std::string> on, std::vector<std::string> off) {
  OperatorPlan op{"clouds", "org.clouds", "1.0.0", !on.empty(), std::move(on), {}, std::move(off)};
  return op;
}

Costs measured() {
  Costs costs;
  costs.set(core_part({}), {3e-6, "scene", "2026-11-26", "abc"});
  costs.set("org.clouds 1.0.0 (buoyancy)", {1e-7, "scene", "2026-11-26", "abc"});
  costs.set("org.clouds 1.0.0 (buoyancy, condensation)", {6e-7, "scene", "2026-11-26", "abc"});
  return costs;
}

TEST(Costs, are_predicted_as_the_sum_of_the_parts_that_are_there) {
  Plan plan = plan_with({clouds({"condensation", "buoyancy"}, {})});
  predict_time({}, measured(), plan);
  ASSERT_TRUE(plan.flow.seconds_per_step);
  EXPECT_DOUBLE_EQ(*plan.flow.seconds_per_step, 1000 * 3.6e-6);
  EXPECT_EQ(plan.flow.seconds_left_out, 0.0);
}

TEST(Costs, of_what_is_left_out_are_the_difference_to_all_effects_on) {
  Plan without = plan_with({clouds({"buoyancy"}, {"condensation"})});
  predict_time({}, measured(), without);
  EXPECT_DOUBLE_EQ(*without.flow.seconds_per_step, 1000 * 3.1e-6);
  EXPECT_DOUBLE_EQ(without.flow.seconds_left_out.value_or(-1), 5e-7);
  Plan absent = plan_with({clouds({}, {"buoyancy", "condensation"})});
  predict_time({}, measured(), absent);
  EXPECT_DOUBLE_EQ(absent.flow.seconds_left_out.value_or(-1), 6e-7);
}

TEST(Costs, that_were_not_measured_are_not_guessed) {
  Plan plan = plan_with({clouds({"buoyancy"}, {"condensation", "freezing"})});
  predict_time({}, measured(), plan);
  EXPECT_TRUE(plan.flow.seconds_per_step) << "what is there has been measured";
  EXPECT_FALSE(plan.flow.seconds_left_out);
  predict_time({}, {}, plan);
  EXPECT_FALSE(plan.flow.seconds_per_step);
  EXPECT_NE(plan.flow.cost_source.find("--measure"), std::string::npos);
}

TEST(Costs, survive_their_file_and_a_damaged_one_holds_none) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "costs.json";
  std::ofstream(path) << measured().text();
  const Costs read = Costs::read(path);
  const Cost* cost = read.find("org.clouds 1.0.0 (buoyancy)");
  ASSERT_NE(cost, nullptr);
  EXPECT_EQ(cost->seconds, 1e-7);
  EXPECT_EQ(cost->when, "2026-11-26");
  for (const char* damaged :
       {R"({"core 3 rk4": {"core_seconds_per_parcel_step": null}})",
        R"({"core 3 rk4": {"core_seconds_per_parcel_step": "3", "scene": 1}})", "[1]"}) {
    std::ofstream(path) << damaged;
    EXPECT_EQ(Costs::read(path).find("core 3 rk4"), nullptr) << damaged;
  }
  std::ofstream(path) << R"({"core 3 rk4": {"core_seconds_per_parcel_step": 3, "when": []}})";
  EXPECT_EQ(Costs::read(path).find("core 3 rk4")->seconds, 3);
  std::ofstream(path) << "{";
  EXPECT_EQ(Costs::read(path).find("org.clouds 1.0.0 (buoyancy)"), nullptr);
}

}  // namespace
}  // namespace pileus::planner
