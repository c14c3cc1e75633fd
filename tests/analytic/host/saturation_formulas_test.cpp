// The fits of the saturation vapour pressure against their tables; one unit of the last digit.
#include <gtest/gtest.h>

#include <cmath>

#include "pileus/thermo.hpp"

namespace pileus::thermo {
namespace {

struct Table {
  SaturationFormula formula;
  double pascal[11];
};
constexpr double kelvin[] = {233.15, 243.15, 253.15, 263.15, 273.15, 283.15,
                             288.15, 293.15, 298.15, 303.15, 313.15};
// Each formula evaluated independently at these temperatures.
constexpr Table tables[] = {{SaturationFormula::bolton,
                             {18.9576, 51.0354, 125.740, 286.770, 611.200, 1227.17, 1704.05,
                              2336.95, 3167.43, 4245.58, 7394.90}},
                            {SaturationFormula::tetens,
                             {18.4196, 50.1706, 124.613, 285.700, 610.780, 1227.93, 1705.30,
                              2338.22, 3167.69, 4242.94, 7375.38}},
                            {SaturationFormula::magnus,
                             {18.9684, 51.0635, 125.784, 286.773, 610.940, 1226.02, 1701.98,
                              2333.44, 3161.74, 4236.65, 7374.72}},
                            {SaturationFormula::buck,
                             {18.9782, 50.9889, 125.584, 286.560, 611.210, 1227.86, 1705.17,
                              2338.34, 3168.53, 4245.13, 7382.36}},
                            {SaturationFormula::murphy_koop,
                             {18.9121, 50.9356, 125.504, 286.453, 611.213, 1228.26, 1705.88,
                              2339.40, 3169.94, 4246.81, 7384.31}}};

TEST(SaturationFormulas, equal_their_tables) {
  for (const Table& table : tables) {
    for (int i = 0; i < 11; ++i) {
      // Six digits.
      const double digit = std::pow(10.0, std::floor(std::log10(table.pascal[i])) - 5);
      EXPECT_NEAR(saturation_pressure(kelvin[i], table.formula).value, table.pascal[i], digit)
          << static_cast<int>(table.formula) << " " << kelvin[i];
    }
  }
}

TEST(SaturationFormulas, murphy_and_koop_equals_the_values_printed_in_the_paper) {
  // Murphy & Koop 2005, appendix C, liquid water.
  const double t[] = {180, 210, 240, 273.15, 273.16, 300};
  const double e[] = {0.011239, 1.2335, 37.667, 611.213, 611.657, 3536.8};
  const double digit[] = {1e-6, 1e-4, 1e-3, 1e-3, 1e-3, 1e-1};
  for (int i = 0; i < 6; ++i)
    EXPECT_NEAR(saturation_pressure(t[i], SaturationFormula::murphy_koop).value, e[i], digit[i]);
}

TEST(SaturationFormulas, slopes_equal_the_centred_difference) {
  for (const Table& table : tables) {
    for (double t = 200; t < 330; t += 7.3) {
      constexpr double h = 1e-3;
      const double difference = (saturation_pressure(t + h, table.formula).value -
                                 saturation_pressure(t - h, table.formula).value) /
                                (2 * h);
      // Truncation h²e'''/6 and rounding 1e-16 e/h are both below 1e-7 of the slope e/20 K.
      EXPECT_NEAR(saturation_pressure(t, table.formula).slope / difference, 1.0, 1e-7)
          << static_cast<int>(table.formula) << " " << t;
    }
  }
}

/// As a search for an equilibrium relies on, where there is no air either.
TEST(SaturationFormulas, never_fall) {
  for (const Table& table : tables) {
    double below = 0;
    for (double t = 100; t < 1e4; t *= 1.01) {
      const auto [e, slope] = saturation_pressure(t, table.formula);
      EXPECT_GE(e, below) << static_cast<int>(table.formula) << " " << t;
      EXPECT_GE(slope, 0) << static_cast<int>(table.formula) << " " << t;
      below = e;
    }
  }
}

TEST(SaturationMixingRatio, equals_its_table_and_stays_finite_near_boiling) {
  const double epsilon = 287.05 / 461.5;
  const auto at = [&](double p, double t) {
    return saturation_mixing_ratio(saturation_pressure(t), p, epsilon);
  };
  EXPECT_NEAR(at(1e5, 298.15).value, 2.03456390e-2, 1e-10);
  EXPECT_NEAR(at(9e4, 288.15).value, 1.20040350e-2, 1e-10);
  EXPECT_NEAR(at(8.5e4, 283.15).value, 9.11144472e-3, 1e-11);
  EXPECT_NEAR(at(7e4, 273.15).value, 5.47872894e-3, 1e-11);
  EXPECT_NEAR(at(5e4, 253.15).value, 1.56813264e-3, 1e-11);
  double before = 0;
  for (double t = 200; t < 500; t += 0.5) {
    const double q = at(3e4, t).value;
    EXPECT_TRUE(std::isfinite(q));
    EXPECT_GE(q, before);
    before = q;
  }
}

}  // namespace
}  // namespace pileus::thermo
