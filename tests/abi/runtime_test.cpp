// What the host makes of hooks that throw, lie, crash or write what they must not.
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "base/parallel.hpp"
#include "coupling/operator_sequence.hpp"
#include "host/breadcrumb.hpp"
#include "host/floating_point.hpp"
#include "hostile_library.hpp"

namespace pileus::test {
namespace {

constexpr std::size_t parcels_in_run = 3000;  // three blocks, the last one ragged

/// A run of one step with one hostile operator.
class HostileRun {
 public:
  explicit HostileRun(const std::string& variant) {
    host::Library library = host::load_library(hostile_path(variant));
    auto table = std::make_shared<const host::OperatorTable>(std::move(library.operators.front()));
    std::vector<coupling::OperatorEntry> entries;
    entries.push_back({"hostile", table, host::ParameterValues(*table), 0});
    sequence_ = std::make_unique<coupling::OperatorSequence>(std::move(entries),
                                                             coupling::SequenceOptions{});
    store_ = std::make_unique<parcels::Store>(3, sequence_->required_scalars());
    store_->resize(parcels_in_run);
    for (int c = 0; c < store_->column_count(); ++c) {
      std::fill_n(store_->column(c), parcels_in_run, 0.25);
    }
    for (std::size_t p = 0; p < parcels_in_run; ++p) store_->uid()[p] = 1000 + p;
  }

  void run() {
    sequence_->bind(*store_, {});
    sequence_->init({0, 0.0, 0.0});
    sequence_->apply_after_transport({7, 0.0, 1.0});
  }
  const double* tracer() const { return store_->scalar(store_->find_scalar("passive_tracer")); }

