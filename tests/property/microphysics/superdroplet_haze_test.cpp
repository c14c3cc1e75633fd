// Haze: equilibrium stays, is approached from one side, and does not flicker at the critical size.
#include <gtest/gtest.h>

#include <cmath>

#include "../../analytic/microphysics/superdroplet_parcel.hpp"

namespace pileus::superdroplets {
namespace {

/// Air of a saturation ratio, with one droplet of so little water that it does not change that.
Parcel air_of(double saturation) {
  return Parcel(9e4, 283.15, saturation);
}
double saturation_of(const Parcel& parcel) {
  return parcel.supersaturation() + 1.0;
}

TEST(SuperdropletHaze, in_equilibrium_does_not_move_in_ten_thousand_seconds) {
  for (const double humidity : {0.3, 0.8, 0.95, 0.99, 1.0, 1.0005}) {
    for (const double dt : {0.1, 10.0, 1e4}) {
      Parcel parcel = air_of(humidity);
      parcel.add(1, 5e-8, 0.61, saturation_of(parcel));
      const double before = parcel.water[0];
      const Condensation scheme(epic_air(), {});
      for (double t = 0; t < 1e4; t += dt) parcel.advance(scheme, parcel.level, dt);
      EXPECT_NEAR(parcel.water[0] / before, 1, 1e-9) << humidity << " " << dt;
    }
  }
}

TEST(SuperdropletHaze, in_equilibrium_with_cloud_does_not_move) {
  // Much water: the droplets' equilibrium and that of the air are one.
  Parcel parcel = air_of(0.99);
  parcel.add(100000000, 1e-6, 1.2, saturation_of(parcel));
  const double before = parcel.water[0], theta = parcel.air.theta;
  const Condensation scheme(epic_air(), {});
  for (int i = 0; i < 1000; ++i) parcel.advance(scheme, parcel.level, 10.0);
  EXPECT_NEAR(parcel.water[0] / before, 1, 1e-9);
  EXPECT_NEAR(parcel.air.theta, theta, 1e-9);
}

TEST(SuperdropletHaze, approaches_equilibrium_from_one_side) {
  for (const double start : {0.3, 0.7, 0.97}) {
    for (const double humidity : {0.5, 0.9, 0.99, 1.0}) {
      for (const double dt : {1e-5, 1e-3, 0.1, 10.0, 1e4}) {
        Parcel parcel = air_of(humidity);
        parcel.add(1, 5e-8, 0.61, start);
        const double s = saturation_of(parcel);
        const double end = equilibrium_water(s, parcel.particle(0), parcel.kelvin());
        const double sign = start < humidity ? 1.0 : -1.0;
        const Condensation scheme(epic_air(), {});
        double last = parcel.water[0];
        for (int i = 0; i < 200; ++i) {
          parcel.advance(scheme, parcel.level, dt);
          const double now = parcel.water[0];
          ASSERT_GE(sign * (now - last), -1e-9 * now) << start << humidity << " " << dt << " " << i;
          ASSERT_LE(sign * (now - end), 1e-9 * end) << start << humidity << " " << dt << " " << i;
          last = now;
        }
        if (dt > 1) {
          EXPECT_NEAR(last / end, 1, 1e-9) << start << humidity << " " << dt;
        }
      }
    }
  }
}

TEST(SuperdropletHaze, at_the_critical_size_does_not_flicker) {
  // Air at, and a few roundings to either side of, the critical saturation.
  for (const double off : {-1e-7, -1e-12, 0.0, 1e-15}) {
    for (const double dt : {0.01, 1.0, 100.0}) {
      const double volume = volume_of_radius(5e-8);
      const Particle particle{volume, 0.61 * volume};
      const double length = air_of(1).kelvin();
      const CriticalPoint top = critical_point(particle, length);
      Parcel parcel = air_of(top.saturation + off);
      parcel.add({1, drops::water_density * (volume_of_radius(top.radius) - volume), volume,
                  particle.hygroscopic_volume});
      const Condensation scheme(epic_air(), {});
      double last = parcel.radius(0);
      int turns = 0, direction = 0;
      for (int i = 0; i < 1000; ++i) {
        parcel.advance(scheme, parcel.level, dt);
        const double r = parcel.radius(0);
        const int now = r > last * (1 + 1e-7) ? 1 : r < last * (1 - 1e-7) ? -1 : 0;
        if (now != 0 && direction != 0 && now != direction) ++turns;
        if (now != 0) direction = now;
        last = r;
      }
      EXPECT_EQ(turns, 0) << off << " " << dt;
      if (off <= -1e-7) {
        EXPECT_LT(last, top.radius) << off << " " << dt;
      }
    }
  }
}

TEST(SuperdropletHaze, of_many_sizes_about_the_critical_one_does_not_flicker) {
  // A parcel whose droplets hold its supersaturation between their critical ones: the number beyond
  // its critical size may only change one way at rest.
  Parcel parcel(9e4, 283.15, 1.0012);
  for (int i = 0; i < 40; ++i) parcel.add(1000000, (40 + i) * 1e-9, 0.61, 0.9999);
  const Condensation scheme(epic_air(), {});
  const auto activated = [&] {
    int count = 0;
    for (std::size_t i = 0; i < 40; ++i)
      count += parcel.radius(i) > critical_point(parcel.particle(i), parcel.kelvin()).radius;
    return count;
  };
  int changes = 0, last = activated(), direction = 0;
  for (int i = 0; i < 600; ++i) {
    parcel.advance(scheme, parcel.level, 1.0);
    const int now = activated();
    if (now != last) {
      const int sign = now > last ? 1 : -1;
      changes += direction != 0 && sign != direction;
      direction = sign;
    }
    last = now;
  }
  EXPECT_LE(changes, 1);  // up, and down once the larger ones take the vapour
}

TEST(SuperdropletHaze, below_its_critical_saturation_is_not_activated_by_long_steps) {
  // Dry haze thrown into air just below its critical saturation, where a step that overshoots would
  // land beyond the critical size.
  const double volume = volume_of_radius(5e-8);
  const Particle particle{volume, 0.61 * volume};
  const CriticalPoint top = critical_point(particle, air_of(1).kelvin());
  for (const double below : {1e-6, 1e-5, 1e-4}) {
    for (double dt = 1e-4; dt < 1e6; dt *= 3) {
      Parcel parcel = air_of(top.saturation - below);
      parcel.add(1, 5e-8, 0.61, 0.9);
      const Condensation scheme(epic_air(), {});
      for (int i = 0; i < 50; ++i) parcel.advance(scheme, parcel.level, dt);
      EXPECT_LT(parcel.radius(0), top.radius) << below << " " << dt;
    }
  }
}

}  // namespace
}  // namespace pileus::superdroplets
