#include "model/judge.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/error.hpp"

namespace pileus::model {
namespace {

output::DiagnosticSummary energy() {
  output::DiagnosticSummary diagnostic;
  diagnostic.name = "total_energy";
  diagnostic.initial = -4;
  diagnostic.final = -3;
  diagnostic.min = -5;
  diagnostic.max = -2;
  diagnostic.mean = -3.5;
  return diagnostic;
}

scene::Expectation expect(const std::string& statistic, std::optional<double> low,
                          std::optional<double> high) {
  scene::Expectation expectation;
  expectation.diagnostic = "total_energy";
  expectation.statistic = statistic;
  expectation.low = low;
  expectation.high = high;
  expectation.source = "a paper";
  return expectation;
}

std::optional<double> no_series(const std::string&, double) {
  return std::nullopt;
}

output::ExpectSummary judge_one(const scene::Expectation& expectation,
                                const SeriesValue& series = no_series) {
  return judge({expectation}, {energy()}, series).front();
}

TEST(judge, every_statistic_is_its_own_number) {
  EXPECT_EQ(judge_one(expect("initial", {}, {})).value, -4);
  EXPECT_EQ(judge_one(expect("final", {}, {})).value, -3);
  EXPECT_EQ(judge_one(expect("min", {}, {})).value, -5);
  EXPECT_EQ(judge_one(expect("max", {}, {})).value, -2);
  EXPECT_EQ(judge_one(expect("mean", {}, {})).value, -3.5);
  EXPECT_EQ(judge_one(expect("relative_change", {}, {})).value, 0.25);
}

TEST(judge, bounds_are_inclusive_and_one_sided_bounds_leave_the_other_side_open) {
  EXPECT_TRUE(judge_one(expect("final", -3, -3)).passed);
  EXPECT_FALSE(judge_one(expect("final", std::nextafter(-3.0, 0), {})).passed);
  EXPECT_FALSE(judge_one(expect("final", {}, std::nextafter(-3.0, -9))).passed);
  EXPECT_TRUE(judge_one(expect("final", -1e300, {})).passed);
  EXPECT_TRUE(judge_one(expect("final", {}, 1e300)).passed);
}

TEST(judge, value_at_a_time_comes_from_the_series) {
  scene::Expectation expectation = expect("final", 6, 8);
  expectation.at = 30;
  const auto result = judge_one(expectation, [](const std::string& name, double time) {
    EXPECT_EQ(name, "total_energy");
    EXPECT_EQ(time, 30);
    return std::optional<double>(7);
  });
  EXPECT_EQ(result.value, 7);
  EXPECT_TRUE(result.passed);
  EXPECT_FALSE(judge_one(expectation).passed) << "a run without the series has missed the bound";
}

TEST(judge, missing_and_not_finite_values_fail_even_without_bounds) {
  scene::Expectation unknown = expect("final", {}, {});
  unknown.diagnostic = "nothing_of_the_kind";
  EXPECT_FALSE(judge_one(unknown).passed);
  output::DiagnosticSummary broken = energy();
  broken.final = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(judge({expect("final", {}, {})}, {broken}, no_series).front().passed);
}

TEST(judge, one_miss_spoils_all) {
  const auto judged =
      judge({expect("final", -4, {}), expect("final", 0, {})}, {energy()}, no_series);
  EXPECT_TRUE(judged[0].passed);
  EXPECT_FALSE(judged[1].passed);
  EXPECT_FALSE(all_passed(judged));
  EXPECT_TRUE(all_passed({judged[0]}));
}

TEST(require_diagnostics, names_the_place_and_the_nearest_diagnostic) {
  scene::Expectation wrong = expect("final", {}, {});
  wrong.diagnostic = "totl_energy";
  wrong.where = {"wave.yaml", 12, 5};
  try {
    require_diagnostics({expect("final", {}, {}), wrong}, {"volume", "total_energy"});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::usage);
    EXPECT_STREQ(error.what(),
                 "wave.yaml:12:5: error: this scene has no diagnostic 'totl_energy'; "
                 "did you mean 'total_energy'?");
  }
  EXPECT_NO_THROW(require_diagnostics({expect("final", {}, {})}, {"total_energy"}));
}

}  // namespace
}  // namespace pileus::model
