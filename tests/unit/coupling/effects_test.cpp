// What effects that are off, on or watched mean for quantities and calls.
#include <gtest/gtest.h>

#include "toy_operators.hpp"

namespace pileus::test {
namespace {

using coupling::EffectState;

constexpr const char* liquid = "mass_fraction_of_cloud_liquid_water_in_air";

ToyRun condenser(EffectState condensation) {
  auto entries = entries_of<Condenser>({"condenser"});
  entries.front().effects = {condensation, EffectState::on};
  return ToyRun(std::move(entries), 3000);
}

TEST(Effects, that_are_off_have_no_array) {
  ToyRun run = condenser(EffectState::off);
  EXPECT_EQ(run.store.find_scalar(liquid), -1);
  EXPECT_EQ(run.values("buoyancy")[2999], 1.0);
}

TEST(Effects, that_are_on_are_derived) {
  ToyRun run = condenser(EffectState::on);
  EXPECT_EQ(run.values(liquid)[2999], 0.25);
}

// The range of the quantity is [0.25, 0.25]: zeros would be refused if the plugin had written them.
TEST(Effects, that_are_watched_are_zero_until_they_are_switched_on) {
  ToyRun run = condenser(EffectState::watched);
  for (std::size_t p = 0; p < 3000; ++p) ASSERT_EQ(run.values(liquid)[p], 0.0);
  EXPECT_EQ(run.values("buoyancy")[2999], 1.0);
  EXPECT_FALSE(run.sequence.activate("freezing"));
  EXPECT_TRUE(run.sequence.activate("condensation"));
  EXPECT_FALSE(run.sequence.activate("condensation")) << "it is on already";
  run.sequence.diagnose({});
  for (std::size_t p = 0; p < 3000; ++p) ASSERT_EQ(run.values(liquid)[p], 0.25);
}

TEST(Effects, that_are_watched_call_no_operator_that_does_nothing_else) {
  auto entries = entries_of<Counter>({"counter"});
  entries.front().effects = {EffectState::watched};
  ToyRun run(std::move(entries), 100);
  Counter::calls = 0;
  run.step(0, 1.0);
  EXPECT_EQ(Counter::calls, 0);
  EXPECT_EQ(run.values("passive_tracer")[7], 3.0) << "what it owns exists";
  run.sequence.activate("counting");
  run.step(1, 1.0);
  EXPECT_EQ(Counter::calls, 1);
}

TEST(Effects, are_named_in_conditions_of_quantities_only_and_by_their_provider) {
  const coupling::OperatorEntry entry = entry_of<Condenser>("condenser");
  const host::OperatorTable& table = *entry.table;
  EXPECT_TRUE(host::read_condition("effect.condensation == on", table));
  EXPECT_TRUE(host::read_condition("effect.buoyancy != on", table));
  EXPECT_FALSE(host::read_condition("effect.condensation == off", table));
  EXPECT_FALSE(host::read_condition("effect.freezing == on", table));
}

}  // namespace
}  // namespace pileus::test
