// Moist thermodynamics against tabulated values. Where a table gives n digits, the tolerance is one
// unit of the last of them.
#include "pileus/thermo.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "../../../plugins/saturation_adjustment/adjustment.hpp"
#include "pileus/reference_state.hpp"

namespace pileus::saturation {
namespace {

// The constants of the EPIC model (Frey et al. 2023, doi:10.1016/j.jcpx.2023.100136).
constexpr double gas_constant = 287.05, heat_capacity = 1005.7, latent_heat = 2.501e6;
constexpr double kappa = gas_constant / heat_capacity;
constexpr double epsilon = gas_constant / 461.5;
constexpr double latent_over_heat = latent_heat / heat_capacity;

TEST(SaturationPressure, equals_bolton_1980) {
  const double kelvin[] = {233.15, 253.15, 273.15, 283.15, 288.15, 298.15, 313.15};
  const double pascal[] = {18.9576, 125.740, 611.200, 1227.17, 1704.05, 3167.43, 7394.90};
  const double digit[] = {1e-4, 1e-3, 1e-3, 1e-2, 1e-2, 1e-2, 1e-2};
  for (int i = 0; i < 7; ++i) {
    EXPECT_NEAR(thermo::saturation_pressure(kelvin[i]).value, pascal[i], digit[i]);
  }
}

TEST(SaturationPressure, slope_equals_the_centred_difference) {
  for (double t = 180; t < 340; t += 7.3) {
    constexpr double h = 1e-3;
    const double difference =
        (thermo::saturation_pressure(t + h).value - thermo::saturation_pressure(t - h).value) /
        (2 * h);
    // Truncation h²e'''/6 and rounding 1e-16 e/h are both below 1e-7 of the slope e/20 K.
    EXPECT_NEAR(thermo::saturation_pressure(t).slope / difference, 1.0, 1e-7);
  }
  const auto at = thermo::saturation_pressure(283.15);
  EXPECT_NEAR(at.slope / at.value, 0.066954472, 1e-9);
}

TEST(SaturationHumidity, equals_the_tables_in_both_forms) {
  const double p[] = {1e5, 9e4, 8.5e4, 7e4, 5e4}, t[] = {298.15, 288.15, 283.15, 273.15, 253.15};
  const double ratio[] = {2.03456390e-2, 1.20040350e-2, 9.11144472e-3, 5.47872894e-3,
                          1.56813264e-3};
  const double specific[] = {1.99399480e-2, 1.18616474e-2, 9.02917589e-3, 5.44887603e-3,
                             1.56567745e-3};
  for (int i = 0; i < 5; ++i) {
    const auto e = thermo::saturation_pressure(t[i]);
    EXPECT_NEAR(thermo::saturation_mixing_ratio(e, p[i], epsilon).value, ratio[i], 1e-10);
    EXPECT_NEAR(thermo::saturation_specific_humidity(e, p[i], epsilon).value, specific[i], 1e-10);
  }
}

TEST(SaturationHumidity, is_one_above_the_boiling_point) {
  const auto q = thermo::saturation_specific_humidity(thermo::saturation_pressure(400), 1e5, 0.622);
  EXPECT_EQ(q.value, 1.0);
  EXPECT_EQ(q.slope, 0.0);
}

TEST(Exner, equals_the_table) {
  const double hpa[] = {900, 800, 700, 500};
  const double exner[] = {0.97037535, 0.93829552, 0.90320723, 0.82050095};
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(thermo::exner(100 * hpa[i], kappa), exner[i], 1e-8);
    EXPECT_NEAR(thermo::pressure_of_exner(thermo::exner(100 * hpa[i], kappa), kappa), 100 * hpa[i],
                1e-9);
  }
}

TEST(ReferenceState, of_one_temperature_is_the_adiabatic_atmosphere) {
  const std::vector<double> heights = {0}, theta = {300};
  const thermo::Constants constants{9.80616, gas_constant, heat_capacity, latent_heat, epsilon};
  const thermo::ReferenceState state(heights, theta, 0, 1e5, constants);
  const double z[] = {500, 1000, 1500, 2000, 3000};
  const double exner[] = {0.98374903, 0.96749806, 0.95124709, 0.93499612, 0.90249418};
  const double pascal[] = {94421.2405, 89068.4964, 83936.1773, 79018.7402, 69806.5767};
  for (int i = 0; i < 5; ++i) {
    EXPECT_NEAR(state.at(z[i]).exner, exner[i], 1e-8);
    EXPECT_NEAR(thermo::pressure_of_exner(state.at(z[i]).exner, kappa), pascal[i], 1e-4);
  }
}

TEST(ReferenceState, of_a_profile_solves_the_hydrostatic_equation) {
  // The BOMEX profile (Siebesma et al. 2003), its ends beyond.
  const std::vector<double> heights = {0, 520, 1480, 2000, 3000};
  const std::vector<double> theta = {298.7, 298.7, 302.4, 308.2, 311.85};
  const thermo::Constants constants;
  const thermo::ReferenceState state(heights, theta, 0, 101500, constants);
  EXPECT_NEAR(state.at(0).exner, thermo::exner(101500, constants.kappa()), 1e-15);
  for (double z = -400; z < 4000; z += 100) {
    // Simpson's rule on a segment of 100 m: its error is below 1e-13 for these profiles, except
    // where a kink lies inside; the segments end at multiples of 20 m instead.
    double integral = 0;
    for (double a = z; a < z + 99; a += 20) {
      integral +=
          20.0 / 6 *
          (1 / state.at(a).theta_v + 4 / state.at(a + 10).theta_v + 1 / state.at(a + 20).theta_v);
    }
    const double fall = constants.gravity / constants.heat_capacity * integral;
    EXPECT_NEAR(state.at(z).exner - state.at(z + 100).exner, fall, 1e-13);
  }
}

TEST(Adjustment, equals_the_exact_solution_for_an_exponential_saturation_humidity) {
  // q_s = A exp(βT): T = y − W(aAβ exp(βy))/β, y = T_l + a q_t, with Lambert's W.
  constexpr double a = 7.3959445092e-11, beta = 0.065;
  const auto saturation = [](double t) {
    const double q = a * std::exp(beta * t);
    return numerics::ValueAndSlope{q, beta * q};
  };
  const double t_l[] = {280, 295, 260}, q_t[] = {0.012, 0.030, 0.004};
  const double t[] = {286.8374091950, 303.1564136886, 264.5455675703};
  const double q_l[] = {2.749453189681e-3, 3.279850158580e-3, 1.827859778259e-3};
  for (int i = 0; i < 3; ++i) {
    const Equilibrium found = adjust(t_l[i], q_t[i], latent_over_heat, saturation);
    EXPECT_NEAR(found.temperature, t[i], 1e-9);
    EXPECT_NEAR(found.liquid, q_l[i], 1e-12);
  }
}

numerics::ValueAndSlope mixing_ratio(double t, double p) {
  return thermo::saturation_mixing_ratio(thermo::saturation_pressure(t), p, epsilon);
}

Equilibrium adjust_air(double theta_l, double q_t, double p) {
  return adjust(thermo::exner(p, kappa) * theta_l, q_t, latent_over_heat,
                [&](double t) { return mixing_ratio(t, p); });
}

TEST(Adjustment, equals_the_table_of_cloud_states) {
  struct Row {
    double p, theta_l, q_t, t, q_l;
  };
  constexpr Row rows[] = {{100000, 298, 0.0250, 300.7710380037, 1.114287453164e-3},
                          {90000, 290, 0.0150, 288.3885679839, 2.806677699031e-3},
                          {85000, 290, 0.0120, 283.4976214343, 2.671084690770e-3},
                          {70000, 300, 0.0120, 279.4394092709, 3.408860971030e-3},
                          {50000, 310, 0.0080, 264.4008764919, 4.039520748257e-3},
                          {30000, 320, 0.0020, 231.1217671006, 1.682144080980e-3},
                          {95000, 293, 0.0168, 292.6740660748, 1.581302738771e-3}};
  for (const Row& row : rows) {
    const Equilibrium found = adjust_air(row.theta_l, row.q_t, row.p);
    EXPECT_NEAR(found.temperature, row.t, 1e-8);
    EXPECT_NEAR(found.liquid, row.q_l, 1e-11);
    EXPECT_LE(found.iterations, 6);
  }
}

TEST(Adjustment, reproduces_the_ascent_of_a_parcel_and_its_descent) {
  // 900 hPa, 283.15 K, relative humidity 0.98; T and q_l with θ_l conserved.
  const double theta_l = 283.15 / thermo::exner(90000, kappa);
  const double vapour = 0.98 * thermo::saturation_pressure(283.15).value;
  const double q_t = thermo::saturation_mixing_ratio({vapour, 0}, 90000, epsilon).value;
  const double p[] = {86805.8, 80000, 70000};
  const double t[] = {281.447946, 277.940024, 271.989443};
  const double q_l[] = {4.839016e-4, 1.669090e-3, 3.393370e-3};
  for (int i = 0; i < 3; ++i) {
    const Equilibrium found = adjust_air(theta_l, q_t, p[i]);
    EXPECT_NEAR(found.temperature, t[i], 1e-6);
    EXPECT_NEAR(found.liquid, q_l[i], 1e-9);
    // Back at the start with what is conserved there recomputed from the adjusted state: the same.
    const double exner = thermo::exner(p[i], kappa);
    const double back = (found.temperature - latent_over_heat * found.liquid) / exner;
    EXPECT_NEAR(back, theta_l, 1e-12 * theta_l);
    EXPECT_EQ(adjust_air(back, q_t, 90000).liquid, 0.0);
    EXPECT_NEAR(adjust_air(back, q_t, 90000).temperature, 283.15, 1e-12 * 283.15);
  }
}

TEST(IdealAir, equals_the_undilute_buoyancy_of_the_moist_thermal) {
  // Dritschel et al. 2018: z_c 2500 m, z_d 4000 m, z_m 5000 m, RH 0.8, mu 0.9; latent buoyancy
  // 83.3333; values at six heights and the neutral level to four digits.
  constexpr double latent = 10 * 2.5e6 / (1000 * 300.0), scale = 1000;
  const IdealAir air{0.015, 0, scale, latent};
  const double q = 0.015 * std::exp(-2.5);
  const double z_b = scale * std::log(0.015 * 0.8 / (0.9 * q));
  const double n2 = latent * (q - 0.015 * std::exp(-5.0)) / 1000;
  EXPECT_NEAR(z_b, 2382.217, 1e-3);
  EXPECT_NEAR(n2, 9.418381e-5, 1e-11);
  const double b_0 = n2 * (4000 - z_b);
  const double z[] = {2500, 3000, 3500, 4000, 4500, 5000, 5500};
  const double total[] = {0.1413, 0.1346, 0.1120, 0.0797, 0.0416, 0.0, -0.0438};
  for (int i = 0; i < 7; ++i) {
    EXPECT_NEAR(b_0 + latent * air.liquid(z[i], q) - n2 * (z[i] - z_b), total[i], 5.1e-5);
  }
}

}  // namespace
}  // namespace pileus::saturation
