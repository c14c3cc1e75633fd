// One kind of particle up and down again: activation, deactivation and reversibility.
//
// Arabas & Shima (2017, doi:10.5194/npg-24-535-2017): 300 K, 1000 hPa, 98 %, κ 1.28, w = w_a (π/2)
// sin(π t w_a/150 m) up and down by 150 m; numbers at 288.15 K and 1013.25 hPa. The reference
// solution (LSODA) and the same repeated by a program of ours with S = e/e_s, which agrees to its
// digits with steps of 0.1 s.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "superdroplet_parcel.hpp"

namespace pileus::superdroplets {
namespace {

struct Case {
  double speed, number, radius;                             // m s-1, cm-3, µm
  double percent, activated, deactivated, top, end_radius;  // reference: %, s, s, µm, µm
  double repeated_percent, repeated_activated, repeated_deactivated, repeated_top;
};
constexpr Case cases[] = {
    {1.0, 50, 0.1, 0.90689, 60.5, 260.2, 11.42524, 0.383043, 0.90490, 60.6, 260.2, 11.43313},
    {1.0, 50, 0.05, 0.93137, 57.6, 261.4, 11.42505, 0.184030, 0.92939, 57.7, 261.4, 11.43294},
    {1.0, 500, 0.1, 0.28315, 61.9, 245.0, 5.32256, 0.383066, 0.28263, 62.0, 245.0, 5.31503},
    {0.5, 50, 0.1, 0.54130, 117.6, 507.3, 11.46334, 0.383057, 0.54025, 117.8, 507.2, 11.45213},
    {0.5, 50, 0.05, 0.56816, 114.1, 509.2, 11.46315, 0.184036, 0.56713, 114.3, 509.1, 11.45195},
    {0.5, 500, 0.1, 0.17202, 120.7, 486.8, 5.32338, 0.383070, 0.17173, 120.9, 486.7, 5.31545}};
/// Slow: only repeated.
constexpr Case slow[] = {{0.002, 50, 0.1, 0, 0, 0, 0, 0.383073, 0.04120, 27750, 122328, 11.45842},
                         {0.002, 50, 0.05, 0, 0, 0, 0, 0.184044, 0.10656, 28061, 122309, 11.45823},
                         {0.002, 500, 0.1, 0, 0, 0, 0, 0.383073, 0.03672, 29241, 120768, 5.31560}};

struct Course {
  double peak = -1, activated = 0, deactivated = 0, top = 0;
  double saturation_up = 0, saturation_down = 0;  // S − 1 when it was activated, deactivated
  double radius = 0, kelvin = 0, supersaturation = 0;
  int crossings = 0;
};

/// The crossing of r_c between two steps is found by interpolation of ln(r/r_c).
Course run(const Case& c, double dt) {
  Parcel parcel(1e5, 300, 0.98);
  const double standard = 101325 / (epic.gas_constant_dry_air * 288.15);
  parcel.add(std::llround(c.number * 1e6 / standard), c.radius * 1e-6, 1.28, 0.98);
  const Condensation scheme(epic_air(), {});
  const auto height = [&](double t) {
    return 75 * (1 - std::cos(std::numbers::pi * t * c.speed / 150));
  };
  const auto distance = [&] {
    return std::log(parcel.radius(0) / critical_point(parcel.particle(0), parcel.kelvin()).radius);
  };
  Course found;
  double before = distance();
  const long steps = std::lround(300 / c.speed / dt);
  for (long i = 0; i < steps; ++i) {
    const double t = static_cast<double>(i) * dt;
    const Outcome did = parcel.advance(scheme, parcel.above(height(t + dt) - height(t)), dt);
    found.peak = std::max(found.peak, did.largest_supersaturation);
    found.top = std::max(found.top, parcel.radius(0));
    const double now = distance();
    if ((now > 0) != (before > 0)) {
      ++found.crossings;
      const double at = t + dt * before / (before - now);
      (now > 0 ? found.activated : found.deactivated) = at;
      (now > 0 ? found.saturation_up : found.saturation_down) = parcel.supersaturation();
    }
    before = now;
  }
  found.radius = parcel.radius(0);
  found.kelvin = parcel.temperature();
  found.supersaturation = parcel.supersaturation();
  return found;
}

TEST(SuperdropletHysteresis, equals_the_reference_with_steps_of_a_second) {
  for (const Case& c : cases) {
    const Course found = run(c, 1.0);
    EXPECT_NEAR(100 * found.peak / c.percent, 1, 0.005) << c.speed << " " << c.number;
    EXPECT_NEAR(found.activated, c.activated, 0.5) << c.speed << " " << c.number;
    EXPECT_NEAR(found.deactivated, c.deactivated, 0.5) << c.speed << " " << c.number;
    EXPECT_NEAR(1e6 * found.top / c.top, 1, 0.005) << c.speed << " " << c.number;
    EXPECT_NEAR(1e6 * found.radius / c.end_radius, 1, 0.005) << c.speed << " " << c.number;
    EXPECT_NEAR(found.kelvin, 300, 1e-4) << c.speed << " " << c.number;
    EXPECT_NEAR(found.supersaturation, -0.02, 1e-4) << c.speed << " " << c.number;
    EXPECT_EQ(found.crossings, 2);
    EXPECT_LT(found.saturation_down, found.saturation_up);
  }
}

TEST(SuperdropletHysteresis, equals_the_repeated_solution_with_steps_of_a_tenth) {
  for (const Case& c : cases) {
    const Course found = run(c, 0.1);
    EXPECT_NEAR(100 * found.peak / c.repeated_percent, 1, 1e-4) << c.speed << " " << c.number;
    EXPECT_NEAR(found.activated, c.repeated_activated, 0.11) << c.speed << " " << c.number;
    EXPECT_NEAR(found.deactivated, c.repeated_deactivated, 0.11) << c.speed << " " << c.number;
    EXPECT_NEAR(1e6 * found.top / c.repeated_top, 1, 1e-5) << c.speed << " " << c.number;
  }
}

TEST(SuperdropletHysteresis, of_the_slowest_ascent_needs_no_short_steps) {
  for (const Case& c : slow) {
    const Course found = run(c, 30.0);
    EXPECT_NEAR(100 * found.peak / c.repeated_percent, 1, 5e-3) << c.number << " " << c.radius;
    EXPECT_NEAR(found.activated, c.repeated_activated, 30) << c.number << " " << c.radius;
    EXPECT_NEAR(found.deactivated, c.repeated_deactivated, 30) << c.number << " " << c.radius;
    EXPECT_NEAR(1e6 * found.top / c.repeated_top, 1, 1e-4) << c.number << " " << c.radius;
    EXPECT_NEAR(1e6 * found.radius / c.end_radius, 1, 1e-4) << c.number << " " << c.radius;
    EXPECT_EQ(found.crossings, 2);
  }
}

}  // namespace
}  // namespace pileus::superdroplets
