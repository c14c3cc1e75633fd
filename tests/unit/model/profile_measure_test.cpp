// Numbers of profiles whose answers are known.
#include "model/profile_measure.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "model/slab_statistics.hpp"

namespace pileus::model {
namespace {

using Measure = ProfileMeasure;
const double none = std::nan("");

/// A parabola has its extremum where it is, between the levels: f = (z − 237)² at 100, 150, ….
TEST(ProfileMeasure, ExtremumOfAParabola) {
  std::vector<double> values, negative;
  for (int k = 0; k < 8; ++k) {
    values.push_back(std::pow(100 + 50 * k - 237, 2));
    negative.push_back(-values.back());
  }
  EXPECT_NEAR(height_of_smallest({values, 100, 50}), 237, 1e-10);
  EXPECT_NEAR(height_of_largest({negative, 100, 50}), 237, 1e-10);
  EXPECT_EQ(height_of_largest({values, 100, 50}), 450) << "an end is a level";
}

TEST(ProfileMeasure, ValuesAndExtrema) {
  const std::vector<double> values = {1, 3, 2, none, 5};
  const Profile profile{values, 0, 10};
  EXPECT_EQ(measure(profile, Measure::value, 15, 15), 2.5);
  EXPECT_EQ(measure(profile, Measure::value, 0, 0), 1);
  EXPECT_EQ(measure(profile, Measure::value, 40, 40), 5);
  EXPECT_EQ(measure(profile, Measure::mean, 0, 20), 2);
  EXPECT_EQ(measure(profile, Measure::min, 10, 40), 2);
  EXPECT_EQ(measure(profile, Measure::max, 0, 30), 3);
  EXPECT_EQ(measure(profile, Measure::height_of_max, 0, 30), 10);
  EXPECT_EQ(measure(profile, Measure::height_of_min, 10, 40), 20);
  EXPECT_TRUE(std::isnan(measure(profile, Measure::mean, 30, 30)));
  EXPECT_TRUE(std::isnan(measure(profile, Measure::value, 25, 25)));
}

/// A straight line, and one with its middle bent by 3: of levels 0 to 4, the least-squares line is
/// 3/5 above the unbent one, so that the middle deviates by 12/5.
TEST(ProfileMeasure, LineAndDeviationFromIt) {
  std::vector<double> values = {2, 4, 6, 8, 10};
  EXPECT_NEAR(measure({values, 0, 10}, Measure::slope, 0, 40), 0.2, 1e-15);
  EXPECT_NEAR(measure({values, 0, 10}, Measure::nonlinearity, 0, 40), 0, 1e-15);
  values[2] += 3;
  EXPECT_NEAR(measure({values, 0, 10}, Measure::slope, 0, 40), 0.2, 1e-15);
  EXPECT_NEAR(measure({values, 0, 10}, Measure::nonlinearity, 0, 40), 2.4 / 10.6, 1e-15);
}

/// The law of the wall over a bottom that is not at zero; what lies on the bottom does not count.
TEST(ProfileMeasure, SlopeOverTheLogarithmOfTheHeight) {
  std::vector<double> wind(9, -5.0);
  for (std::size_t k = 1; k < wind.size(); ++k)
    wind[k] = 1.25 * std::log(62.5 * static_cast<double>(k) / 0.1);
  const Profile profile{wind, 300, 62.5};
  EXPECT_NEAR(measure(profile, Measure::logarithmic_slope, 300, 800), 1.25, 1e-14);
  EXPECT_NEAR(measure(profile, Measure::logarithmic_slope, 425, 550), 1.25, 1e-14);
  EXPECT_TRUE(std::isnan(measure(profile, Measure::logarithmic_slope, 300, 362.5)));
}

TEST(ProfileMeasure, UnitsOfProducts) {
  EXPECT_EQ(product_of_units("m s-1", "m s-1"), "m2 s-2");
  EXPECT_EQ(product_of_units("m s-2", "m s-1"), "m2 s-3");
  EXPECT_EQ(product_of_units("K", "m s-1"), "K m s-1");
  EXPECT_EQ(product_of_units("1", "m s-1"), "m s-1");
  EXPECT_EQ(product_of_units("1", "1"), "1");
  EXPECT_EQ(product_of_units("m s-1", "m-1"), "s-1");
  EXPECT_EQ(product_of_units("g/kg", "m s-1"), "(g/kg) (m s-1)");
}

}  // namespace
}  // namespace pileus::model
