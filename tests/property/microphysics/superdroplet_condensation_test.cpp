// Condensation on superdroplets for states of the whole admissible range and steps of any length:
// nothing becomes negative or infinite, water and heat are conserved.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "../../analytic/microphysics/superdroplet_parcel.hpp"

namespace pileus::superdroplets {
namespace {

class Draws {
 public:
  explicit Draws(unsigned seed) : random_(seed) {}
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  double logarithmic(double low, double high) {
    return std::exp(uniform(std::log(low), std::log(high)));
  }
  bool one_in(unsigned n) { return random_() % n == 0; }

 private:
  std::mt19937_64 random_;
};

/// Dry particles, haze, cloud and rain drops, pure, insoluble or soluble.
Superdroplet draw_droplet(Draws& draw, double saturation, double most) {
  double volume = draw.one_in(4) ? 0.0 : volume_of_radius(draw.logarithmic(1e-9, 5e-6));
  if (draw.one_in(50)) volume = 1e-40;
  const double solute = draw.one_in(5) ? 0.0 : draw.uniform(0, 1.3) * volume;
  double mass = drops::mass_of_radius(draw.logarithmic(1e-9, 3e-3));
  if (draw.one_in(5)) mass = 0;
  if (draw.one_in(4)) mass = equilibrium_water(saturation, {volume, solute}, 1.2e-9);
  auto number = static_cast<std::int64_t>(draw.uniform(1, most));
  while (number > 1 && static_cast<double>(number) * mass > 0.02) number /= 10;
  return {number, mass, volume, solute};
}

struct Trial {
  DropletAir air = epic_air();
  Parcel parcel{9e4, 283.15, 1.0};
  Level to{};
  double dt = 0;
};

Trial draw_trial(Draws& draw, bool wild) {
  Trial t;
  if (draw.one_in(3)) t.air.air.measure = HumidityMeasure::specific_humidity;
  if (draw.one_in(5)) t.air.air.prescribed_temperature = true;
  if (draw.one_in(5)) t.air.kinetic = false;
  if (draw.one_in(9)) t.air.surface_tension = 0;
  const double pressure = wild ? draw.logarithmic(5e3, 1.1e5) : draw.uniform(3e4, 1.05e5);
  const double kelvin = wild ? draw.uniform(105, 420) : draw.uniform(200, 310);
  t.parcel = Parcel(pressure, kelvin, 0.0);
  t.parcel.level.prescribed = kelvin;
  t.to = draw.one_in(3) ? t.parcel.level : level_of(pressure * draw.uniform(0.95, 1.05));
  t.to.prescribed = kelvin + draw.uniform(-2, 2);
  double saturation = draw.uniform(0.9, 1.1);
  if (draw.one_in(6)) saturation = 0;
  if (draw.one_in(6)) saturation = 1;
  if (draw.one_in(6)) saturation = draw.uniform(0, 10);
  t.parcel.air.vapour = std::min(0.5, saturation * t.air.air.saturation(kelvin, pressure).humidity);
  const double most = draw.logarithmic(2, 1e12);
  for (int n = 1 + static_cast<int>(draw.uniform(0, 20)); n > 0; --n)
    t.parcel.add(draw_droplet(draw, saturation, most));
  t.dt = draw.logarithmic(1e-3, 1e6);
  return t;
}

void run(unsigned seed, bool wild, int count) {
  Draws draw(seed);
  for (int i = 0; i < count; ++i) {
    Trial t = draw_trial(draw, wild);
    Parcel& p = t.parcel;
    const bool still = p.level.exner == t.to.exner;
    const double vapour = p.air.vapour, liquid = p.liquid(), theta = p.air.theta;
    const Condensation scheme(t.air, {});
    const Outcome did = p.advance(scheme, t.to, t.dt);
    for (const double mass : p.water) {
      ASSERT_TRUE(std::isfinite(mass)) << i;
      ASSERT_GE(mass, 0.0) << i;
    }
    ASSERT_TRUE(std::isfinite(p.air.theta)) << i;
    ASSERT_GT(p.temperature(), 90.0) << i;
    ASSERT_GE(p.air.vapour, 0.0) << i;
    ASSERT_TRUE(std::isfinite(did.largest_supersaturation)) << i;
    ASSERT_LE(did.substeps + did.rejected, CondensationOptions{}.most_substeps + 1) << i;
    // One change, of the two sums of water, to a few units in the last place of either.
    ASSERT_NEAR(p.air.vapour + p.liquid(), vapour + liquid, 1e-15 * (vapour + liquid) + 1e-200)
        << i;
    if (t.air.air.prescribed_temperature) {
      ASSERT_EQ(p.air.theta, theta) << i;
    } else if (still) {
      const double condensed = p.liquid() - liquid;
      ASSERT_NEAR(p.air.theta - theta, t.air.warming() / t.to.exner * condensed,
                  (did.substeps + 2) * 2.3e-16 * (p.air.theta + theta))
          << i;
    }
  }
}

TEST(SuperdropletCondensation, stays_admissible_and_conserves_in_the_troposphere) {
  run(1, false, 2000);
}

TEST(SuperdropletCondensation, stays_admissible_and_conserves_in_air_of_any_kind) {
  run(2, true, 2000);
}

TEST(SuperdropletCondensation, of_nothing_does_nothing) {
  Parcel parcel(9e4, 283.15, 1.05);
  const Air before = parcel.air;
  const Condensation scheme(epic_air(), {});
  const Outcome did = parcel.advance(scheme, parcel.above(100), 10);
  EXPECT_EQ(did.substeps, 0);
  EXPECT_EQ(parcel.air.theta, before.theta);
  EXPECT_EQ(parcel.air.vapour, before.vapour);
  parcel.add(1000, 5e-8, 0.61, 0.9);
  const double water = parcel.water[0];
  parcel.advance(scheme, parcel.level, 0.0);
  EXPECT_EQ(parcel.water[0], water);
}

TEST(SuperdropletCondensation, of_a_step_of_ten_days_ends_where_short_steps_end) {
  // From 50 % supersaturated and from dry air: the same equilibrium as 1000 steps of growing
  // length.
  for (const double humidity : {0.5, 0.999, 1.5}) {
    Parcel once(9e4, 283.15, humidity);
    for (const double nm : {20.0, 50.0, 200.0}) once.add(100000000, nm * 1e-9, 0.61, 0.9);
    Parcel often = once;
    const Condensation scheme(epic_air(), {});
    once.advance(scheme, once.level, 1e6);
    for (int i = 0; i < 1000; ++i) often.advance(scheme, often.level, 1e3);
    EXPECT_NEAR(once.liquid(), often.liquid(), 1e-4 * often.liquid()) << humidity;
    // The tolerance of S: 1 % of a thousandth.
    EXPECT_NEAR(once.supersaturation(), often.supersaturation(), 1e-5) << humidity;
  }
}

TEST(SuperdropletCondensation, depends_on_a_droplets_neighbours_through_their_sum_alone) {
  // One superdroplet of 1000 or ten of 100.
  Parcel one(9e4, 283.15, 1.02), ten = one;
  one.add(100000000, 5e-8, 0.61, 0.95);
  for (int i = 0; i < 10; ++i) ten.add(10000000, 5e-8, 0.61, 0.95);
  const Condensation scheme(epic_air(), {});
  for (int i = 0; i < 20; ++i) {
    one.advance(scheme, one.above(1), 1.0);
    ten.advance(scheme, ten.above(1), 1.0);
  }
  for (int i = 0; i < 10; ++i)
    EXPECT_NEAR(ten.water[static_cast<std::size_t>(i)] / one.water[0], 1, 1e-10);
}

TEST(SuperdropletCondensation, ventilation_speeds_growth_up_by_its_factor) {
  Parcel still(9e4, 283.15, 0.9);
  still.add({1, drops::mass_of_radius(5e-4), 0.0, 0.0});
  Parcel falling = still;
  const double factor = 4.0, before = still.radius(0);
  const Condensation scheme(epic_air(), {});
  still.advance(scheme, still.level, 1.0);
  Droplets droplets = falling.droplets();
  droplets.ventilation = {&factor, 1};
  scheme.advance(falling.air, droplets, 1.0, falling.level, falling.level, 1.0, falling.scratch);
  const double slow = before * before - still.radius(0) * still.radius(0);
  const double fast = before * before - falling.radius(0) * falling.radius(0);
  // So large a drop has no jump and little curvature: u changes at a constant rate.
  EXPECT_NEAR(fast / slow, 4.0, 1e-5);
}

}  // namespace
}  // namespace pileus::superdroplets
