// Two-moment clouds for states of the whole admissible range, stiff ones and denormal ones: nothing
// becomes negative or infinite, water and heat are conserved, the number of sub-steps is bounded.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "../../../plugins/two_moment/collection.hpp"
#include "../../analytic/microphysics/ascent.hpp"

namespace pileus::two_moment {
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
  /// Zero, the smallest number, tiny, or anything up to `high`.
  double amount(double high) {
    switch (random_() % 6) {
      case 0:
        return 0;
      case 1:
        return 5e-324;
      case 2:
        return 1e-310;
      case 3:
        return 1e-18;
      case 4:
        return uniform(0, high);
      default:
        return logarithmic(1e-25, high);
    }
  }

 private:
  std::mt19937_64 random_;
};

Level level_of(double pressure) {
  return {pressure, thermo::exner(pressure, epic.kappa()), 280.0};
}

void expect_admissible(const Water& w, int i) {
  ASSERT_TRUE(std::isfinite(w.theta)) << i;
  for (const double x : {w.vapour, w.cloud, w.droplets, w.aerosol, w.rain, w.raindrops}) {
    ASSERT_TRUE(std::isfinite(x)) << i;
    ASSERT_GE(x, 0.0) << i;
  }
}

/// A parcel of the range of the troposphere, or (wild) of everything the declared ranges admit.
Water draw_water(Draws& draw, double pressure, bool wild) {
  const MoistAir air = epic_air();
  const double kelvin = draw.uniform(wild ? 120 : 200, wild ? 420 : 310);
  const double saturated = std::min(0.5, air.saturation(kelvin, pressure).humidity);
  Water w;
  w.theta = kelvin / level_of(pressure).exner;
  w.vapour = wild ? draw.amount(0.3) : std::min(0.04, saturated * draw.uniform(0, 1.3));
  w.cloud = draw.amount(wild ? 0.3 : 5e-3);
  w.droplets = draw.amount(wild ? 1e16 : 1e10);
  w.rain = draw.amount(wild ? 0.3 : 5e-3);
  w.raindrops = draw.amount(wild ? 1e16 : 1e6);
  w.aerosol = draw.amount(1e10);
  return w;
}

template <class Scheme>
void run(const Scheme& scheme, unsigned seed, bool wild, int count) {
  Draws draw(seed);
  const MoistAir air = epic_air();
  const Aerosol aerosol(ActivationScheme::kappa_lognormal, {{1e9, 50e-9, 2.0, 0.61}}, 0.072, 461.5);
  for (int i = 0; i < count; ++i) {
    CondensationOptions options;
    options.rain = true;
    options.aerosol_carried = i % 2 == 0;
    const Condensation condensation(air, aerosol, options);
    const double pressure = draw.logarithmic(wild ? 5e3 : 2e4, 1.1e5);
    const double dt = draw.logarithmic(1e-3, 3600);
    const Level from = level_of(pressure);
    const bool still = i % 4 == 0;
    const Level to = still ? from : level_of(pressure * draw.uniform(0.93, 1.07));
    Water w = draw_water(draw, pressure, wild);
    const Water before = w;
    Actions did = condensation.advance(w, from, to, dt);
    expect_admissible(w, i);
    const double kelvin = air.temperature(w.theta, to);
    ASSERT_GT(kelvin, 50.0) << i;
    if (still) {
      // R1: the increments of vapour and of θ are the same numbers, each rounded once.
      const double condensed = before.vapour - w.vapour;
      ASSERT_NEAR(w.theta - before.theta, air.warming() / to.exner * condensed,
                  (did.substeps + 2) * 4e-16 * (before.theta + w.theta))
          << i;
    }
    collect(scheme, w, air.density(kelvin, to.pressure), dt, did);
    condensation.keep_sizes(w, did);
    expect_admissible(w, i);
    const double water = before.vapour + before.cloud + before.rain;
    ASSERT_NEAR(w.vapour + w.cloud + w.rain, water, (did.substeps + 4) * 2.3e-16 * water) << i;
    const double more = w.droplets + w.aerosol - before.droplets - before.aerosol;
    const double most = before.droplets + before.aerosol + w.droplets + w.aerosol + w.raindrops +
                        before.raindrops + 1e9;  // all that may be activated in between
    ASSERT_NEAR(more, did.created, (did.substeps + 4) * 4e-16 * most) << i;
    ASSERT_LE(did.substeps, most_condensation_substeps + most_collection_substeps + 2) << i;
  }
}

TEST(TwoMoment, stays_admissible_and_conserves_in_the_troposphere) {
  run(KhairoutdinovKogan{}, 1, false, 10000);
  run(SeifertBeheng{}, 2, false, 10000);
}

TEST(TwoMoment, stays_admissible_and_conserves_for_everything_the_declared_ranges_admit) {
  run(KhairoutdinovKogan{}, 3, true, 5000);
  run(SeifertBeheng{}, 4, true, 2000);
}

TEST(TwoMoment, leaves_dry_air_and_clear_air_below_saturation_as_it_is) {
  Draws draw(5);
  const MoistAir air = epic_air();
  const Aerosol aerosol(ActivationScheme::kappa_lognormal, {{1e9, 50e-9, 2.0, 0.61}}, 0.072, 461.5);
  const Condensation condensation(air, aerosol, {});
  for (int i = 0; i < 20000; ++i) {
    const double pressure = draw.uniform(3e4, 1.1e5);
    const Level level = level_of(pressure);
    Water w;
    const double kelvin = draw.uniform(230, 310);
    w.theta = kelvin / level.exner;
    w.vapour =
        i % 3 == 0 ? 0.0 : draw.uniform(0, 0.999) * air.saturation(kelvin, pressure).humidity;
    const Water before = w;
    const Actions did = condensation.advance(w, level, level, draw.logarithmic(1e-3, 3600));
    ASSERT_EQ(w.theta, before.theta);
    ASSERT_EQ(w.vapour, before.vapour);
    ASSERT_EQ(w.cloud, 0.0);
    ASSERT_EQ(w.droplets, 0.0);
    ASSERT_EQ(did.limited + did.repaired, 0);
  }
}

TEST(TwoMoment, splitting_a_step_changes_the_result_little) {
  // Exact relaxation: two steps of half the length differ by what droplets grow in between only.
  Draws draw(6);
  const MoistAir air = epic_air();
  const Aerosol none(0, 0, 0);
  const Condensation condensation(air, none, {});
  for (int i = 0; i < 2000; ++i) {
    const Level level = level_of(draw.uniform(5e4, 1e5));
    Water once;
    const double kelvin = draw.uniform(270, 300);
    once.theta = kelvin / level.exner;
    once.vapour = draw.uniform(0.99, 1.01) * air.saturation(kelvin, level.pressure).humidity;
    once.cloud = 1e-3;
    once.droplets = draw.logarithmic(1e7, 1e9);
    Water twice = once;
    const double start = once.cloud;
    condensation.advance(once, level, level, 2.0);
    condensation.advance(twice, level, level, 1.0);
    condensation.advance(twice, level, level, 1.0);
    // The radius changes by a third of the relative change of mass, and the rate with it.
    const double change = std::abs(once.cloud - start);
    ASSERT_NEAR(once.cloud, twice.cloud, change * (change / start) / 3 + 1e-3 * change + 1e-16);
  }
}

}  // namespace
}  // namespace pileus::two_moment
