// The table of radius and fall speed against the formulas it replaces.
#include "../../../plugins/superdroplets/fall_speed_table.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace pileus::superdroplets {
namespace {

/// Largest relative errors from 0.1 µm to 4 mm, away from the radii where the formula jumps or has
/// a kink: a segment is 1/32 to 1/64 of its mass long, 1 % of its radius.
void expect_close(FallSpeedScheme scheme, const std::vector<double>& kinks) {
  const FallSpeedTable table(scheme, 283.15, 9e4);
  for (double radius = 1e-7; radius < 4e-3; radius *= 1.00013) {
    const RadiusAndSpeed at = table(drops::mass_of_radius(radius));
    EXPECT_NEAR(at.radius / radius, 1.0, 3e-5) << radius;
    bool smooth = true;
    for (const double kink : kinks) smooth = smooth && std::abs(radius / kink - 1) > 0.012;
    if (!smooth) continue;
    EXPECT_NEAR(at.speed / fall_speed(scheme, radius, 283.15, 9e4), 1.0, 1e-4) << radius;
  }
}

TEST(FallSpeedTable, is_within_1e_4_of_the_formulas) {
  expect_close(FallSpeedScheme::beard_1976, {9.5e-6, 535e-6, 3.5e-3});
  expect_close(FallSpeedScheme::beard_1977, {0.5e-6, 20e-6, 3.5e-3});
  expect_close(FallSpeedScheme::rogers_yau, {30e-6, 600e-6, 2e-3});
  expect_close(FallSpeedScheme::simmel, {67.215e-6, 755.82e-6, 1738.92e-6});
  expect_close(FallSpeedScheme::rogers_1993, {0.3725e-3});
  expect_close(FallSpeedScheme::gunn_kinzer,
               {0.5e-6, 20e-6, 30e-6, 50e-6, 100e-6, 200e-6, 300e-6, 400e-6, 500e-6, 800e-6, 1e-3,
                1.5e-3, 2e-3, 2.5e-3, 2.9e-3});
}

TEST(FallSpeedTable, rises_with_the_mass_through_jumps_too) {
  const FallSpeedTable table(FallSpeedScheme::rogers_yau, 293.15, 101325.0);
  double before = 0;
  for (double mass = 1e-20; mass < 1e-4; mass *= 1.0003) {
    const double speed = table(mass).speed;
    EXPECT_GE(speed, before * (1 - 1e-14)) << mass;
    before = speed;
  }
}

TEST(FallSpeedTable, counts_what_lies_outside_as_its_nearest_end) {
  const FallSpeedTable table(FallSpeedScheme::beard_1976, 293.15, 101325.0);
  const RadiusAndSpeed small = table(FallSpeedTable::smallest);
  const RadiusAndSpeed large = table(FallSpeedTable::largest);
  EXPECT_NEAR(small.radius, drops::radius_of_mass(FallSpeedTable::smallest), 1e-22);
  EXPECT_NEAR(large.radius, drops::radius_of_mass(FallSpeedTable::largest), 1e-14);
  for (const double mass : {0.0, -1.0, 5e-324, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_EQ(table(mass).radius, small.radius);
  for (const double mass : {1.0, 1e300, std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(table(mass).radius, large.radius);
    EXPECT_EQ(table(mass).speed, large.speed);
  }
}

TEST(FallSpeedTable, without_fall_speeds_still_knows_radii) {
  const FallSpeedTable table;
  EXPECT_EQ(table(1e-12).speed, 0.0);
  EXPECT_NEAR(table(1e-12).radius / drops::radius_of_mass(1e-12), 1.0, 3e-5);
}

}  // namespace
}  // namespace pileus::superdroplets
