// Equal droplets without curvature or solute in a steady updraught: Rogers (1975,
// doi:10.1080/00046973.1975.9648397), fig. 1, with the paper's own air.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "superdroplet_parcel.hpp"

namespace pileus::superdroplets {
namespace {

constexpr double gas = 286.22, gravity = 9.80665, latent = 2.5e6, epsilon = 0.622, heat = 1005.0;

double saturation_pressure(double t) {
  return 2.75e11 * std::exp(-5440.0 / t);
}

/// Humidity is ε e/p.
struct RogersAir {
  double warming() const { return latent / heat; }
  double temperature(double theta, const Level& level) const { return theta * level.exner; }
  SaturationRatio saturation_ratio(double vapour, double t, double p) const {
    const double per = p / (epsilon * saturation_pressure(t));
    return {vapour * per, per, -vapour * per * 5440.0 / (t * t)};
  }
  double kelvin(double) const { return 1e-100; }
  Conductance conductance(double t, double p) const {
    const double k = 2.42e-2 * 393.0 / (t + 120.0) * std::pow(t / 273.0, 1.5);
    const double d = k * (8.28 / 2.42) * t / (10.0 * p);
    const double vapour = gas / epsilon;
    return {0,
            0,
            1e3 * vapour * t / (d * saturation_pressure(t)) +
                1e3 * latent * latent / (k * vapour * t * t),
            0,
            0,
            0};
  }
};

TEST(SuperdropletRogers, reaches_the_supersaturation_of_the_paper) {
  constexpr double t0 = 280.15, p0 = 8e4, speed = 10.0, kappa = gas / heat;
  for (const double dt : {0.1, 1.0, 5.0}) {
    Level level{p0, 1.0, 0};
    Air air{t0, epsilon * saturation_pressure(t0) / p0};
    std::vector<double> water = {drops::mass_of_radius(8e-6)};
    const std::vector<double> none = {0};
    const std::vector<std::int64_t> number = {std::llround(200e6 * gas * t0 / p0)};
    std::vector<double> scratch(BasicCondensation<RogersAir>::scratch_per_droplet);
    const BasicCondensation<RogersAir> scheme(RogersAir{}, {});
    double peak = -1, middle = 0;
    const long steps = std::lround(20.0 / dt);
    for (long i = 0; i < steps; ++i) {
      const double t = air.theta * level.exner - 0.5 * gravity * speed * dt / heat;
      const double p = level.pressure * std::exp(-gravity * speed * dt / (gas * t));
      const Level to{p, std::pow(p / p0, kappa), 0};
      const Outcome did =
          scheme.advance(air, {water, number, none, none}, 1.0, level, to, dt, scratch);
      level = to;
      peak = std::max(peak, did.largest_supersaturation);
      if (i + 1 == steps / 2) middle = drops::radius_of_mass(water[0]);
    }
    const double t = air.theta * level.exner;
    const double end = RogersAir{}.saturation_ratio(air.vapour, t, level.pressure).value - 1.0;
    const double radius = drops::radius_of_mass(water[0]);
    // The exact balance S = p q_v/(ε e_s(T)) integrated by a program of ours.
    EXPECT_NEAR(100 * peak, 0.974818, dt > 1 ? 3e-3 : 1e-3) << dt;
    EXPECT_NEAR(1e6 * middle, 8.853569, 2e-3) << dt;
    EXPECT_NEAR(1e6 * radius, 9.709818, 2e-3) << dt;
    EXPECT_NEAR(100 * end, 0.877950, 1e-3) << dt;
    EXPECT_NEAR(t, 279.041141, 5e-3) << dt;
    // The paper integrates dS/dt = Q1 U − Q2 dq_l/dt, linear about S = 1: 0.5 % less.
    EXPECT_NEAR(100 * peak, 0.970087, 0.006) << dt;
    EXPECT_NEAR(1e6 * middle, 8.84968, 0.006) << dt;
    EXPECT_NEAR(1e6 * radius, 9.70276, 0.01) << dt;
  }
}

}  // namespace
}  // namespace pileus::superdroplets