 private:
  std::unique_ptr<coupling::OperatorSequence> sequence_;
  std::unique_ptr<parcels::Store> store_;
};

/// The message with which a run ends; empty if it ends well.
std::string failure_of(const std::string& variant) {
  try {
    HostileRun(variant).run();
  } catch (const Error& error) {
    return error.code() == ExitCode::plugin ? error.what()
                                            : std::string("exit code? ") + error.what();
  }
  return {};
}

struct Failure {
  const char* variant;
  const char* reason;  // part of the message
};

class Failures : public testing::TestWithParam<Failure> {};

TEST_P(Failures, name_operator_and_reason) {
  const std::string message = failure_of(GetParam().variant);
  EXPECT_NE(message.find(GetParam().reason), std::string::npos) << "message: " << message;
  EXPECT_NE(message.find("org.example.hostile"), std::string::npos) << message;
}

constexpr Failure failures[] = {
    {"throws_in_create", "in create: an exception left the library (no create)"},
    {"throws_in_configure", "in configure: an exception left the library (of an unknown type)"},
    {"refuses_configure", "has contradictory parameters in configure"},
    {"throws_in_init", "an exception left the library (no init)"},
    {"throws_in_prepare", "an exception left the library (no prepare)"},
    {"negative_step_limit", "it returned the step limit -1 s"},
    {"throws_in_diagnose", "an exception left the library (no diagnose)"},
    {"derives_nan", "in diagnose at step 0"},
    {"throws_in_apply", "an exception left the library (no apply)"},
    {"writes_nan", "parcel 1001, passive_tracer = nan"},
    {"writes_infinity", "parcel 1001, passive_tracer = inf"},
    {"writes_infinity_in_any_range", "parcel 1001, passive_tracer = inf"},
    {"sets_nan_in_init", "in init at step 0, t = 0 s, dt = 0 s; parcel 1001, passive_tracer = nan"},
    {"books_nan", "it booked a source of water that is not finite"},
    {"throws_in_loop", "failed: no loop"},
    {"changes_arithmetic_in_loop", "changed the floating-point mode"},
    {"writes_out_of_range", "parcel 1001, passive_tracer = 3.5"},
    {"always_retries", "asked for a smaller step"},
    {"keeps_its_values", "the rate is 1 in apply"},
    {"unknown_status", "returned the unknown status 99"},
    {"unterminated_text", "failed: xxxx"},
    {"changes_arithmetic_in_apply", "changed the floating-point mode"},
};

INSTANTIATE_TEST_SUITE_P(Hooks, Failures, testing::ValuesIn(failures),
                         [](const auto& chosen) { return std::string(chosen.param.variant); });

TEST(Hooks, that_break_nothing_run) {
  EXPECT_EQ(failure_of("nothing"), "");
}
TEST(Hooks, that_throw_in_destroy_do_not_end_the_process) {
  EXPECT_EQ(failure_of("throws_in_destroy"), "");
}
TEST(Hooks, see_unregistered_names_and_units_refused) {
  EXPECT_NE(failure_of("unregistered_name").find("did you mean 'passive_tracer'?"),
            std::string::npos);
  EXPECT_NE(failure_of("wrong_units").find("declares 'passive_tracer' in 'kg', registered is '1'"),
            std::string::npos);
}

TEST(Hooks, leave_the_arithmetic_as_it_was_even_after_a_violation) {
  const std::uint32_t before = host::arithmetic_mode();
  failure_of("changes_arithmetic_in_apply");
  EXPECT_EQ(host::arithmetic_mode(), before);
}

TEST(Guard, restores_the_block_it_condemns) {
  HostileRun run("writes_out_of_range");
  EXPECT_THROW(run.run(), coupling::OperatorFailure);
  for (std::size_t p = 0; p < parcels_in_run; ++p) EXPECT_EQ(run.tracer()[p], 0.5);
}

TEST(Guard, hands_over_a_bundle_with_the_inputs_of_the_call) {
  HostileRun run("writes_nan");
  try {
    run.run();
    FAIL() << "a NaN passed the guard";
  } catch (const coupling::OperatorFailure& failure) {
    const coupling::FailureBundle& bundle = failure.bundle();
    EXPECT_EQ(bundle.operator_id, "org.example.hostile");
    EXPECT_EQ(bundle.phase, "apply");
    EXPECT_EQ(bundle.step, 7u);
    EXPECT_EQ(bundle.block, 0);
    EXPECT_EQ(bundle.uids.size(), 1024u);
    ASSERT_EQ(bundle.columns.size(), 2u);
    EXPECT_EQ(bundle.columns[0].name, "passive_tracer");
    EXPECT_EQ(bundle.columns[0].values, std::vector<double>(1024, 0.5));
    ASSERT_EQ(bundle.parameters.size(), 1u);
    EXPECT_EQ(bundle.parameters[0].name, "rate");
    EXPECT_FALSE(bundle.input_at_fault);
  }
}

TEST(CrashDeathTest, names_operator_phase_step_and_block) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto crash = [](const char* variant) {
    host::install_crash_handler();
    HostileRun(variant).run();
  };
  EXPECT_DEATH(crash("crashes_in_diagnose"),
               "pileus: fatal: SIGSEGV in plugin org.example.hostile, phase diagnose, step 0, "
               "block [012] \\(library .*libcrashes_in_diagnose.so\\)");
  EXPECT_DEATH(crash("aborts_in_apply"),
               "pileus: fatal: SIGABRT in plugin org.example.hostile, phase apply, step 7, "
               "block [012]");
}

/// The loop's other threads are not the one that the plugin was called on.
TEST(CrashDeathTest, in_a_loop_over_all_threads_is_named_too) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto crash = [] {
    host::install_crash_handler();
    omp_set_num_threads(3);
    HostileRun("crashes_in_loop").run();
  };
  EXPECT_DEATH(crash(),
               "pileus: fatal: SIGSEGV in plugin org.example.hostile, phase apply \\(library");
}

TEST(CrashDeathTest, ending_the_program_from_a_hook_is_the_failure_of_a_plugin) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto run = [] {
    host::install_crash_handler();
    omp_set_num_threads(1);
    HostileRun("exits_in_apply").run();
  };
  EXPECT_EXIT(run(), testing::ExitedWithCode(static_cast<int>(ExitCode::plugin)),
              "pileus: fatal: the program was ended in plugin org.example.hostile, phase apply, "
              "step 7, block 0");
}

}  // namespace
}  // namespace pileus::test
