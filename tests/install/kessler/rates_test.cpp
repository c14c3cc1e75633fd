// The rates against published numbers and solutions known in closed form.
#include "rates.hpp"

#include <cmath>
#include <cstdio>

#include "adjustment.hpp"

namespace {

int failures = 0;

void expect_near(const char* what, double found, double expected, double tolerance) {
  const bool good = std::abs(found - expected) <= tolerance;
  if (!good) ++failures;
  std::printf("%s  %s: %.17g, expected %.17g\n", good ? "ok  " : "FAIL", what, found, expected);
}

/// Autoconversion and accretion by the classical Runge–Kutta method in very small steps.
double integrated_cloud(double cloud, double rain, double dt) {
  const double water = cloud + rain;
  const auto slope = [&](double c) {
    return -kessler::autoconversion(c, 1e-3, 1e-3) - c * kessler::accretion_rate(water - c, 2.2);
  };
  constexpr int steps = 20000;
  const double h = dt / steps;
  for (int n = 0; n < steps; ++n) {
    const double k1 = slope(cloud), k2 = slope(cloud + 0.5 * h * k1);
    const double k3 = slope(cloud + 0.5 * h * k2), k4 = slope(cloud + h * k3);
    cloud += h / 6.0 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  return cloud;
}

double stepped_cloud(double cloud, double rain, double dt, int steps) {
  for (int n = 0; n < steps; ++n) {
    const double collected = kessler::collected(cloud, rain, 1e-3, 1e-3, 2.2, dt / steps);
    rain += collected;
    cloud -= collected;
  }
  return cloud;
}

void test_collection() {
  // KW eq. 2.13: 1e-3 s-1 of what exceeds 1 g/kg; 2.2 q_c q_r^0.875.
  expect_near("autoconversion of 2 g/kg", kessler::autoconversion(2e-3, 1e-3, 1e-3), 1e-6, 1e-20);
  expect_near("none at the threshold", kessler::autoconversion(1e-3, 1e-3, 1e-3), 0.0, 0.0);
  expect_near("accretion of 1 g/kg by 1 g/kg", 1e-3 * kessler::accretion_rate(1e-3, 2.2),
              2.2e-3 * std::pow(10.0, -2.625), 1e-18);
  // Without rain the first instants are autoconversion alone, solved exactly.
  expect_near("autoconversion alone", kessler::collected(3e-3, 0.0, 1e-3, 1e-3, 0.0, 500.0),
              2e-3 * (1 - std::exp(-0.5)), 1e-17);
  const double exact = integrated_cloud(3e-3, 1e-4, 300.0);
  const double coarse = std::abs(stepped_cloud(3e-3, 1e-4, 300.0, 20) - exact);
  const double fine = std::abs(stepped_cloud(3e-3, 1e-4, 300.0, 40) - exact);
  expect_near("halving the step quarters the error", coarse / fine, 4.0, 0.5);
  expect_near("a step of 15 s is within 2 per cent", coarse / exact, 0.0, 0.02);
  expect_near("no time changes nothing", kessler::collected(3e-3, 1e-3, 1e-3, 1e-3, 2.2, 0.0), 0.0,
              0.0);
  expect_near("no step takes more than there is",
              std::max(0.0, kessler::collected(3e-3, 1e-3, 1e-3, 1e-3, 2.2, 1e9) - 3e-3), 0.0, 0.0);
  // Of a cloud of 20 g/kg, at the rate of 1e-3 s-1 beyond 1 g/kg.
  expect_near("the first rain has all digits",
              kessler::collected(2e-2, 0.0, 1e-3, 1e-3, 0.0, 1e-8) / 1.9e-13, 1.0, 1e-10);
}

void test_evaporation() {
  // KW eq. 2.14 by hand for rho = 1 kg m-3, q_r = 1 g/kg (rho q_r = 1e-6 g cm-3), p = 900 hPa and
  // q_vs = 10 g/kg: C = 1.6 + 124.9 * 1e-6^0.2046 = 8.9954, (1e-6)^0.525 = 7.0795e-4,
  // 5.4e5 + 2.55e6/9 = 823333; C*7.0795e-4/823333/1e-3 = 7.7348e-6 per unit of 1 - q_v/q_vs.
  const double rate = kessler::evaporation_rate(1e-3, 1e-2, 1.0, 9e4);
  expect_near("evaporation of 1 g/kg in dry air, s-1", rate * 1e-2, 7.735e-6, 0.002e-6);
  expect_near("no rain, no rate", kessler::evaporation_rate(0.0, 1e-2, 1.0, 9e4), 0.0, 0.0);
  // A short step evaporates rate * deficit * dt; a long one stops at saturation.
  expect_near("short step", kessler::evaporated(1e-3, 5e-3, 1e-3, 2.0, 1e-3) / 1e-3, 5e-6, 1e-11);
  expect_near("long step closes the deficit", kessler::evaporated(1.0, 5e-3, 1e-3, 2.0, 1e9),
              2.5e-3, 1e-17);
  expect_near("never more than the rain", kessler::evaporated(1e-6, 5e-3, 1e-3, 2.0, 1e9), 1e-6,
              0.0);
  expect_near("none into saturated air", kessler::evaporated(1e-3, 0.0, 1e-3, 2.0, 10.0), 0.0, 0.0);
}

void test_drops() {
  // Marshall & Palmer: mass of the distribution pi rho_w N_0/lambda^4 = rho q_r, so that the mean
  // mass of the drops is pi rho_w/lambda^3.
  const double rain = 1e-3, density = 1.2, n = kessler::raindrops(rain, density, 8e6);
  const double slope = 8e6 / (density * n);
  expect_near("mean mass of exponential drops", rain / n,
              pileus::drops::pi * 1000.0 / (slope * slope * slope), 1e-18);
}

void test_adjustment() {
  const pileus::MoistAir air;
  const double pressure = 9e4, temperature = 288.0, warming = air.warming();
  const double saturated = air.saturation(temperature, pressure).humidity;
  for (const double excess : {1e-6, 1e-4, 1e-3, 5e-3}) {
    const double c = kessler::condensation(air, temperature, pressure, saturated + excess, 0.0);
    const pileus::Saturation after = air.saturation(temperature + warming * c, pressure);
    expect_near("vapour is that of saturation", saturated + excess - c, after.humidity, 1e-16);
    expect_near(
        "a second adjustment does nothing",
        kessler::condensation(air, temperature + warming * c, pressure, saturated + excess - c, c),
        0.0, 0.0);
    // Soong & Ogura's single step, which KW take, misses the root by its second order.
    const pileus::Saturation at = air.saturation(temperature, pressure);
    const double once = excess / (1.0 + warming * at.slope);
    expect_near("one step is within its second order", c / once, 1.0, 50.0 * excess + 1e-9);
  }
  expect_near("all cloud evaporates into dry air",
              kessler::condensation(air, temperature, pressure, 0.5 * saturated, 1e-4), -1e-4, 0.0);
  const double part = kessler::condensation(air, temperature, pressure, saturated - 1e-4, 1e-3);
  expect_near("some cloud stays in nearly saturated air", saturated - 1e-4 - part,
              air.saturation(temperature + warming * part, pressure).humidity, 1e-16);
  expect_near("clear dry air stays", kessler::condensation(air, temperature, pressure, 1e-3, 0.0),
              0.0, 0.0);
}

}  // namespace

int main() {
  test_collection();
  test_evaporation();
  test_drops();
  test_adjustment();
  return failures == 0 ? 0 : 1;
}
