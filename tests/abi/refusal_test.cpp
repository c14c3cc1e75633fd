// Libraries that break a rule are refused by name, with the reason and the remedy.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "host/breadcrumb.hpp"
#include "host/floating_point.hpp"
#include "hostile_library.hpp"

namespace pileus::test {
namespace {

struct Refusal {
  const char* variant;
  const char* reason;  // part of the message
};

class Refusals : public testing::TestWithParam<Refusal> {};

TEST_P(Refusals, name_library_and_reason) {
  const std::string message = refusal_of(hostile_path(GetParam().variant));
  EXPECT_NE(message.find(GetParam().reason), std::string::npos) << "message: " << message;
  EXPECT_NE(message.find(hostile_path(GetParam().variant).string()), std::string::npos) << message;
}

constexpr Refusal refusals[] = {
    {"wrong_magic", "its note does not begin with 'PILEUSNOTE1'"},
    {"without_note", "carries no section '.pileus.note'"},
    {"wrong_major", "built for major version 7 of the plugin interface, this program has 1"},
    {"newer_minor", "needs plugin interface 1.1, this program has 1.0"},
    {"fast_math", "rebuild it without -ffast-math"},
    {"missing_entry", "does not export the entry function 'pileus_module_v1'"},
    {"extra_symbol", "exports more than the entry function: forgotten_helper"},
    {"throwing_entry", "entry function threw an exception"},
    {"null_module", "entry function returned NULL"},
    {"short_module", "module table has size 8"},
    {"no_operators", "declares no operators"},
    {"disagrees_with_note", "state different interface versions"},
    {"short_operator", "operator table has size 16"},
    {"short_row", "quantity 0 has size 40 where at least 104 is needed"},
    {"reserved_in_use", "operator table has a reserved member that is not 0"},
    {"unknown_place", "quantity 'passive_tracer' has an unknown place"},
    {"unknown_scope", "scope has the unknown value 9"},
    {"unknown_flag", "flags hold an unknown bit"},
    {"no_nature", "'passive_tracer' is owned, so its nature must be declared"},
    {"null_name", "quantity 0 name is NULL"},
    {"no_weight", "'passive_tracer' is intensive but names no weight"},
    {"inverted_range", "low end is not below its high end"},
    {"initial_out_of_range", "has its initial value outside its range"},
    {"declares_twice", "'passive_tracer' is declared twice"},
    {"wrong_when", "condition on the unknown parameter 'mode'"},
    {"reserved_parameter", "parameter 'use' has a name that is reserved"},
    {"default_out_of_range", "parameter 'rate' has a default out of its range"},
    {"malformed_id", "id is not lower-case reverse DNS"},
    {"foreign_id", "is not named after its module 'org.example.hostile'"},
    {"malformed_version", "version is not a semantic version"},
    {"not_utf8", "summary is not UTF-8"},
    {"doc_not_utf8", "'passive_tracer' doc is not UTF-8"},
    {"broken_integer", "'rate' is an integer with a default that is no whole number"},
    {"broken_switch", "'rate' is a switch with a default that is neither 0 nor 1"},
    {"null_licence", "licence is NULL"},
    {"null_create", "create is NULL"},
    {"null_diagnose", "'buoyancy' is derived but the operator has no diagnose"},
    {"null_apply", "apply is NULL"},
};

INSTANTIATE_TEST_SUITE_P(Libraries, Refusals, testing::ValuesIn(refusals),
                         [](const auto& chosen) { return std::string(chosen.param.variant); });

TEST(Loading, accepts_the_library_that_breaks_nothing) {
  EXPECT_EQ(refusal_of(hostile_path("nothing")), "");
}

TEST(Loading, restores_the_arithmetic_a_library_changes_while_it_is_loaded) {
  const std::uint32_t before = host::arithmetic_mode();
  EXPECT_EQ(refusal_of(hostile_path("changes_arithmetic_at_load")), "");
  EXPECT_EQ(host::arithmetic_mode(), before);
  volatile double smallest = 2.2250738585072014e-308;  // the smallest normal number
  EXPECT_GT(smallest * 0.5, 0.0) << "denormal numbers are flushed to zero";
}

TEST(Loading, refuses_files_that_are_no_libraries) {
  EXPECT_NE(refusal_of("/proc/version").find("is not an ELF file"), std::string::npos);  // empty
  EXPECT_NE(refusal_of(PILEUS_BINARY_DIR "/CMakeCache.txt").find("is not an ELF file"),
            std::string::npos);
  EXPECT_NE(refusal_of("/nonexistent/libx.so").find("No such file"), std::string::npos);
  EXPECT_NE(refusal_of("/usr").find("not a regular file"), std::string::npos);
}

TEST(Loading, does_not_wait_for_the_writer_of_a_pipe) {
  const std::string path = testing::TempDir() + "/libpipe.so";
  std::filesystem::remove(path);
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  EXPECT_NE(refusal_of(path).find("not a regular file"), std::string::npos);
  std::filesystem::remove(path);
}

TEST(LoadingDeathTest, crash_while_loading_names_the_library) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_DEATH(
      {
        host::install_crash_handler();
        host::load_library(hostile_path("crashes_at_load"));
      },
      "pileus: fatal: SIGSEGV in plugin phase load \\(library .*libcrashes_at_load.so\\)");
}

}  // namespace
}  // namespace pileus::test
