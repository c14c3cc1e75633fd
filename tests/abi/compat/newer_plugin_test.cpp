// A plugin built with the header of the next minor, in the core of today and in one of that minor.
#include <gtest/gtest.h>

#include "library_run.hpp"

namespace pileus::test {
namespace {

constexpr bool core_is_newer = PILEUS_CORE_IS_NEXT_MINOR;

/// Hands the plugin a host that answers what the next minor could be asked.
pileus_status create_with_answer(const pileus_host* host, void** self, pileus_error* error);
decltype(pileus_operator::create) original_create = nullptr;

#if PILEUS_CORE_IS_NEXT_MINOR
pileus_host answering{};

pileus_status create_with_answer(const pileus_host* host, void** self, pileus_error* error) {
  answering = *host;
  answering.appended_member = [](const pileus_host*) { return std::uint64_t{3}; };
  return original_create(&answering, self, error);
}
#else
pileus_status create_with_answer(const pileus_host* host, void** self, pileus_error* error) {
  return original_create(host, self, error);
}
#endif

std::shared_ptr<host::OperatorTable> newer(const std::string& name) {
  return operator_of(library_path("newer"), "org.example.newer." + name);
}

/// The rate is a quarter where the host cannot be asked, 3 where it answers.
TEST(NewerPlugin, uses_a_new_member_only_where_it_is_there) {
  const auto table = newer("growth");
  original_create = table->op.create;
  table->op.create = create_with_answer;
  LibraryRun run(table);
  run.start();
  run.step(0, 2.0);
  EXPECT_EQ(run.values("passive_tracer")[5], core_is_newer ? 1 + 3 * 2.0 : 1 + 0.25 * 2.0);
}

TEST(NewerPlugin, does_without_a_new_member_that_is_zero) {
  LibraryRun run(newer("growth"));
  run.start();
  run.step(0, 2.0);
  EXPECT_EQ(run.values("passive_tracer")[5], 1 + 0.25 * 2.0);
}

TEST(NewerPlugin, has_its_errors_handed_on_whatever_their_length) {
  LibraryRun run(newer("failing_loop"));
  run.start();
  const std::string message = message_of([&] { run.step(0, 1.0); });
  EXPECT_NE(message.find("the loop fails here"), std::string::npos) << message;
  EXPECT_NE(message.find("parcel 2"), std::string::npos) << message;
}

TEST(NewerPlugin, that_needs_the_next_minor_is_refused_before) {
  const std::string message = message_of([] { host::load_library(library_path("newer_in_need")); });
  if (core_is_newer) {
    EXPECT_EQ(message, "");
    return;
  }
  const std::string has = std::to_string(PILEUS_ABI_MINOR);
  const std::string needs = std::to_string(PILEUS_ABI_MINOR + 1);
  EXPECT_NE(message.find("libnewer_in_need.so' is refused: it needs plugin interface 1." + needs +
                         ", this program has 1." + has + "; use a newer Pileus or rebuild it"),
            std::string::npos)
      << message;
}

}  // namespace
}  // namespace pileus::test
