// How fast droplets grow, against numbers that another program computed.
#include <gtest/gtest.h>

#include <cmath>

#include "../../../plugins/superdroplets/koehler.hpp"
#include "superdroplet_parcel.hpp"

namespace pileus::superdroplets {
namespace {

TEST(SuperdropletGrowth, of_a_droplet_at_half_a_percent_with_and_without_jumps) {
  // r dr/dt (m2 s-1) at S = 1.005, 283.15 K, 900 hPa of r_d 50 nm, κ 0.61; 9 digits.
  const struct {
    double radius, kinetic, continuous;
  } rows[] = {{1e-6, 3.35964048e-13, 3.70848412e-13},
              {5e-6, 4.37694854e-13, 4.46109121e-13},
              {1e-5, 4.52049126e-13, 4.56345190e-13},
              {2e-5, 4.59311662e-13, 4.61481484e-13}};
  DropletAir air = epic_air();
  const double volume = volume_of_radius(50e-9), length = air.kelvin(283.15);
  for (const auto& row : rows) {
    const double excess =
        1.005 - equilibrium_saturation(row.radius, {volume, 0.61 * volume}, length).value;
    air.kinetic = true;
    EXPECT_NEAR(excess * air.conductance(283.15, 9e4).at(row.radius).value / row.kinetic, 1, 2e-9);
    air.kinetic = false;
    EXPECT_NEAR(excess * air.conductance(283.15, 9e4).at(row.radius).value / row.continuous, 1,
                2e-9);
  }
}

TEST(SuperdropletGrowth, conductance_is_the_two_resistances_in_series) {
  const double e = thermo::saturation_pressure(275.0).value;
  const GrowthAir air = growth_air(275.0, 7e4, e, epic);
  const Accommodation share{0.3, 0.8};
  const auto beta = [](double length, double alpha, double r) {
    const double kn = length / r, a = 4.0 / (3.0 * alpha);
    return (1 + kn) / (1 + (a + 0.377) * kn + a * kn * kn);
  };
  const Conductance all = conductance(air, share, true);
  for (double r = 1e-10; r < 1e-2; r *= 1.9) {
    const double direct = 1.0 / (air.diffusion / beta(air.vapour_length, 0.3, r) +
                                 air.conduction / beta(air.heat_length, 0.8, r));
    EXPECT_NEAR(all.at(r).value, direct, 1e-14 * direct) << r;
    EXPECT_LT(all.at(r).value, all.largest());
    const double h = 1e-5 * r, secant = (all.at(r + h).value - all.at(r - h).value) / (2 * h);
    EXPECT_NEAR(all.at(r).slope, secant, 1e-8 * secant + 1e-9 * direct / r) << r;
  }
}

TEST(SuperdropletGrowth, ventilation_is_continuous_and_one_at_rest) {
  EXPECT_EQ(ventilation(0.7, 0.0), 1.0);
  // X = 1.4: 1 + 0.108·1.96 = 1.21168 and 0.78 + 0.308·1.4 = 1.2112.
  EXPECT_NEAR(ventilation(1.0, 1.95999), 1.21168, 1e-5);
  EXPECT_NEAR(ventilation(1.0, 1.96001), 1.2112, 1e-5);
}

}  // namespace
}  // namespace pileus::superdroplets
