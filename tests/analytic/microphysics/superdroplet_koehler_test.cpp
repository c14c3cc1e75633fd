// Equilibrium of droplets against critical points and radii that another program computed.
#include <gtest/gtest.h>

#include <cmath>

#include "../../../plugins/superdroplets/koehler.hpp"

namespace pileus::superdroplets {
namespace {

constexpr double vapour_constant = 461.5, tension = 0.072;

Particle particle(double radius, double kappa) {
  const double volume = volume_of_radius(radius);
  return {volume, kappa * volume};
}

TEST(SuperdropletKoehler, critical_points_are_those_of_the_full_formula) {
  // κ, r_d (nm), T → r_c (µm), S_c − 1 (%), maximised by an independent program; 6 and 5 digits.
  const struct {
    double kappa, nm, kelvin, um, percent;
  } points[] = {{0.61, 50, 293.15, 0.463989, 0.153117}, {1.28, 50, 293.15, 0.671637, 0.105715},
                {0.61, 20, 283.15, 0.115677, 0.638261}, {0.61, 100, 283.15, 1.289079, 0.057016},
                {0.10, 50, 283.15, 0.187837, 0.395396}, {1.28, 100, 300.0, 1.921555, 0.036092}};
  for (const auto& p : points) {
    const double length = kelvin_length(p.kelvin, vapour_constant, tension);
    const CriticalPoint found = critical_point(particle(p.nm * 1e-9, p.kappa), length);
    EXPECT_NEAR(found.radius * 1e6, p.um, 1e-5 * p.um) << p.kappa << " " << p.nm;
    EXPECT_NEAR(100 * (found.saturation - 1), p.percent, 1e-5 * p.percent + 5e-7) << p.kappa;
  }
}

TEST(SuperdropletKoehler, nothing_is_steeper_than_the_critical_point) {
  for (const double kappa : {1e-6, 0.01, 0.61, 1.3}) {
    for (const double nm : {1.0, 10.0, 1000.0, 1e5}) {
      const Particle p = particle(nm * 1e-9, kappa);
      const double length = kelvin_length(283.15, vapour_constant, tension);
      const CriticalPoint c = critical_point(p, length);
      EXPECT_NEAR(equilibrium_saturation(c.radius, p, length).value, c.saturation, 1e-12);
      for (const double factor : {0.9, 0.99, 1.01, 1.1})
        EXPECT_LT(equilibrium_saturation(c.radius * factor, p, length).value, c.saturation);
    }
  }
}

TEST(SuperdropletKoehler, radii_at_a_humidity_are_those_of_the_full_formula) {
  // r_d 50 nm, κ 0.61, 283.15 K; computed by an independent program.
  const Particle p = particle(50e-9, 0.61);
  const double length = kelvin_length(283.15, vapour_constant, tension);
  const double humidity[] = {0.8, 0.95, 0.99, 0.9999};
  const double radius[] = {7.42155154e-8, 1.09997612e-7, 1.67128524e-7, 2.60630418e-7};
  for (int i = 0; i < 4; ++i)
    EXPECT_NEAR(wet_radius(equilibrium_water(humidity[i], p, length), p.dry_volume), radius[i],
                1e-8 * radius[i]);
}

TEST(SuperdropletKoehler, slope_is_the_derivative) {
  const Particle p = particle(50e-9, 0.61);
  const double length = 1.1e-9, h = 1e-13;
  for (const double r : {5.1e-8, 1e-7, 4.6e-7, 1e-5}) {
    const double secant = (equilibrium_saturation(r + h, p, length).value -
                           equilibrium_saturation(r - h, p, length).value) /
                          (2 * h);
    // Rounding of S, 1e-16, over the difference of r.
    EXPECT_NEAR(equilibrium_saturation(r, p, length).slope, secant, 2e-3 + 1e-6 * std::abs(secant));
  }
}

TEST(SuperdropletKoehler, equilibrium_stays_between_dry_and_critical_size) {
  const double length = kelvin_length(283.15, vapour_constant, tension);
  for (const double kappa : {0.0, 1e-9, 0.1, 1.3}) {
    for (const double nm : {0.1, 1.0, 50.0, 1e4, 1e7}) {
      const Particle p = particle(nm * 1e-9, kappa);
      const double top = volume_of_radius(critical_point(p, length).radius) - p.dry_volume;
      double last = 0;
      for (const double s : {0.0, 1e-9, 0.5, 0.999999, 1.0, 1.0001, 1.1, 10.0}) {
        const double volume = equilibrium_water(s, p, length) / drops::water_density;
        EXPECT_GE(volume, last);
        EXPECT_LE(volume, std::max(0.0, top) + 1e-12 * p.dry_volume);
        last = volume;
      }
    }
  }
}

TEST(SuperdropletKoehler, pure_water_and_insoluble_particles_have_the_curvature_alone) {
  const double length = 1.1e-9;
  EXPECT_EQ(equilibrium_saturation(1e-6, {}, length).value, std::exp(1.1e-3));
  EXPECT_EQ(equilibrium_water(0.99, {}, length), 0.0);
  EXPECT_EQ(critical_point({}, length).radius, 0.0);
  const CriticalPoint dust = critical_point({volume_of_radius(1e-6), 0.0}, length);
  EXPECT_NEAR(dust.radius, 1e-6, 1e-21);
  EXPECT_NEAR(dust.saturation, std::exp(1.1e-3), 1e-15);
}

}  // namespace
}  // namespace pileus::superdroplets
