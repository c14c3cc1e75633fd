// The record of diagnostics: statistics, expectations, what is refused.
#include "model/record.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"

namespace pileus::model {
namespace {

Record sample() {
  Record record({{"energy", "m2 s-2", "", true}, {"cloud_fraction", "1", "", false}});
  record.append(0, {2.0, 0.0});
  record.append(10, {1.0, 0.0});
  record.append(30, {3.0, 0.5});
  return record;
}

TEST(Record, StatisticsOfTheWholeRun) {
  const Record record = sample();
  EXPECT_EQ(record.statistic(0, "initial", {}), 2.0);
  EXPECT_EQ(record.statistic(0, "final", {}), 3.0);
  EXPECT_EQ(record.statistic(0, "min", {}), 1.0);
  EXPECT_EQ(record.statistic(0, "max", {}), 3.0);
  EXPECT_EQ(record.statistic(0, "mean", {}), 2.0);
  EXPECT_EQ(record.statistic(0, "relative_change", {}), 0.5);
  EXPECT_EQ(record.statistic(1, "relative_change", 10.0), 0.0) << "nothing that stayed nothing";
  EXPECT_EQ(record.statistic(1, "first_time_above", {}), 30.0);
  EXPECT_FALSE(record.statistic(0, "median", {}).has_value());
}

/// A cloud base before and after the cloud, and of a run without one.
TEST(Record, WhatIsNotANumberDoesNotCount) {
  const double none = std::nan("");
  Record record({{"cloud_base_height", "m", "", false}, {"never", "m", "", false}});
  for (const double value : {none, 650.0, none, 550.0, 600.0, none})
    record.append(10.0 * static_cast<double>(record.size()), {value, none});
  EXPECT_EQ(record.statistic(0, "min", {}), 550);
  EXPECT_EQ(record.statistic(0, "max", {}), 650);
  EXPECT_EQ(record.statistic(0, "mean", {}), 600);
  EXPECT_EQ(record.statistic(0, "first_value", {}), 650);
  EXPECT_EQ(record.statistic(0, "first_value", {}, 20.0), 550);
  EXPECT_EQ(record.statistic(0, "min", 20.0), 650);
  EXPECT_TRUE(std::isnan(*record.statistic(0, "final", {})));
  EXPECT_TRUE(std::isnan(*record.statistic(1, "mean", {})));
  EXPECT_FALSE(record.statistic(1, "first_value", {}).has_value());
}

TEST(Record, AnEarlierTimeIsInterpolatedAndEndsTheStatistics) {
  const Record record = sample();
  EXPECT_EQ(record.statistic(0, "final", 20.0), 2.0);
  EXPECT_EQ(record.statistic(0, "max", 20.0), 2.0);
  EXPECT_FALSE(record.statistic(1, "first_time_above", 20.0).has_value());
}

TEST(Record, RelativeRiseIsMeasuredFromTheFirstValueToTheLargest) {
  Record record({{"parcels", "1", "", false}});
  for (const double value : {4.0, 3.0, 10.0, 5.0})
    record.append(double(record.times().size()), {value});
  EXPECT_EQ(record.statistic(0, "relative_rise", {}), 1.5);
  EXPECT_EQ(record.statistic(0, "relative_rise", 1.0), 0.0);
}

TEST(Record, GrowthRateIsTheSlopeOfTheLogarithm) {
  Record record({{"wave", "m s-1", "", false}});
  // Another rate before t = 2, which the fit must not see; the sign may be either.
  for (int i = 0; i <= 40; ++i) {
    const double t = 0.1 * i;
    record.append(t, {t < 2 ? 1.0 : -std::exp(0.3 * t)});
  }
  EXPECT_NEAR(*record.statistic(0, "growth_rate", {}, 2.0), 0.3, 1e-13);
  EXPECT_NEAR(*record.statistic(0, "growth_rate", 3.0, 2.0), 0.3, 1e-13);
  EXPECT_NEAR(*record.statistic(0, "growth_rate", 1.5, {}), 0.0, 1e-13);
}

TEST(Record, GrowthRateNeedsThreeRecordsOtherThanZero) {
  Record record({{"wave", "m s-1", "", false}});
  record.append(0, {0.0});
  record.append(1, {1.0});
  record.append(2, {2.0});
  EXPECT_FALSE(record.statistic(0, "growth_rate", {}, {}).has_value());
  EXPECT_FALSE(record.statistic(0, "growth_rate", {}, 1.0).has_value());
  record.append(3, {4.0});
  EXPECT_NEAR(*record.statistic(0, "growth_rate", {}, 1.0), std::log(2.0), 1e-14);
}

TEST(Record, StatisticsBeginWhereTheyAreAskedTo) {
  const Record record = sample();
  EXPECT_EQ(record.statistic(0, "max", 20.0, 5.0), 1.0);
  EXPECT_EQ(record.statistic(0, "initial", {}, 5.0), 1.0);
  EXPECT_EQ(record.statistic(0, "relative_change", {}, 5.0), 2.0);
  EXPECT_FALSE(record.statistic(0, "max", {}, 31.0).has_value());
}

TEST(Record, SurvivesACheckpointAndForgetsWhatIsRepeated) {
  output::NamedData data;
  sample().save(data);
  Record restored(sample().list());
  restored.restore(data, 30);  // the record of the checkpoint's own time is written again
  EXPECT_EQ(restored.times(), (std::vector<double>{0, 10}));
  restored.append(30, {3.0, 0.5});
  EXPECT_EQ(restored.series(0), sample().series(0));
}

scene::Expectation expectation(const char* diagnostic, const char* statistic,
                               std::optional<double> low, std::optional<double> high) {
  scene::Expectation e;
  e.diagnostic = diagnostic;
  e.statistic = statistic;
  e.low = low;
  e.high = high;
  return e;
}

TEST(Judge, BoundsAreInclusiveAndNothingUnmeasuredPasses) {
  const auto results =
      judge({expectation("energy", "final", 3.0, 3.0), expectation("energy", "final", {}, 2.9),
             expectation("energy", "min", 1.1, {}), expectation("absent", "final", {}, {}),
             expectation("cloud_fraction", "relative_change", {}, 1.0)},
            sample());
  ASSERT_EQ(results.size(), 5u);
  EXPECT_TRUE(results[0].passed);
  EXPECT_FALSE(results[1].passed);
  EXPECT_FALSE(results[2].passed);
  EXPECT_FALSE(results[3].passed);
  EXPECT_FALSE(results[4].passed);  // 0.5/0 is no number a bound can hold for
}

TEST(Judge, UnknownNamesAreRefusedWithTheNearestOne) {
  const std::vector<DiagnosticInfo> list = sample().list();
  EXPECT_NO_THROW(check_expectations({expectation("energy", "final", {}, {})}, list));
  try {
    check_expectations(
        {expectation("enrgy", "final", {}, {}), expectation("energy", "finl", {}, {})}, list);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::usage);
    const std::string text = error.what();
    EXPECT_NE(text.find("'enrgy'; did you mean 'energy'?"), std::string::npos) << text;
    EXPECT_NE(text.find("'finl'; did you mean 'final'?"), std::string::npos) << text;
  }
}

}  // namespace
}  // namespace pileus::model
