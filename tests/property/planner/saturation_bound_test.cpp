// The rules for real air are bounds: no air between the extrema, at no height of the domain,
// saturates at less water than the rule's number says, by any formula, for any constants.
#include "planner/saturation_bound.hpp"

#include <gtest/gtest.h>

#include <random>

#include "pileus/moist_air.hpp"
#include "pileus/reference_state.hpp"
#include "pileus/thermo.hpp"
#include "planner/rule_number.hpp"

namespace pileus::planner {
namespace {

using thermo::SaturationFormula;

constexpr SaturationFormula formulas[] = {SaturationFormula::bolton, SaturationFormula::tetens,
                                          SaturationFormula::magnus, SaturationFormula::buck,
                                          SaturationFormula::murphy_koop};
constexpr double infinity = std::numeric_limits<double>::infinity();

double saturation(const AirSaturation& air, double epsilon, double exner, double theta) {
  const double pressure = thermo::pressure_of_exner(exner, air.kappa);
  const auto vapour = thermo::saturation_pressure(exner * theta, air.formula);
  return air.mixing_ratio ? thermo::saturation_mixing_ratio(vapour, pressure, epsilon).value
                          : thermo::saturation_specific_humidity(vapour, pressure, epsilon).value;
}

class Draws {
 public:
  explicit Draws(unsigned seed) : engine_(seed) {}
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  double logarithmic(double low, double high) {
    return std::exp(uniform(std::log(low), std::log(high)));
  }

