// Means over samples: to the bit across restarts, before and after a checkpoint's own sample.
#include "model/running_mean.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace pileus::model {
namespace {

std::vector<double> mean_of(const RunningMean& mean) {
  std::vector<double> values;
  mean.mean(values);
  return values;
}

TEST(RunningMean, OneSampleComesBackToTheBit) {
  RunningMean mean;
  mean.add(0, std::vector{-0.0, 0.1});
  EXPECT_TRUE(std::signbit(mean_of(mean)[0]));
  EXPECT_EQ(mean_of(mean)[1], 0.1);
}

TEST(RunningMean, BeginsAnewAfterARecord) {
  RunningMean mean;
  mean.add(0, std::vector{1.0});
  mean.add(1, std::vector{2.0});
  EXPECT_EQ(mean_of(mean)[0], 1.5);
  mean.clear(1);
  EXPECT_EQ(mean.samples(), 0u);
  mean.add(2, std::vector{5.0});
  EXPECT_EQ(mean_of(mean)[0], 5);
}

/// A checkpoint of t = 2 precedes the sample and the record of t = 2, whenever it is written.
TEST(RunningMean, ACheckpointHoldsWhatCameBeforeItsTime) {
  RunningMean mean;
  mean.add(0, std::vector{1.0});
  mean.add(1, std::vector{4.0});
  output::NamedData before, after;
  mean.save(before, "mean", 2);
  mean.add(2, std::vector{10.0});
  mean.clear(2);
  mean.save(after, "mean", 2);
  EXPECT_EQ(before, after);
  RunningMean continued;
  continued.restore(after, "mean", 1);
  EXPECT_EQ(continued.latest(), 1);
  continued.add(2, std::vector{10.0});
  EXPECT_EQ(mean_of(continued)[0], 5);
}

TEST(RunningMean, DataOfAnotherScene) {
  RunningMean mean, continued;
  mean.add(1, std::vector{4.0, 5.0});
  output::NamedData data;
  mean.save(data, "mean", 2);
  continued.restore(data, "mean", 3);
  EXPECT_EQ(continued.samples(), 0u);
  continued.restore(data, "another", 2);
  EXPECT_EQ(continued.samples(), 0u);
}

}  // namespace
}  // namespace pileus::model
