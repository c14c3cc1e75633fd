// Fall speeds against tables computed by an independent program from the same formulas.
#include "../../../plugins/superdroplets/fall_speed.hpp"

#include <gtest/gtest.h>

#include <array>

namespace pileus::superdroplets {
namespace {

constexpr std::array<double, 9> radius_um = {5, 10, 20, 50, 100, 200, 500, 1000, 2000};
using Row = std::array<double, 9>;

void expect_row(FallSpeedScheme scheme, const Row& speeds, double relative) {
  for (std::size_t i = 0; i < radius_um.size(); ++i) {
    const double v = fall_speed(scheme, 1e-6 * radius_um[i], 293.15, 101325.0);
    EXPECT_NEAR(v / speeds[i], 1.0, relative) << radius_um[i];
  }
}

TEST(FallSpeed, equals_the_table_at_sea_level) {
  // Seven digits are given; four for the short form of 1993.
  expect_row(FallSpeedScheme::beard_1976,
             {3.038548e-3, 1.202383e-2, 4.704027e-2, .2494828, .6938914, 1.585993, 4.007384,
              6.509441, 8.816017},
             5e-7);
  expect_row(FallSpeedScheme::beard_1977,
             {3.038046e-3, 1.200870e-2, 4.700461e-2, .2510918, .6917717, 1.597126, 3.970940,
              6.567097, 8.827737},
             5e-7);
  expect_row(FallSpeedScheme::rogers_yau,
             {2.975e-3, 1.190e-2, 4.760e-2, .4, .8, 1.6, 4.0, 6.356178, 9.0}, 5e-7);
  expect_row(FallSpeedScheme::simmel,
             {2.974978e-3, 1.189991e-2, 4.759965e-2, .2974978, .7998704, 1.599741, 3.999352,
              6.953914, 9.17},
             5e-7);
  expect_row(
      FallSpeedScheme::rogers_1993,
      {4.523e-3, 1.707e-2, 6.099e-2, .279522, .727426, 1.586832, 3.925895, 6.508544, 8.703812},
      1.5e-4);
}

TEST(FallSpeed, of_beard_1976_knows_temperature_and_pressure) {
  const Beard1976 speed(283.15, 9e4);
  EXPECT_NEAR(speed(1e-5), 1.237040e-2, 5.1e-9);
  EXPECT_NEAR(speed(5e-5), 0.2573754, 5.1e-8);
  EXPECT_NEAR(speed(1e-4), 0.7180556, 5.1e-8);
  EXPECT_NEAR(speed(5e-4), 4.163948, 5.1e-7);
  EXPECT_NEAR(speed(1e-3), 6.768655, 5.1e-7);
  EXPECT_NEAR(Beard1976(293.15, 101325.0).viscosity, 1.820556e-5, 0.6e-11);
}

TEST(FallSpeed, regimes_of_beard_1976_meet_with_the_jumps_the_formulas_have) {
  const auto jump = [](const Beard1976& speed, double radius) {
    return speed(radius * (1 + 1e-9)) / speed(radius * (1 - 1e-9)) - 1.0;
  };
  EXPECT_NEAR(jump({293.15, 101325.0}, Beard1976::slip_radius), -1.9e-3, 1e-4);
  EXPECT_NEAR(jump({293.15, 101325.0}, Beard1976::sphere_radius), 9e-5, 1e-5);
  EXPECT_NEAR(jump({283.15, 9e4}, Beard1976::sphere_radius), -4e-4, 1e-4);
  EXPECT_EQ(Beard1976(293.15, 1e5)(3.5e-3), Beard1976(293.15, 1e5)(8e-3));
}

TEST(FallSpeed, measured_by_gunn_and_kinzer_is_within_a_percent_of_beard_for_large_drops) {
  const Beard1976 beard(293.15, 101325.0);
  EXPECT_NEAR(gunn_kinzer(0.5e-3), 4.03, 1e-12);
  EXPECT_NEAR(gunn_kinzer(0.65e-3), 4.03 + 0.5 * (5.65 - 4.03), 1e-12);
  EXPECT_EQ(gunn_kinzer(4e-3), 9.17);
  for (const double diameter : {1e-3, 1.6e-3, 2e-3, 3e-3, 4e-3, 5e-3, 5.8e-3})
    EXPECT_NEAR(beard(0.5 * diameter) / gunn_kinzer(0.5 * diameter), 1.0, 0.01) << diameter;
  // The differences that measurements and formula are known to have below.
  EXPECT_NEAR(beard(0.3e-3) / gunn_kinzer(0.3e-3), 0.99, 0.006);
  EXPECT_NEAR(beard(0.2e-3) / gunn_kinzer(0.2e-3), 0.98, 0.006);
  EXPECT_NEAR(beard(0.1e-3) / gunn_kinzer(0.1e-3), 0.96, 0.006);
  EXPECT_NEAR(beard(0.05e-3) / gunn_kinzer(0.05e-3), 0.92, 0.006);
}

TEST(FallSpeed, is_positive_and_finite_for_every_size) {
  for (const FallSpeedScheme scheme :
       {FallSpeedScheme::beard_1976, FallSpeedScheme::beard_1977, FallSpeedScheme::gunn_kinzer,
        FallSpeedScheme::rogers_yau, FallSpeedScheme::simmel, FallSpeedScheme::rogers_1993}) {
    EXPECT_EQ(fall_speed(scheme, 0.0, 280, 8e4), 0.0);
    for (double radius = 1e-9; radius < 0.1; radius *= 1.1) {
      const double v = fall_speed(scheme, radius, 280, 8e4);
      EXPECT_GT(v, 0.0) << radius;
      EXPECT_LT(v, 12.0) << radius;
    }
  }
  EXPECT_EQ(fall_speed(FallSpeedScheme::none, 1e-3, 280, 8e4), 0.0);
}

}  // namespace
}  // namespace pileus::superdroplets
