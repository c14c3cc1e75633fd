// Tables of the core that end before the last member of interface 1.0: no program is that old, and
// none that is broken like this brings a plugin of the C++ layer down.
#include <gtest/gtest.h>

#include "compat/library_run.hpp"

namespace pileus::test {
namespace {

/// The hooks of the plugin under test, for those that cut their tables.
pileus_operator original{};

template <class Table, class Last>
Table cut_before(const Table& whole, const Last Table::*last) {
  Table cut = whole;
  const auto* begin = reinterpret_cast<const char*>(&cut);
  cut.size = static_cast<std::uint32_t>(reinterpret_cast<const char*>(&(cut.*last)) - begin);
  return cut;
}

pileus_status create_cut(const pileus_host* host, void** self, pileus_error* error) {
  static pileus_host cut;
  cut = cut_before(*host, &pileus_host::repaired);
  return original.create(&cut, self, error);
}
pileus_status configure_cut(void* self, const pileus_values* values, pileus_error* error) {
  const pileus_values cut = cut_before(*values, &pileus_values::list);
  return original.configure(self, &cut, error);
}
pileus_status apply_cut_step(void* self, const pileus_step* step, const pileus_block* block,
                             pileus_error* error) {
  const pileus_step cut = cut_before(*step, &pileus_step::dt);
  return original.apply(self, &cut, block, error);
}
pileus_status apply_cut_block(void* self, const pileus_step* step, const pileus_block* block,
                              pileus_error* error) {
  const pileus_block cut = cut_before(*block, &pileus_block::ledger);
  return original.apply(self, step, &cut, error);
}

/// The message with which a run of the relaxation ends, whose table was changed.
template <class Change>
std::string message_with(Change&& change) {
  const auto table = operator_of(PILEUS_BINARY_DIR "/lib/pileus/plugins/libexample_relaxation.so",
                                 "org.pileus.example_relaxation");
  original = table->op;
  change(table->op);
  return message_of([&] {
    LibraryRun run(table);
    run.start();
    run.step(0, 1.0);
  });
}

void expect_named(const std::string& message, const std::string& phase, const std::string& table) {
  const std::string expected =
      "the program's table " + table + " is shorter than that of plugin interface 1.0";
  EXPECT_NE(message.find(expected), std::string::npos) << message;
  EXPECT_NE(message.find(phase), std::string::npos) << message;
}

TEST(TruncatedTables, that_are_whole_run) {
  EXPECT_EQ(message_with([](pileus_operator&) {}), "");
}
TEST(TruncatedTables, of_the_host_are_named) {
  expect_named(message_with([](pileus_operator& op) { op.create = create_cut; }), "in create",
               "pileus_host");
}
TEST(TruncatedTables, of_values_are_named) {
  expect_named(message_with([](pileus_operator& op) { op.configure = configure_cut; }),
               "in configure", "pileus_values");
}
TEST(TruncatedTables, of_a_step_are_named) {
  expect_named(message_with([](pileus_operator& op) { op.apply = apply_cut_step; }), "in apply",
               "pileus_step");
}
TEST(TruncatedTables, of_a_block_are_named) {
  expect_named(message_with([](pileus_operator& op) { op.apply = apply_cut_block; }), "in apply",
               "pileus_block");
}

}  // namespace
}  // namespace pileus::test
