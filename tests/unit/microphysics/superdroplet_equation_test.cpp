// A droplet's implicit equation: its derivatives and which of its roots a droplet takes.
#include <gtest/gtest.h>

#include <cmath>

#include "../../analytic/microphysics/superdroplet_parcel.hpp"

namespace pileus::superdroplets {
namespace {

DropletEquation equation_of(double duration) {
  const DropletAir air = epic_air();
  return {duration, air.kelvin(283.15), air.conductance(283.15, 9e4)};
}

DropletConstants constants_of(double radius, double kappa) {
  const double cube = radius * radius * radius, core = std::max(radius, smallest_radius);
  return {cube, kappa * cube, core * core, 1.0};
}

TEST(DropletEquation, slopes_are_the_derivatives) {
  const DropletEquation e = equation_of(0.5);
  const DropletConstants c = constants_of(5e-8, 0.61);
  for (const double r : {5.5e-8, 2e-7, 4.6e-7, 3e-6, 1e-4}) {
    const double u = r * r, h = 1e-6 * u;
    const double secant =
        (e.at(u + h, u, 1.001, c).residual - e.at(u - h, u, 1.001, c).residual) / (2 * h);
    EXPECT_NEAR(e.at(u, u, 1.001, c).slope / secant, 1, 1e-6) << r;
    const double drive = (e.at(u, u, 1.0, c).residual - e.at(u, u, 1.002, c).residual) / 0.002;
    EXPECT_NEAR(e.at(u, u, 1.001, c).drive / drive, 1, 1e-6) << r;
  }
}

TEST(DropletEquation, is_that_of_koehler_and_growth) {
  const DropletEquation e = equation_of(2.0);
  const double volume = volume_of_radius(5e-8);
  for (const double r : {6e-8, 4e-7, 1e-5}) {
    const double s = equilibrium_saturation(r, {volume, 0.61 * volume}, e.kelvin).value;
    const double step = 2.0 * 2.0 * (1.002 - s) * e.conductance.at(r).value;
    EXPECT_NEAR(e.at(r * r, 1e-14, 1.002, constants_of(5e-8, 0.61)).residual, r * r - 1e-14 - step,
                1e-12 * (r * r + 1e-14 + std::abs(step)));
  }
}

TEST(DropletEquation, haze_below_its_critical_saturation_stays_haze_for_every_duration) {
  // At S between 1 and S_c the equation has three roots for long durations: haze, an unstable
  // equilibrium, and a droplet that grows.
  const DropletConstants c = constants_of(5e-8, 0.61);
  const double volume = volume_of_radius(5e-8);
  const Particle p{volume, 0.61 * volume};
  for (double duration = 1e-3; duration < 1e7; duration *= 10) {
    const DropletEquation e = equation_of(duration);
    const CriticalPoint top = critical_point(p, e.kelvin);
    const double s = 1 + 0.99 * (top.saturation - 1);
    const double haze = wet_radius(equilibrium_water(s, p, e.kelvin), volume);
    const double u = e.root(1e-14, s, c);
    EXPECT_LE(u, haze * haze * (1 + 1e-9)) << duration;
    EXPECT_GE(u, 1e-14) << duration;
    const DropletEquation::Terms haze_terms = e.at(u, 1e-14, s, c);
    EXPECT_NEAR(haze_terms.residual / haze_terms.slope, 0, 1e-9 * u);
    // Above it, it grows; and a droplet already beyond the unstable equilibrium grows at S too.
    const double above = e.root(haze * haze, 1 + 1.5 * (top.saturation - 1), c);
    EXPECT_GT(above, haze * haze);
    const double grown = 4 * top.radius * top.radius * 25;
    EXPECT_GT(e.root(grown, s, c), grown);
  }
}

TEST(DropletEquation, droplets_shrink_to_haze_and_pure_ones_to_nothing) {
  for (double duration = 1e-3; duration < 1e7; duration *= 10) {
    const DropletEquation e = equation_of(duration);
    const DropletConstants c = constants_of(5e-8, 0.61), pure = constants_of(0, 0);
    const double u = e.root(1e-10, 0.9, c);
    EXPECT_LT(u, 1e-10);
    EXPECT_GT(u, c.floor);
    const DropletEquation::Terms terms = e.at(u, 1e-10, 0.9, c);
    EXPECT_NEAR(terms.residual / terms.slope, 0, 1e-9 * u);
    const double v = e.root(1e-10, 0.9, pure);
    EXPECT_LT(v, 1e-10);
    // 2·1e-10·0.1 m2 s-1: gone after some 5 s; to backward Euler, which sees how slowly the
    // smallest exchange, somewhat later.
    if (duration > 50) {
      EXPECT_EQ(v, pure.floor) << duration;
    } else {
      EXPECT_GT(v, pure.floor) << duration;
    }
  }
}

TEST(DropletEquation, root_rises_with_the_saturation) {
  for (double duration = 1e-3; duration < 1e7; duration *= 10) {
    const DropletEquation e = equation_of(duration);
    for (const DropletConstants& c : {constants_of(5e-8, 0.61), constants_of(1e-6, 0.0),
                                      constants_of(0, 0), constants_of(1e-8, 1.3)}) {
      for (const double r : {1.2e-6, 3e-6, 1e-5, 1e-3}) {
        double last = 0;
        for (double s = 0; s<3; s += s> 0.95 && s < 1.05 ? 0.0007 : 0.05) {
          const double u = e.root(r * r, s, c);
          EXPECT_GE(u, last * (1 - 1e-9)) << duration << " " << r << " " << s;
          last = u;
        }
      }
    }
  }
}

}  // namespace
}  // namespace pileus::superdroplets
