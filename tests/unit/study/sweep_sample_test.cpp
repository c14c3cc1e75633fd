// Samples of the unit cube: what is published, and what their names promise.
#include "study/sweep_sample.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace pileus::study {
namespace {

TEST(SweepSample, SobolBeginsAsPublished) {
  // The ten points in three dimensions that Joe and Kuo print with their direction numbers
  // new-joe-kuo-6.21201 (doi:10.1137/070709359; "Notes on generating Sobol sequences", 2008).
  const double published[10][3] = {{0, 0, 0},
                                   {0.5, 0.5, 0.5},
                                   {0.75, 0.25, 0.25},
                                   {0.25, 0.75, 0.75},
                                   {0.375, 0.375, 0.625},
                                   {0.875, 0.875, 0.125},
                                   {0.625, 0.125, 0.875},
                                   {0.125, 0.625, 0.375},
                                   {0.1875, 0.3125, 0.9375},
                                   {0.6875, 0.8125, 0.4375}};
  const auto points = sample_unit_cube(SampleMethod::sobol, 10, 3, 0);
  for (std::size_t p = 0; p < 10; ++p)
    for (std::size_t d = 0; d < 3; ++d) EXPECT_EQ(points[p][d], published[p][d]) << p << ", " << d;
}

TEST(SweepSample, SobolIsANetInEveryDimensionAlsoWhenShifted) {
  for (const std::uint64_t seed : {0U, 1U, 77U}) {
    const auto points = sample_unit_cube(SampleMethod::sobol, 64, 12, seed);
    for (std::size_t d = 0; d < 12; ++d) {
      std::set<int> strata;
      for (const auto& point : points) {
        EXPECT_GE(point[d], 0);
        EXPECT_LT(point[d], 1);
        strata.insert(static_cast<int>(64 * point[d]));
      }
      EXPECT_EQ(strata.size(), 64U) << "dimension " << d << ", seed " << seed;
    }
  }
}

TEST(SweepSample, LatinHypercubeHasOnePointInEveryStratum) {
  for (const std::size_t count : {1U, 2U, 7U, 100U}) {
    const auto points = sample_unit_cube(SampleMethod::latin_hypercube, count, 5, 3);
    for (std::size_t d = 0; d < 5; ++d) {
      std::set<std::size_t> strata;
      for (const auto& point : points)
        strata.insert(static_cast<std::size_t>(point[d] * static_cast<double>(count)));
      EXPECT_EQ(strata.size(), count);
      EXPECT_LT(*strata.rbegin(), count);
    }
  }
}

TEST(SweepSample, DimensionsOfALatinHypercubeAreOrderedDifferently) {
  const auto points = sample_unit_cube(SampleMethod::latin_hypercube, 200, 2, 1);
  double correlation = 0;  // of two independent orders: zero within 1/√n
  for (const auto& point : points) correlation += 12 * (point[0] - 0.5) * (point[1] - 0.5) / 200;
  EXPECT_LT(std::abs(correlation), 4 / std::sqrt(200.0));
}

TEST(SweepSample, RandomPointsAreUniform) {
  const std::size_t count = 4000;
  const auto points = sample_unit_cube(SampleMethod::random, count, 2, 5);
  for (std::size_t d = 0; d < 2; ++d) {
    double mean = 0, square = 0;
    for (const auto& point : points) {
      mean += point[d] / static_cast<double>(count);
      square += point[d] * point[d] / static_cast<double>(count);
    }
    // Four standard errors of the moments of a uniform variate.
    EXPECT_NEAR(mean, 0.5, 4 * std::sqrt(1.0 / 12 / static_cast<double>(count)));
    EXPECT_NEAR(square, 1.0 / 3, 4 * std::sqrt(4.0 / 45 / static_cast<double>(count)));
  }
}

TEST(SweepSample, SeedsAndOnlySeedsChangeIt) {
  for (const auto method :
       {SampleMethod::random, SampleMethod::latin_hypercube, SampleMethod::sobol}) {
    EXPECT_EQ(sample_unit_cube(method, 9, 3, 4), sample_unit_cube(method, 9, 3, 4));
    EXPECT_NE(sample_unit_cube(method, 9, 3, 4), sample_unit_cube(method, 9, 3, 5));
  }
}

TEST(SweepSample, MorePointsBeginWithTheSameOnes) {
  for (const auto method : {SampleMethod::random, SampleMethod::sobol}) {
    const auto few = sample_unit_cube(method, 5, 2, 8), many = sample_unit_cube(method, 50, 2, 8);
    EXPECT_TRUE(std::equal(few.begin(), few.end(), many.begin()));
  }
}

TEST(SweepSample, IsTheSameOnEveryMachine) {
  // By an implementation of Philox4x32-10 (doi:10.1145/2063384.2063405) of its own, with the keys
  // that pileus/philox.hpp documents.
  EXPECT_EQ(sample_unit_cube(SampleMethod::random, 2, 2, 1),
            (std::vector<std::vector<double>>{{0.655106709137863, 0.21473061754741252},
                                              {0.5683073149780243, 0.9854404624726888}}));
}

}  // namespace
}  // namespace pileus::study
