// Supersaturation of rising air against a converged reference integration, closed forms and limits.
//
// The reference ("converged") is the same physics integrated by an independent program at steps of
// 0.01 s: S_max, droplets and cloud water after 300 m (150 m at 0.1 m/s), Ascent's initial state.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "../../../plugins/saturation_adjustment/adjustment.hpp"
#include "ascent.hpp"

namespace pileus::two_moment {
namespace {

struct Converged {
  double speed, distance, peak, time, number, cloud;
};
constexpr Converged converged[] = {{0.1, 150, 6.174e-4, 407.9, 177.389e6, 2.079103e-4},
                                   {0.5, 300, 1.3073e-3, 88.38, 419.223e6, 4.840582e-4},
                                   {1.0, 300, 1.9062e-3, 46.89, 563.072e6, 4.833603e-4},
                                   {3.0, 300, 3.7619e-3, 18.15, 791.696e6, 4.808696e-4}};

TEST(Relaxation, equals_the_exact_solution_at_three_points) {
  // δ_1 = Aτ + (δ_0 − Aτ) e^{−h/τ}; mean δ = (δ_0 + A h − δ_1) τ/h. Ten digits were computed.
  const Relaxed rising = relax(0, 1e-6, 1.0 / 10, 1);
  EXPECT_NEAR(rising.excess, 9.5162581964e-7, 1e-17);
  EXPECT_NEAR(rising.taken * 10 / 1, 4.8374180360e-7, 1e-17);
  const Relaxed falling = relax(5e-5, -1e-6, 1.0 / 3, 10);
  EXPECT_NEAR(falling.excess, -1.1092783526e-6, 1e-16);
  EXPECT_NEAR(falling.taken * 3 / 10, 1.2332783506e-5, 1e-15);
  const Relaxed fixed = relax(1e-5, 2e-6, 1.0 / 5, 2);
  EXPECT_NEAR(fixed.excess, 1e-5, 1e-20);
}

TEST(Relaxation, closes_for_every_ratio_of_step_and_time_scale) {
  for (double x = 1e-20; x < 1e20; x *= 1.7) {
    const double excess = 3e-5, rate = -2e-6, h = 2.0;
    const Relaxed r = relax(excess, rate, x / h, h);
    EXPECT_NEAR(r.excess + r.taken, excess + rate * h, 2e-20) << x;
    // The series below x = 0.01 and the closed form above agree: compare with long double.
    const long double m = -std::expm1(-static_cast<long double>(x));
    const auto lag = static_cast<double>(1.0L - m / static_cast<long double>(x));
    const double expected = excess * static_cast<double>(m) + rate * h * lag;
    EXPECT_NEAR(r.taken, expected, 1e-13 * std::abs(expected) + 1e-24) << x;
  }
  const Relaxed none = relax(1e-5, 1e-6, 0, 3);
  EXPECT_EQ(none.taken, 0.0);
  const Relaxed instant = relax(1e-5, 1e-6, std::numeric_limits<double>::infinity(), 3);
  EXPECT_EQ(instant.excess, 0.0);
  EXPECT_EQ(instant.taken, 1e-5 + 3e-6);
}

TEST(Ascent, of_a_tenth_of_a_second_equals_the_converged_ascent) {
  for (const Converged& c : converged) {
    const Ascent::Result found = Ascent{}.rise(c.speed, c.distance, 0.1);
    // First order in the sub-step: 2e-4 at 0.1 s, 4e-4 for the peak at 3 m/s, which lasts three
    // seconds. A required 3e-3 is met with a margin of ten.
    EXPECT_NEAR(found.number / c.number, 1.0, 3e-4) << c.speed;
    EXPECT_NEAR(found.peak / c.peak, 1.0, 6e-4) << c.speed;
    EXPECT_NEAR(found.peak_time, c.time, 0.15) << c.speed;
    EXPECT_NEAR(found.cloud / c.cloud, 1.0, 1e-4) << c.speed;
  }
}

TEST(Ascent, of_coarse_steps_resolves_the_peak_by_substeps) {
  for (const double dt : {1.0, 5.0, 10.0}) {
    for (const Converged& c : converged) {
      const Ascent::Result found = Ascent{}.rise(c.speed, c.distance, dt);
      // Of first order in c = 0.5, which bounds the sub-step: 0.2 %, and 1.1 % where the step
      // resolves the slow peak less. (The reference program needs 0.9 and 3.2 % for 5 s.)
      EXPECT_NEAR(found.number / c.number, 1.0, c.speed < 0.2 ? 0.012 : 2e-3) << c.speed << dt;
      EXPECT_NEAR(found.peak / c.peak, 1.0, c.speed < 0.2 ? 8e-3 : 2e-3) << c.speed << dt;
      EXPECT_NEAR(found.cloud / c.cloud, 1.0, 3e-4) << c.speed << dt;
    }
  }
  Ascent finer;
  finer.options.substep_fraction = 0.25;
  EXPECT_NEAR(finer.rise(1.0, 300, 5).number / converged[2].number, 1.0, 4e-4);
  EXPECT_NEAR(finer.rise(0.1, 150, 5).number / converged[0].number, 1.0, 5e-3);
}

TEST(Ascent, converges_in_the_first_order_of_the_substep) {
  Ascent ascent;
  const auto at = [&](double c) {
    ascent.options.substep_fraction = c;
    return ascent.rise(1.0, 300, 5).number;
  };
  const double order = std::log2((at(1.0 / 16) - at(1.0 / 32)) / (at(1.0 / 32) - at(1.0 / 64)));
  EXPECT_NEAR(order, 1.0, 0.1);
}

TEST(Ascent, embryos_of_smaller_size_let_supersaturation_rise_further) {
  // The converged reference at 0.05 s for embryos of 1, 0.5, 0.3 and 0.15 µm.
  const double radius[] = {1e-6, 0.5e-6, 0.3e-6, 0.15e-6};
  const double peak[] = {1.9082e-3, 2.1576e-3, 2.2230e-3, 2.2495e-3};
  const double number[] = {563.5e6, 609.5e6, 620.5e6, 624.8e6};
  for (int i = 0; i < 4; ++i) {
    Ascent ascent;
    ascent.options.embryo_radius = radius[i];
    const Ascent::Result found = ascent.rise(1.0, 300, 0.05);
    EXPECT_NEAR(found.peak / peak[i], 1.0, 5e-3) << radius[i];
    EXPECT_NEAR(found.number / number[i], 1.0, 3e-3) << radius[i];
  }
}

TEST(Ascent, carries_the_aerosol_it_does_not_activate) {
  Ascent ascent;
  ascent.options.aerosol_carried = true;
  const Ascent::Result carried = ascent.rise(1.0, 300, 1.0);
  // Every step adds and subtracts one increment: half a unit in the last place each, 300 steps.
  EXPECT_LE(carried.most_aerosol_error, 300 * 2.3e-16);
  EXPECT_NEAR(carried.number, Ascent{}.rise(1.0, 300, 1.0).number, 1e-9 * carried.number);
}

/// Saturation adjustment of a parcel's whole water at a level.
Water adjusted(const MoistAir& air, Water w, const Level& level) {
  const double a = air.warming();
  const auto found = saturation::adjust(level.exner * w.theta - a * w.cloud, w.vapour + w.cloud, a,
                                        [&](double t) -> numerics::ValueAndSlope {
                                          const Saturation s = air.saturation(t, level.pressure);
                                          return {s.humidity, s.slope};
                                        });
  w.vapour = w.vapour + w.cloud - found.liquid;
  w.cloud = found.liquid;
  w.theta = found.temperature / level.exner;
  return w;
}

TEST(Limit, of_vanishing_relaxation_time_is_saturation_adjustment) {
  const MoistAir air = epic_air();
  const Aerosol none(0, 0, 0);
  const Condensation condensation(air, none, {});
  int cases = 0;
  for (const double p : {1e5, 9e4, 7e4, 5e4, 3e4}) {
    for (double t = 230; t < 305; t += 11) {
      const Level level{p, thermo::exner(p, epic.kappa()), 0};
      const double saturated = air.saturation(t, p).humidity;
      for (const double vapour : {0.3, 0.9, 1.0, 1.001, 1.1, 1.5}) {
        for (const double cloud : {1e-12, 1e-5, 3e-3}) {
          Water w;
          w.theta = t / level.exner;
          w.vapour = vapour * saturated;
          w.cloud = cloud;
          w.droplets = 1e300;  // a relaxation time of 1e-290 s
          const Water expected = adjusted(air, w, level);
          condensation.advance(w, level, level, 10.0);
          // Adjustment finds T to a unit in the last place, 5.7e-14 K, and with it the liquid to
          // 5.7e-14 K/(L/c_p) = 2.3e-17; so does its start from (θ, q_v, q_c).
          EXPECT_NEAR(w.vapour, expected.vapour, 5e-17 + 4e-16 * (w.vapour + w.cloud));
          EXPECT_NEAR(w.cloud, expected.cloud, 5e-17 + 4e-16 * (w.vapour + w.cloud));
          EXPECT_NEAR(w.theta, expected.theta, 2.3e-13);
          ++cases;
        }
      }
    }
  }
  EXPECT_EQ(cases, 5 * 7 * 6 * 3);
}

TEST(Limit, is_approached_in_the_first_order_of_the_relaxation_time) {
  // In steady ascent the excess is A τ/… of its forcing: halving τ halves the distance to
  // saturation adjustment.
  const MoistAir air = epic_air();
  const Aerosol none(0, 0, 0);
  const Condensation condensation(air, none, {});
  const Level from{9e4, thermo::exner(9e4, epic.kappa()), 0};
  const Level to{8.99e4, thermo::exner(8.99e4, epic.kappa()), 0};
  std::vector<double> distance;
  for (const double number : {1e10, 2e10, 4e10}) {
    Water w;
    w.theta = 283.15 / from.exner;
    w.vapour = air.saturation(283.15, 9e4).humidity;
    w.cloud = 1e-3;
    w.droplets = number;
    const Water expected = adjusted(air, w, to);
    condensation.advance(w, from, to, 10.0);
    distance.push_back(expected.cloud - w.cloud);
  }
  // τ ∝ 1/(n r) ∝ n^{−2/3} at a fixed water content.
  EXPECT_NEAR(std::log2(distance[0] / distance[1]), 2.0 / 3, 0.02);
  EXPECT_NEAR(std::log2(distance[1] / distance[2]), 2.0 / 3, 0.02);
}

TEST(PrescribedTemperature, condenses_without_warming) {
  MoistAir air = epic_air();
  air.prescribed_temperature = true;
  const Aerosol none(0, 0, 0);
  const Condensation condensation(air, none, {});
  const Level level{9e4, thermo::exner(9e4, epic.kappa()), 283.15};
  Water w;
  w.theta = 400;  // not looked at
  w.vapour = 1.2 * air.saturation(283.15, 9e4).humidity;
  w.cloud = 1e-5;
  w.droplets = 1e300;
  condensation.advance(w, level, level, 1.0);
  EXPECT_DOUBLE_EQ(w.vapour, air.saturation(283.15, 9e4).humidity);
  EXPECT_EQ(w.theta, 400);
}

TEST(Growth, of_a_drop_is_that_of_diffusion_and_conduction) {
  // r dr/dt = G s of a pure drop without kinetic correction at 0.5 %, 10 °C, 900 hPa, less the
  // curvature and solute terms' share: G itself from its two resistances.
  const double e = thermo::saturation_pressure(288.15).value;
  EXPECT_NEAR(growth_coefficient(288.15, 9e4, e, 2.501e6, 461.5), 1.08990138e-10, 0.5e-18);
  EXPECT_NEAR(vapour_diffusivity(288.15, 9e4), 2.635108e-5, 0.5e-11);
}

TEST(Growth, of_equal_droplets_keeps_their_number_and_adds_equal_areas) {
  // r² − r_0² = 2 G s t for each drop while the excess is held: a step too short to change it.
  const MoistAir air = epic_air();
  const Aerosol none(0, 0, 0);
  const Condensation condensation(air, none, {});
  const Level level{9e4, thermo::exner(9e4, epic.kappa()), 0};
  const Saturation at = air.saturation(283.15, 9e4);
  Water w;
  w.theta = 283.15 / level.exner;
  w.vapour = 1.005 * at.humidity;
  w.droplets = 1.0;  // so few that nothing is used up
  w.cloud = mass_of_radius(1e-5);
  const double growth = growth_coefficient(283.15, 9e4, at.pressure, epic.latent_heat, 461.5);
  for (int i = 0; i < 1000; ++i) {
    const Actions did = condensation.advance(w, level, level, 0.01);
    ASSERT_EQ(did.limited + did.repaired, 0);  // nothing was in the way
  }
  const double r = radius_of_mass(w.cloud / w.droplets);
  // At most that of forward Euler in m, whose relative error is the growth of r per step, 1e-5.
  EXPECT_NEAR(r * r, 1e-10 + 2 * growth * 0.005 * 10, 2e-5 * r * r);
  EXPECT_EQ(w.droplets, 1.0);
}

TEST(Spectrum, gamma_distribution_has_the_ratio_of_radii_of_its_width) {
  EXPECT_EQ(radius_ratio(Spectrum::monodisperse, 1e8), 1.0);
  // N = 100 cm-3: η = 0.32854, μ + 1 = 9.26454, c_μ = 9.26453/(9.26453·10.26453·11.26453)^{1/3}.
  EXPECT_NEAR(radius_ratio(Spectrum::gamma, 1e8), 0.905451, 1e-6);
}

}  // namespace
}  // namespace pileus::two_moment
