// The rule for real air is a bound: no air between the extrema, at no height below the lid,
// saturates at less water than the rule's number says.
#include <gtest/gtest.h>

#include <random>

#include "pileus/reference_state.hpp"
#include "pileus/thermo.hpp"
#include "planner/rule_number.hpp"

namespace pileus::planner {
namespace {

const RuleCase& real_air(const Rules& rules) {
  for (const RuleCase& c : rules.find("condensation")->cases)
    if (c.when.starts_with("thermodynamics == real")) return c;
  throw std::logic_error("no rule for real air");
}

TEST(SaturationBound, lies_below_the_saturation_of_every_parcel) {
  std::mt19937_64 engine(20261125);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine);
  };
  const Rules rules = built_in_rules();
  const RuleCase& rule = real_air(rules);
  for (int trial = 0; trial < 200; ++trial) {
    thermo::Constants constants;
    const double surface = uniform(280, 310), lapse = uniform(0, 6e-3), top = uniform(500, 12000);
    const double pressure = uniform(9e4, 1.03e5);
    const std::vector<double> heights = {0, 0.3 * top, top};
    const std::vector<double> theta_v = {surface, surface + 0.2 * lapse * top,
                                         surface + lapse * top};
    RuleInputs inputs;
    inputs.quantities = {"height", "total_water_mass_fraction",
                         "liquid_water_potential_temperature"};
    inputs.parameters = {{"heat_capacity", constants.heat_capacity},
                         {"gas_constant_dry_air", constants.gas_constant_dry_air},
                         {"epsilon", constants.epsilon}};
    inputs.reference =
        std::make_shared<const thermo::ReferenceState>(heights, theta_v, 0.0, pressure, constants);
    RuleNumber number(rule, inputs);
    const double coldest = uniform(275, 305), wettest = uniform(1e-4, 0.02);
    const double extrema[] = {0, top, 0, wettest, coldest, coldest + 20};
    const double bound = number(extrema);
    for (int parcel = 0; parcel < 200; ++parcel) {
      const double z = uniform(0, top), theta = uniform(coldest, coldest + 20);
      const double exner = inputs.reference->at(z).exner;
      const double saturation =
          thermo::saturation_specific_humidity(thermo::saturation_pressure(exner * theta),
                                               thermo::pressure_of_exner(exner, constants.kappa()),
                                               constants.epsilon)
              .value;
      // Rounding of either side: some tens of ulps, less than 1e-13.
      ASSERT_LE(wettest / saturation, bound * (1 + 1e-13)) << z << ' ' << theta;
    }
    // And it is reached: by the coldest air at the lid.
    const double exner = inputs.reference->at(top).exner;
    const double least = thermo::saturation_specific_humidity(
                             thermo::saturation_pressure(exner * coldest),
                             thermo::pressure_of_exner(exner, constants.kappa()), constants.epsilon)
                             .value;
    EXPECT_NEAR(bound, wettest / least, 1e-12 * bound);
  }
}

}  // namespace
}  // namespace pileus::planner
