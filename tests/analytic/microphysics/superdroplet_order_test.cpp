// How fast condensation converges: with the length of a step taken at once, and with the tolerance.
#include <gtest/gtest.h>

#include <cmath>

#include "superdroplet_parcel.hpp"

namespace pileus::superdroplets {
namespace {

/// A cloud of 100 per cm3 after 300 m of ascent, then 5 % of its vapour taken away.
Parcel dried_cloud() {
  Parcel parcel(9e4, 283.15, 0.98);
  for (const double nm : {40.0, 50.0, 70.0, 120.0}) parcel.add(20000000, nm * 1e-9, 0.61, 0.98);
  const Condensation scheme(epic_air(), {});
  for (int i = 0; i < 300; ++i) parcel.advance(scheme, parcel.above(1.0), 1.0);
  parcel.air.vapour *= 0.95;
  return parcel;
}

/// q_l after ten seconds in which it sinks by 10 m.
double liquid_after(double tolerance, int steps) {
  static const Parcel start = dried_cloud();
  Parcel parcel = start;
  CondensationOptions options;
  options.tolerance = tolerance;
  const Condensation scheme(epic_air(), options);
  const Level from = parcel.level, to = parcel.above(-10.0);
  for (int i = 1; i <= steps; ++i) {
    const double x = static_cast<double>(i) / steps;
    const Level level{from.pressure + x * (to.pressure - from.pressure),
                      from.exner + x * (to.exner - from.exner), 0};
    parcel.advance(scheme, level, 10.0 / steps);
  }
  return parcel.liquid();
}

TEST(SuperdropletOrder, is_two_in_the_step) {
  constexpr double at_once = 1e9;  // a tolerance that any step meets
  const double exact = liquid_after(at_once, 4096);
  double last = 0;
  for (const int steps : {16, 32, 64, 128}) {
    const double error = std::abs(liquid_after(at_once, steps) - exact);
    if (last > 0) {
      EXPECT_NEAR(std::log2(last / error), 2.0, 0.15) << steps;
    }
    last = error;
  }
  EXPECT_LT(last / exact, 1e-5);
}

TEST(SuperdropletOrder, is_one_in_the_tolerance) {
  // Sub-steps as the square root of the tolerance, error as their square.
  const double exact = liquid_after(1e9, 4096);
  const auto error = [&](double tolerance) {
    return std::abs(liquid_after(tolerance, 1) - exact) / exact;
  };
  const double coarse = error(1e-2), fine = error(1e-4);
  EXPECT_NEAR(std::log10(coarse / fine) / 2, 1.0, 0.2);
  EXPECT_LT(coarse, 1e-3);  // the default
}

}  // namespace
}  // namespace pileus::superdroplets
