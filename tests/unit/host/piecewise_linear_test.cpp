// Profiles that two list parameters stand for.
#include "pileus/piecewise_linear.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace pileus {
namespace {

using List = std::vector<double>;

PiecewiseLinear profile(const List& heights, const List& values) {
  return profile_of_lists({"height", heights}, {"temperature", values});
}

std::string refusal(const List& heights, const List& values) {
  try {
    profile(heights, values);
  } catch (const Failure& failure) {
    EXPECT_EQ(failure.status, PILEUS_E_CONFIG);
    return failure.what();
  }
  return "";
}

TEST(ProfileOfLists, is_linear_between_its_heights_and_constant_beyond) {
  const PiecewiseLinear p = profile({0, 10, 30}, {1, 2, 6});
  for (const auto& [z, value, slope] : {std::array{-5.0, 1.0, 0.0}, std::array{5.0, 1.5, 0.1},
                                        std::array{20.0, 4.0, 0.2}, std::array{40.0, 6.0, 0.0}}) {
    EXPECT_DOUBLE_EQ(p(z), value);
    EXPECT_DOUBLE_EQ(p.derivative(z), slope);
  }
  EXPECT_EQ(p(std::nan("")), 1.0);
}

TEST(ProfileOfLists, takes_one_value_for_all_heights) {
  for (const double z : {-1e6, 0.0, 15.0, 1e6}) {
    EXPECT_EQ(profile({0, 10, 30}, {7})(z), 7);
    EXPECT_EQ(profile({20}, {7})(z), 7);
  }
  EXPECT_TRUE(profile({0, 10}, {0}).is_zero());
}

TEST(ProfileOfLists, refuses_what_is_no_profile) {
  EXPECT_EQ(refusal({0, 10, 10}, {1, 2, 3}),
            "height does not ascend; order its values from low to high");
  EXPECT_EQ(refusal({0, std::nan(""), 10}, {1}),
            "height does not ascend; order its values from low to high");
  EXPECT_EQ(refusal({0, 10}, {1, 2, 3}), "temperature needs one value, or one for each height");
}

}  // namespace
}  // namespace pileus
