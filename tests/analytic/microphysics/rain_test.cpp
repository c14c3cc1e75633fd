// Evaporation of rain against the integrated formulas.
#include <gtest/gtest.h>

#include "ascent.hpp"

namespace pileus::two_moment {
namespace {

// At 15 °C and 900 hPa the density of dry air is p/(R_d T).
constexpr double kelvin = 288.15, pascal = 9e4;

TEST(RainEvaporation, integrates_ventilated_diffusion_over_the_drops) {
  const MoistAir air = epic_air();
  const double density = air.density(kelvin, pascal);
  EXPECT_NEAR(dynamic_viscosity(kelvin) / density, 1.650513e-5, 0.6e-11);
  EXPECT_NEAR(dynamic_viscosity(kelvin) / density / vapour_diffusivity(kelvin, pascal), 0.626355,
              0.6e-6);
  const double growth = growth_coefficient(
      kelvin, pascal, thermo::saturation_pressure(kelvin).value, epic.latent_heat, 461.5);
  const auto rate = [&](double rain, double drops) {
    return -0.1 * growth * rain_exchange(rain, drops, kelvin, pascal, density);
  };
  EXPECT_NEAR(rain_slope(1e-4, 1e4), 6798.0334, 0.6e-4);
  EXPECT_NEAR(ventilated_size(rain_slope(1e-4, 1e4), kelvin, pascal, density), 3.00020590e-4,
              0.6e-12);
  EXPECT_NEAR(rate(1e-4, 1e4), -2.05455670e-7, 0.6e-15);
  EXPECT_NEAR(rain_slope(1e-3, 5e3), 2504.4169, 0.6e-4);
  EXPECT_NEAR(ventilated_size(rain_slope(1e-3, 5e3), kelvin, pascal, density), 1.54687870e-3,
              0.6e-11);
  EXPECT_NEAR(rate(1e-3, 5e3), -5.29655316e-7, 0.6e-15);
}

TEST(RainEvaporation, cools_and_moistens_by_the_same_increment_and_keeps_the_mean_size) {
  const MoistAir air = epic_air();
  const Aerosol none(0, 0, 0);
  CondensationOptions options;
  options.rain = true;
  const Condensation condensation(air, none, options);
  const Level level{pascal, thermo::exner(pascal, epic.kappa()), 0};
  Water w;
  w.theta = kelvin / level.exner;
  w.vapour = 0.9 * air.saturation(kelvin, pascal).humidity;
  w.rain = 1e-3;
  w.raindrops = 5e3;
  const Water before = w;
  condensation.advance(w, level, level, 1.0);
  // First-order in the step; the excess falls by 1 part in 2000 of itself in a second.
  EXPECT_NEAR(before.rain - w.rain, 5.29655316e-7, 1e-3 * 5.3e-7);
  EXPECT_NEAR(w.rain / w.raindrops, before.rain / before.raindrops, 1e-15 * 2e-7 * 10);
  EXPECT_NEAR(w.vapour + w.rain, before.vapour + before.rain, 4e-18);
  EXPECT_NEAR(w.theta - before.theta, -air.warming() / level.exner * (before.rain - w.rain), 6e-14);
}

TEST(RainEvaporation, does_not_grow_drops_above_saturation) {
  const MoistAir air = epic_air();
  const Aerosol none(0, 0, 0);
  CondensationOptions options;
  options.rain = true;
  const Condensation condensation(air, none, options);
  const Level level{pascal, thermo::exner(pascal, epic.kappa()), 0};
  Water w;
  w.theta = kelvin / level.exner;
  w.vapour = 1.01 * air.saturation(kelvin, pascal).humidity;
  w.rain = 1e-3;
  w.raindrops = 5e3;
  const Water before = w;
  condensation.advance(w, level, level, 10.0);
  EXPECT_EQ(w.rain, before.rain);
  EXPECT_EQ(w.vapour, before.vapour);
}

}  // namespace
}  // namespace pileus::two_moment
