// Activation of aerosol against closed forms and the published parameterisation.
#include "../../../plugins/two_moment/activation.hpp"

#include <gtest/gtest.h>
#include <pileus/moist_air.hpp>

namespace pileus::two_moment {
namespace {

// The constants of the EPIC model (Frey et al. 2023, doi:10.1016/j.jcpx.2023.100136).
constexpr thermo::Constants epic{9.80616, 287.05, 1005.7, 2.501e6, 287.05 / 461.5};
constexpr double vapour_constant = 461.5, tension = 0.072;

/// What the parameterisation needs of air at rest in an updraught.
struct Updraught {
  double temperature, pressure, growth, sink, forcing_per_speed;

  Updraught(double t, double p) : temperature(t), pressure(p) {
    const double e = thermo::saturation_pressure(t).value;
    growth = growth_coefficient(t, p, e, epic.latent_heat, vapour_constant);
    sink = condensation_sink(t, p, e, epic.latent_heat, epic.heat_capacity, vapour_constant,
                             epic.epsilon);
    // α of Abdul-Razzak & Ghan 2000.
    forcing_per_speed =
        epic.gravity * epic.latent_heat / (epic.heat_capacity * vapour_constant * t * t) -
        epic.gravity / (epic.gas_constant_dry_air * t);
  }
};

TEST(Activation, critical_supersaturation_follows_the_kelvin_length) {
  const AerosolMode mode{1e9, 50e-9, 2.0, 0.61};
  const Aerosol aerosol(ActivationScheme::kappa_lognormal, {mode}, tension, vapour_constant);
  // (2/√0.61)(A/(3·50 nm))^{3/2}, A = 2·0.072/(1000·461.5·282.7) = 1.10373542e-9 m.
  EXPECT_NEAR(aerosol.critical_supersaturation(mode, 282.7), 1.61631371e-3, 0.5e-11);
  // Half of a mode is activated at its own critical supersaturation, all of it far above.
  EXPECT_NEAR(aerosol.activated(aerosol.critical_supersaturation(mode, 282.7), 282.7), 5e8, 1e-6);
  EXPECT_NEAR(aerosol.activated(10.0, 282.7), 1e9, 1.0);
  EXPECT_EQ(aerosol.activated(0.0, 282.7), 0.0);
  EXPECT_EQ(aerosol.activated(-0.01, 282.7), 0.0);
}

TEST(Activation, twomey_is_a_power_law_with_a_limit) {
  const Aerosol maritime(1e8, 0.5, 1e9);
  EXPECT_DOUBLE_EQ(maritime.activated(0.01, 280), 1e8);  // C at 1 %
  EXPECT_DOUBLE_EQ(maritime.activated(0.0025, 280), 0.5e8);
  EXPECT_DOUBLE_EQ(maritime.activated(10.0, 280), 1e9);
  EXPECT_EQ(maritime.activated(0.0, 280), 0.0);
  const Aerosol always(5e7, 0.0, 1e10);
  EXPECT_DOUBLE_EQ(always.activated(1e-300, 280), 5e7);
}

TEST(Activation, peak_of_one_mode_equals_abdul_razzak_and_ghan) {
  const Updraught air(282.7, 89500);
  EXPECT_NEAR(air.forcing_per_speed, 5.40340443e-4, 0.5e-12);
  EXPECT_NEAR(air.sink, 262.468359, 0.5e-6);
  EXPECT_NEAR(air.growth, 9.21163476e-11, 0.5e-19);
  const Aerosol aerosol(ActivationScheme::arg2000, {{1e9, 50e-9, 2.0, 0.61}}, tension,
                        vapour_constant);
  // The formulas of the paper evaluated independently; N = 1e9 m-3 in air of 1 kg m-3.
  const double speed[] = {0.1, 0.5, 1.0, 3.0};
  const double percent[] = {0.063897, 0.160576, 0.230858, 0.415828};
  const double number[] = {186.037, 497.486, 634.150, 818.286};
  for (int i = 0; i < 4; ++i) {
    const Aerosol::Peak peak =
        aerosol.peak(air.temperature, air.forcing_per_speed * speed[i], air.growth, air.sink, 1.0);
    EXPECT_NEAR(100 * peak.supersaturation, percent[i], 0.6e-6);
    EXPECT_NEAR(1e-6 * peak.activated, number[i], 0.6e-3);
  }
}

TEST(Activation, two_modes_compete_as_in_figure_1_of_abdul_razzak_and_ghan) {
  const Updraught air(294, 1e5);
  const double competing[] = {100e6, 1000e6, 5000e6};
  const double percent[] = {0.235153, 0.129574, 0.057664};
  const double fraction[] = {0.691281, 0.470613, 0.196990};
  for (int i = 0; i < 3; ++i) {
    const AerosolMode first{100e6, 50e-9, 2.0, 0.72393}, second{competing[i], 50e-9, 2.0, 0.72393};
    const Aerosol both(ActivationScheme::arg2000, {first, second}, tension, vapour_constant);
    const Aerosol alone(ActivationScheme::kappa_lognormal, {first}, tension, vapour_constant);
    const Aerosol::Peak peak =
        both.peak(294, air.forcing_per_speed * 0.5, air.growth, air.sink, 1.0);
    EXPECT_NEAR(100 * peak.supersaturation, percent[i], 1e-6);
    EXPECT_NEAR(alone.activated(peak.supersaturation, 294) / first.number, fraction[i], 1e-6);
  }
}

TEST(Activation, no_peak_without_forcing) {
  const Aerosol aerosol(ActivationScheme::arg2000, {{1e9, 50e-9, 2.0, 0.61}}, tension,
                        vapour_constant);
  EXPECT_EQ(aerosol.peak(280, 0.0, 1e-10, 250, 1.0).activated, 0.0);
  EXPECT_EQ(aerosol.peak(280, -1e-3, 1e-10, 250, 1.0).activated, 0.0);
}

}  // namespace
}  // namespace pileus::two_moment
