// Statistics of ensembles: small ones by hand, and how members of different times are compared.
#include "study/sweep_statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace pileus::study {
namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

TEST(SweepStatistics, OfFiveNumbersByHand) {
  std::vector<double> values = {4, missing, 0, 1, 3, 2};
  const MemberStatistics statistics = statistics_of(values);
  EXPECT_EQ(statistics.mean, 2);
  EXPECT_DOUBLE_EQ(statistics.deviation, std::sqrt(2.0));
  // p of n sorted values lies at p (n − 1), as numpy.percentile has it.
  const double expected[] = {0.2, 1, 2, 3, 3.8};
  for (std::size_t p = 0; p < percentiles.size(); ++p)
    EXPECT_DOUBLE_EQ(statistics.at_percentile[p], expected[p]);
}

TEST(SweepStatistics, OfOneAndOfNone) {
  std::vector<double> one = {7}, none = {missing};
  const MemberStatistics statistics = statistics_of(one);
  EXPECT_EQ(statistics.mean, 7);
  EXPECT_EQ(statistics.deviation, 0);
  EXPECT_EQ(statistics.at_percentile[0], 7);
  EXPECT_EQ(statistics.at_percentile[4], 7);
  EXPECT_TRUE(std::isnan(statistics_of(none).mean));
  EXPECT_TRUE(std::isnan(statistics_of(none).at_percentile[2]));
}

TEST(SweepStatistics, InterpolatesRowsAndNeverBeyondThem) {
  const std::vector<double> nodes = {0, 1, 3}, values = {0, 10, 2, 12, 6, 16};
  const std::vector<double> places = {-0.5, 0, 0.5, 1, 2.5, 3, 3.5};
  const std::vector<double> found = interpolate_rows(nodes, values, 2, places);
  const double expected[] = {missing, missing, 0, 10, 1, 11, 2, 12, 5, 15, 6, 16, missing, missing};
  ASSERT_EQ(found.size(), 14U);
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (std::isnan(expected[i]))
      EXPECT_TRUE(std::isnan(found[i])) << i;
    else
      EXPECT_EQ(found[i], expected[i]) << i;
  }
}

TEST(SweepStatistics, TimesThatAgreeStay) {
  const std::vector<double> times = {0, 0.7, 1.1};
  EXPECT_EQ(common_times({times, times}, 5), times);
}

TEST(SweepStatistics, TimesThatDifferBecomeMultiplesOfTheInterval) {
  EXPECT_EQ(common_times({{0, 0.7, 2}, {0, 0.8, 2}}, 0.5),
            (std::vector<double>{0, 0.5, 1, 1.5, 2}));
  EXPECT_EQ(common_times({{0, 0.7, 2.2}, {0, 1}}, 1), (std::vector<double>{0, 1, 2, 2.2}));
  // Records of every step: as many as the shortest member has.
  EXPECT_EQ(common_times({{0, 1, 2, 3, 4}, {0, 2, 4}}, 0), (std::vector<double>{0, 2, 4}));
  EXPECT_TRUE(common_times({}, 1).empty());
}

}  // namespace
}  // namespace pileus::study
