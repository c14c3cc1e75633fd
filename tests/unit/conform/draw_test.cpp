// Random values stay within what is declared, and reach its ends.
#include "conform/draw.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace pileus::conform {
namespace {

TEST(Draw, corners_reach_both_ends_and_the_smallest_numbers) {
  Random random(1);
  bool low = false, high = false, denormal = false;
  for (int draw = 0; draw < 1000; ++draw) {
    const double x = draw_corner(random, {-1, 2});
    ASSERT_GE(x, -1);
    ASSERT_LE(x, 2);
    low |= x == -1;
    high |= x == 2;
    denormal |= x > 0 && x < std::numeric_limits<double>::min();
  }
  EXPECT_TRUE(low && high && denormal);
}

TEST(Draw, spans_decades_evenly) {
  Random random(2);
  int below = 0;
  for (int draw = 0; draw < 2000; ++draw) {
    const double x = draw_between(random, {1e-6, 1e6});
    ASSERT_GE(x, 1e-6);
    ASSERT_LE(x, 1e6);
    below += x < 1 ? 1 : 0;
  }
  EXPECT_NEAR(below, 1000, 150);
}

TEST(Draw, keeps_to_the_typical_part_of_a_range) {
  const Range wide{-std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};
  EXPECT_EQ(typical_range(wide, "K", false, false).low, 260);
  EXPECT_EQ(typical_range({0, 1}, "1", false, true).high, 0.02);
  // A range that an atmosphere does not meet is taken as declared.
  EXPECT_EQ(typical_range({600, 700}, "K", false, false).low, 600);
  EXPECT_TRUE(std::isfinite(widest_range(wide, "m", false).high));
}

}  // namespace
}  // namespace pileus::conform
