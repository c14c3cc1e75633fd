// A plugin in C built with the header of interface 1.0 (tests/abi/v1_0) in the core of today, and
// in one whose tables are all longer.
#include <gtest/gtest.h>

#include <cmath>

#include "library_run.hpp"

namespace pileus::test {
namespace {

std::shared_ptr<host::OperatorTable> frozen(const std::string& name) {
  return operator_of(library_path("v1_0"), "org.example.v1_0." + name);
}

TEST(FrozenPlugin, says_what_it_was_built_with) {
  const host::LibraryNote note = host::inspect_library(library_path("v1_0"));
  EXPECT_EQ(note.abi_major, 1u);
  EXPECT_EQ(note.abi_minor_built, 0u);
  EXPECT_EQ(note.abi_minor_needed, 0u);
}

/// c(t) = floor + (c0 − floor) exp(−rate t), with the declared 2, 0.5 and 0.125 s⁻¹.
TEST(FrozenPlugin, decays_as_its_exact_solution) {
  LibraryRun run(frozen("decay"));
  run.start();
  run.values("passive_tracer")[7] = 0.5;  // at the floor: inactive
  for (int n = 0; n < 4; ++n) run.step(static_cast<std::uint64_t>(n), 2.0);
  const double* c = run.values("passive_tracer");
  const double expected = 0.5 + 1.5 * std::exp(-0.125 * 8.0);
  EXPECT_NEAR(c[0], expected, 8 * 2.3e-16);  // a rounding or two of each step
  EXPECT_EQ(c[2999], c[0]);
  EXPECT_EQ(c[7], 0.5);
  // All that was lost was booked: 2999 parcels of volume 2.
  const coupling::Ledger ledger = run.sequence().ledger();
  ASSERT_EQ(ledger.operators.at(0).budgets.size(), 1u);
  const coupling::OperatorBudget& tracer = ledger.operators[0].budgets[0];
  EXPECT_EQ(tracer.budget, "tracer");
  EXPECT_NEAR(tracer.source, 2999 * 2.0 * (c[0] - 2.0), 1e-9);
  EXPECT_NEAR(tracer.defect(), 0, 1e-9);
}

TEST(FrozenPlugin, gets_the_parameters_of_its_own_table) {
  const auto table = frozen("decay");
  ASSERT_EQ(table->parameters.size(), 2u);
  EXPECT_STREQ(table->parameters[1].name, "floor");
  EXPECT_EQ(table->parameters[1].fallback, 0.5);
  EXPECT_EQ(table->active_if.size(), 1u);
  EXPECT_EQ(table->budgets, std::vector<std::string>{"tracer"});
}

/// Two items of masses 1 and 3, doubled in each of three steps.
TEST(FrozenPlugin, makes_and_changes_items) {
  LibraryRun run(frozen("drops"), 100);
  run.start();
  for (int n = 0; n < 3; ++n) run.step(static_cast<std::uint64_t>(n), 1.0);
  ASSERT_EQ(run.store().items().size(), 200u);
  const double* masses = run.store().items().column(0);
  for (std::size_t k = 0; k < 200; ++k) EXPECT_EQ(masses[k], k % 2 == 0 ? 8.0 : 24.0) << k;
}

/// After n steps of 0.5 s the humidity is 0.5 (1 + 2 + … + n); the count is private to the
/// operator.
TEST(FrozenPlugin, goes_on_after_a_restart_with_its_private_state) {
  LibraryRun first(frozen("pulse")), second(frozen("pulse"));
  first.start();
  for (int n = 0; n < 3; ++n) first.step(static_cast<std::uint64_t>(n), 0.5);
  const coupling::PrivateStates states = first.sequence().private_states();
  ASSERT_EQ(states.size(), 1u);
  EXPECT_EQ(states.at("op").format, 3u);
  EXPECT_EQ(states.at("op").bytes.size(), sizeof(std::uint64_t));
  second.resume(first, states);
  for (int n = 3; n < 5; ++n) second.step(static_cast<std::uint64_t>(n), 0.5);
  EXPECT_EQ(second.values("specific_humidity")[0], 0.5 * (1 + 2 + 3 + 4 + 5));
}

TEST(FrozenPlugin, refuses_private_state_that_it_cannot_read) {
  const auto refusal = [](const host::PrivateState& state) {
    LibraryRun first(frozen("pulse")), second(frozen("pulse"));
    first.start();
    return message_of([&] { second.resume(first, {{"op", state}}); });
  };
  const std::string short_of_bytes = refusal({3, {1, 2, 3}});
  EXPECT_NE(short_of_bytes.find("plugin org.example.v1_0.pulse was given a value outside its range "
                                "in load: its private state has format 3 and 3 bytes, expected are "
                                "3 and 8"),
            std::string::npos)
      << short_of_bytes;
  const std::string other_format = refusal({4, std::vector<std::uint8_t>(8)});
  EXPECT_NE(other_format.find("format 4 and 8 bytes"), std::string::npos) << other_format;
}

TEST(FrozenPlugin, is_not_resumed_without_the_private_state_it_keeps) {
  LibraryRun first(frozen("pulse")), second(frozen("pulse"));
  first.start();
  EXPECT_NE(message_of([&] {
              second.resume(first, {});
            }).find("holds no private state of operator 'op', which org.example.v1_0.pulse"),
            std::string::npos);
}

TEST(FrozenPlugin, is_not_resumed_with_private_state_it_does_not_keep) {
  LibraryRun first(frozen("decay")), second(frozen("decay"));
  first.start();
  EXPECT_NE(message_of([&] {
              second.resume(first, {{"op", {1, {}}}});
            }).find("holds private state of operator 'op', which org.example.v1_0.decay does not"),
            std::string::npos);
}

}  // namespace
}  // namespace pileus::test