 private:
  std::mt19937_64 engine_;
};

// The bound rests on this: vapour pressure has no minimum inside any interval of temperatures. The
// slope of ln e_s of the rational formulas, b (273.15 − pole)/(T − pole)², is positive wherever T
// is above the pole. That of Buck's formula has the sign of 18.678·257.14·234.5 − 514.28 t − t² (t
// in °C), which changes once, at t = 834.8 °C; the formula is held from 1000 K on.
TEST(VapourPressure, of_buck_rises_and_stays_constant_where_it_would_fall) {
  const auto buck = [](double kelvin) {
    return thermo::saturation_pressure(kelvin, SaturationFormula::buck);
  };
  const double turn = 273.15 - 257.14 + std::sqrt(257.14 * 257.14 + 18.678 * 257.14 * 234.5);
  EXPECT_NEAR(turn, 1108.0, 0.5);
  for (double t = coldest_described_air; t <= 1000; t += 0.25) ASSERT_GT(buck(t).slope, 0) << t;
  for (double t = 1000.25; t < 2500; t += 0.25) {
    ASSERT_EQ(buck(t).slope, 0) << t;
    ASSERT_EQ(buck(t).value, buck(1000).value) << t;
  }
}

/// Lower bound of d ln e_s/dT of Murphy & Koop's eq. 10 for all temperatures in [a, b]: every term
/// is monotone between the zeros of its factors, and is taken where it is lowest.
double least_slope(double a, double b) {
  const auto product = [](Interval x, Interval y) {
    return std::min({x.low * y.low, x.low * y.high, x.high * y.low, x.high * y.high});
  };
  // 53.878 − 1331.22/T + 0.014025 T rises, −9.44523 ln T falls.
  const Interval cold{53.878 - 1331.22 / a - 9.44523 * std::log(b) + 0.014025 * a,
                      53.878 - 1331.22 / b - 9.44523 * std::log(a) + 0.014025 * b};
  const Interval cold_slope{1331.22 / (b * b) - 9.44523 / a + 0.014025,
                            1331.22 / (a * a) - 9.44523 / b + 0.014025};
  const Interval step{std::tanh(0.0415 * (a - 218.8)), std::tanh(0.0415 * (b - 218.8))};
  const double least_square =
      a < 218.8 && b > 218.8 ? 0 : std::min(step.low * step.low, step.high * step.high);
  const double most_square = std::max(step.low * step.low, step.high * step.high);
  const Interval bump{0.0415 * (1 - most_square), 0.0415 * (1 - least_square)};
  return 6763.22 / (b * b) - 4.21 / a + 0.000367 + product(bump, cold) + product(step, cold_slope);
}

// Beyond 4000 K tanh is 1 to the last bit and the slope is at least 0.0144 − 13.66/T > 0.
TEST(VapourPressure, of_murphy_and_koop_rises_everywhere_by_interval_evaluation) {
  constexpr double width = 0.02;
  for (double t = coldest_described_air; t < 4000; t += width)
    ASSERT_GT(least_slope(t, t + width), 0) << t;
  // The terms are those of the formula.
  for (const double t : {150.0, 218.8, 250.0, 300.0, 900.0}) {
    const auto e = thermo::saturation_pressure(t, SaturationFormula::murphy_koop);
    EXPECT_NEAR(least_slope(t, t), e.slope / e.value, 1e-12 * e.slope / e.value) << t;
  }
}

// Rounding of either side is some tens of ulps, less than 1e-13.
TEST(SaturationBound, lies_below_the_saturation_of_all_air_for_any_formula_and_constants) {
  Draws draw(20261126);
  for (int trial = 0; trial < 1000; ++trial) {
    AirSaturation air;
    air.formula = formulas[trial % 5];
    air.mixing_ratio = trial % 2 == 1;
    // R_d/c_p from a hundredth to the value of a gas whose saturation humidity grows with height.
    air.kappa = trial % 3 == 0 ? 287.04 / 1005 : draw.logarithmic(0.003, 3);
    const double epsilon = draw.uniform(0.01, 0.99);
    const double low = draw.uniform(0.05, 1.1), high = low + draw.logarithmic(1e-9, 2);
    const double coldest = std::max(50.0, draw.logarithmic(80, 2000) / low);
    const double warmest = coldest + draw.logarithmic(1e-9, 2000);
    const double bound = lowest_saturation_humidity(air, epsilon, {low, high}, {coldest, warmest});
    double least = infinity;
    for (int parcel = 0; parcel < 300; ++parcel) {
      const double x = parcel % 3 == 0 ? (parcel % 2 == 0 ? low : high) : draw.uniform(low, high);
      const double theta =
          parcel % 5 == 0 ? (parcel % 2 == 0 ? coldest : warmest) : draw.uniform(coldest, warmest);
      least = std::min(least, saturation(air, epsilon, x, theta));
    }
    ASSERT_LE(bound, least * (1 + 1e-13)) << trial;
    if (low * coldest < coldest_described_air) {
      ASSERT_EQ(bound, 0) << trial;
    }
  }
}

// 1e-8 is what the search stops at; the least of a scan lies above the least of all by the square
// of its spacing.
TEST(SaturationBound, is_reached) {
  Draws draw(7);
  for (int trial = 0; trial < 60; ++trial) {
    AirSaturation air;
    air.formula = formulas[trial % 5];
    air.kappa = trial % 3 == 0 ? 287.04 / 1005 : draw.logarithmic(0.02, 1);
    const double low = draw.uniform(0.7, 0.9), high = draw.uniform(0.95, 1.05);
    const Interval theta{draw.uniform(260, 300), 310};
    double least = infinity;
    constexpr int points = 20000;
    for (int i = 0; i <= points; ++i)
      for (const double t : {theta.low, theta.high})
        least = std::min(least, saturation(air, 0.622, low + (high - low) * i / points, t));
    const double bound = lowest_saturation_humidity(air, 0.622, {low, high}, theta);
    EXPECT_GT(bound, least * (1 - 2e-8)) << trial;
    EXPECT_LE(bound, least * (1 + 1e-13)) << trial;
  }
}

// The driest saturation is usually that of the coldest air under the lid, but not where e_s grows
// less along an adiabat than the pressure: with R_d/c_p = 0.02, p falls by Π^50 and e_s by Π^20.
TEST(SaturationBound, is_at_the_ground_where_pressure_falls_faster_than_vapour_pressure) {
  AirSaturation air;
  air.kappa = 0.02;
  const double ground = saturation(air, 0.622, 1.0, 290), lid = saturation(air, 0.622, 0.9, 290);
  ASSERT_LT(ground, lid);
  EXPECT_NEAR(lowest_saturation_humidity(air, 0.622, {0.9, 1.0}, {290, 290}), ground,
              2e-8 * ground);
}

TEST(SaturationBound, claims_nothing_for_air_the_formulas_do_not_describe) {
  for (const SaturationFormula formula : formulas) {
    const AirSaturation air{formula, false, 287.04 / 1005};
    EXPECT_EQ(lowest_saturation_humidity(air, 0.622, {0.3, 1}, {300, 310}), 0);   // 90 K
    EXPECT_EQ(lowest_saturation_humidity(air, 0.622, {0.05, 1}, {300, 310}), 0);  // below the poles
    EXPECT_EQ(lowest_saturation_humidity(air, 0.622, {-0.1, 1}, {300, 310}), 0);
    EXPECT_EQ(lowest_saturation_humidity(air, 0.622, {0.9, 1}, {infinity - infinity, 310}), 0);
  }
}

/// A case of the rule for condensation with its formula, for a reference state and constants.
RuleNumber number_of(const RuleCase& rule, std::vector<std::string> quantities,
                     const AirSaturation& air,
                     std::shared_ptr<const thermo::ReferenceState> reference, double epsilon) {
  RuleInputs inputs;
  inputs.quantities = std::move(quantities);
  inputs.parameters = {{"epsilon", epsilon}};
  inputs.reference = std::move(reference);
  inputs.saturation = air;
  return {rule, inputs};
}

const RuleCase& case_of(const Rules& rules, std::string_view when, std::size_t carried) {
  for (const RuleCase& c : rules.find("condensation")->cases)
    if (c.when == when && c.carried.size() == carried) return c;
  throw std::logic_error("no such case");
}

TEST(RuleForRealAir, is_sound_for_parcels_anywhere_in_the_domain) {
  const Rules rules = built_in_rules();
  const RuleCase& rule = case_of(rules, "thermodynamics == real", 2);
  Draws draw(20261125);
  for (int trial = 0; trial < 200; ++trial) {
    const AirSaturation air{formulas[trial % 5], false, thermo::Constants{}.kappa()};
    const double surface = draw.uniform(280, 310), lapse = draw.uniform(0, 6e-3);
    const double top = draw.uniform(500, 12000);
    const std::vector<double> heights = {0, 0.3 * top, top};
    const std::vector<double> theta_v = {surface, surface + 0.2 * lapse * top,
                                         surface + lapse * top};
    const auto reference = std::make_shared<const thermo::ReferenceState>(
        heights, theta_v, 0.0, draw.uniform(9e4, 1.03e5), thermo::Constants{});
    RuleNumber number = number_of(
        rule, {"height", "total_water_mass_fraction", "liquid_water_potential_temperature"}, air,
        reference, 0.622);
    const double coldest = draw.uniform(275, 305), wettest = draw.uniform(1e-4, 0.02);
    const double extrema[] = {0, top, 0, wettest, coldest, coldest + 20};
    const double bound = number(extrema);
    for (int parcel = 0; parcel < 200; ++parcel) {
      const double exner = reference->at(draw.uniform(0, top)).exner;
      const double theta = draw.uniform(coldest, coldest + 20);
      ASSERT_LE(wettest / saturation(air, 0.622, exner, theta), bound * (1 + 1e-13));
    }
    // And it is reached: by the coldest air at the lid.
    const double least = saturation(air, 0.622, reference->at(top).exner, coldest);
    EXPECT_NEAR(bound, wettest / least, 2e-8 * bound);
  }
}

// A parcel that the rule leaves out is one the scheme itself finds at or below saturation.
TEST(RuleForTwoMoments, leaves_out_no_parcel_above_saturation) {
  const Rules rules = built_in_rules();
  const RuleCase& rule = case_of(rules, "temperature == prognostic", 4);
  const std::vector<std::string> quantities = {
      "height", "specific_humidity", "air_potential_temperature",
      "mass_fraction_of_cloud_liquid_water_in_air", "number_of_cloud_droplets_per_mass_of_air"};
  Draws draw(3);
  int left_out = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    MoistAir air;
    air.formula = formulas[trial % 5];
    air.measure =
        trial % 2 == 0 ? HumidityMeasure::specific_humidity : HumidityMeasure::mixing_ratio;
    air.constants.epsilon = draw.uniform(0.01, 0.99);
    const double height = draw.uniform(0, 9000), theta = draw.uniform(250, 340);
    const std::vector<double> base = {0}, reference_theta = {290};
    const auto reference = std::make_shared<const thermo::ReferenceState>(base, reference_theta,
                                                                          0.0, 1e5, air.constants);
    const AirSaturation saturates{air.formula, trial % 2 == 1, air.constants.kappa()};
    RuleNumber number = number_of(rule, quantities, saturates, reference, air.constants.epsilon);
    const double exner = reference->at(height).exner;
    const double q_s = saturation(saturates, air.constants.epsilon, exner, theta);
    // Next to saturation, on either side and at distances down to the allowance of 1e-6.
    const double away = draw.logarithmic(1e-9, 0.1);
    const double vapour = std::min(1.0, q_s * (trial % 4 < 2 ? 1 - away : 1 + away));
    const double extrema[] = {height, height, vapour, vapour, theta, theta, 0, 0, 0, 0};
    if (number.calls(number(extrema))) continue;
    ++left_out;
    ASSERT_LE(air.relative_humidity(vapour, exner * theta,
                                    thermo::pressure_of_exner(exner, air.constants.kappa())),
              1.0)
        << trial;
  }
  EXPECT_GT(left_out, 2000);
  // Any drop calls for it, however dry the air.
  const auto reference = std::make_shared<const thermo::ReferenceState>(
      std::vector<double>{0}, std::vector<double>{290}, 0.0, 1e5, thermo::Constants{});
  const AirSaturation usual{SaturationFormula::bolton, false, thermo::Constants{}.kappa()};
  RuleNumber number = number_of(rule, quantities, usual, reference, 0.622);
  for (const int drop : {7, 9}) {
    double extrema[] = {0, 100, 0, 1e-6, 290, 290, 0, 0, 0, 0};
    EXPECT_FALSE(number.calls(number(extrema)));
    extrema[drop] = 5e-324;
    EXPECT_TRUE(number.calls(number(extrema)));
  }
}

}  // namespace
}  // namespace pileus::planner
