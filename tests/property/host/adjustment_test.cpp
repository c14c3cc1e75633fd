// Saturation adjustment for states drawn from the whole declared range and its corners.
#include "../../../plugins/saturation_adjustment/adjustment.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace pileus::saturation {
namespace {

constexpr double latent_over_heat = 2.5e6 / 1005.0;
constexpr double epsilon = 0.622;

numerics::ValueAndSlope saturation(double t, double p) {
  return thermo::saturation_specific_humidity(thermo::saturation_pressure(t), p, epsilon);
}

Equilibrium adjust_at(double t_l, double q_t, double p) {
  return adjust(t_l, q_t, latent_over_heat, [&](double t) { return saturation(t, p); });
}

/// The same root by bisection alone.
double bisect(double t_l, double q_t, double p) {
  double low = t_l, high = t_l + latent_over_heat * q_t;
  if (q_t <= saturation(t_l, p).value) return t_l;
  for (int i = 0; i < 200; ++i) {
    const double middle = low + 0.5 * (high - low);
    const double f = middle - t_l - latent_over_heat * (q_t - saturation(middle, p).value);
    (f < 0 ? low : high) = middle;
  }
  return low;
}

TEST(Adjustment, agrees_with_bisection_and_conserves_for_every_state_of_the_range) {
  std::mt19937_64 random(2024);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (int i = 0; i < 200000; ++i) {
    const double p = std::exp(uniform(std::log(1e3), std::log(2e5)));
    const double t_l = uniform(100, 500);
    const double q_t = i % 2 == 0 ? uniform(0, 1) : std::exp(uniform(std::log(1e-25), 0));
    const Equilibrium found = adjust_at(t_l, q_t, p);
    ASSERT_TRUE(std::isfinite(found.temperature));
    ASSERT_GE(found.liquid, 0.0);
    ASSERT_LE(found.liquid, q_t);
    ASSERT_LE(found.iterations, 100);
    // The residual's slope is at least one and its rounding error a few units of a T of up to
    // 3000 K: 4·4.5e-13 K, on either side of the comparison.
    ASSERT_NEAR(found.temperature, bisect(t_l, q_t, p), 4e-12 + 4e-15 * found.temperature)
        << "p " << p << " T_l " << t_l << " q_t " << q_t;
    // θ_l: T − (L/c_p) q_l is T_l by construction, up to the rounding of T.
    ASSERT_NEAR(found.temperature - latent_over_heat * found.liquid, t_l, 1e-12 * t_l);
  }
}

TEST(Adjustment, needs_at_most_seven_evaluations_in_the_atmosphere) {
  std::mt19937_64 random(7);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (int i = 0; i < 200000; ++i) {
    const double p = uniform(3e4, 1.05e5), t_l = uniform(220, 310);
    if (thermo::saturation_pressure(t_l).value > 0.08 * p) continue;
    const double q_t = std::min(
        0.03, saturation(t_l, p).value + std::exp(uniform(std::log(1e-8), std::log(0.025))));
    ASSERT_LE(adjust_at(t_l, q_t, p).iterations, 7) << "p " << p << " T_l " << t_l;
  }
}

TEST(Adjustment, is_continuous_at_saturation) {
  for (double t_l = 220; t_l < 310; t_l += 9) {
    const numerics::ValueAndSlope q = saturation(t_l, 9e4);
    EXPECT_EQ(adjust_at(t_l, q.value, 9e4).liquid, 0.0);  // exactly saturated: nothing condenses
    for (const double excess : {1e-3, 1e-6, 1e-9}) {
      // q_l = excess/(1 + a q') minus a relative ½·excess·(a q')²/(1 + a q')²·(q q''/q'²). The
      // last factor is below 1.05 for all q ≤ 0.03, the one before it below one; the rounding of
      // T gives 6e-14 K/a = 2.3e-17.
      const double linear = q.value * excess / (1 + latent_over_heat * q.slope);
      const double liquid = adjust_at(t_l, q.value * (1 + excess), 9e4).liquid;
      EXPECT_NEAR(liquid, linear, 0.525 * excess * linear + 3e-17) << t_l << " " << excess;
    }
  }
}

TEST(Adjustment, survives_the_corners) {
  EXPECT_EQ(adjust_at(280, 0.0, 9e4).liquid, 0.0);     // no water at all
  EXPECT_EQ(adjust_at(280, 1e-20, 9e4).liquid, 0.0);   // hardly any
  EXPECT_EQ(adjust_at(280, -1e-18, 9e4).liquid, 0.0);  // below zero by rounding
  EXPECT_EQ(adjust_at(280, -1e-18, 9e4).temperature, 280.0);
  EXPECT_EQ(adjust_at(280, 5e-324, 9e4).liquid, 0.0);  // denormal
  const double q_s = saturation(285, 9e4).value;
  EXPECT_NEAR(adjust_at(285, 5 * q_s, 9e4).temperature, bisect(285, 5 * q_s, 9e4), 4e-12);
  EXPECT_EQ(adjust_at(180, 1e-8, 2e4).temperature, bisect(180, 1e-8, 2e4));  // cold top
  EXPECT_EQ(adjust_at(450, 0.5, 1e5).liquid, 0.0);     // above boiling: all vapour
  const Equilibrium flood = adjust_at(300, 1.0, 1e3);  // nothing but water in thin air
  EXPECT_LE(flood.iterations, 100);
  EXPECT_NEAR(flood.temperature, bisect(300, 1.0, 1e3), 4e-12);
}

}  // namespace
}  // namespace pileus::saturation
