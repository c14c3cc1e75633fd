// The rates against solutions known in closed form.
#include "rates.hpp"

#include <cmath>
#include <cstdio>

namespace {

int failures = 0;

void expect_near(const char* what, double found, double expected, double tolerance) {
  const bool good = std::abs(found - expected) <= tolerance;
  if (!good) ++failures;
  std::printf("%s  %s: %.17g, expected %.17g\n", good ? "ok  " : "FAIL", what, found, expected);
}

}  // namespace

int main() {
  const double tau = 3600.0, rounding = 4e-18;
  expect_near("half of a perturbation is left after tau ln(2)",
              rates::cooled(0.02, 0.01, tau * std::log(2.0), tau), 0.015, rounding);
  const double half = rates::cooled(0.02, 0.01, 600.0, tau);
  expect_near("two half steps are one step", rates::cooled(half, 0.01, 600.0, tau),
              rates::cooled(0.02, 0.01, 1200.0, tau), rounding);
  expect_near("a short step cools by dt/tau", rates::cooled(1.0, 0.0, 1e-9 * tau, tau), 1.0 - 1e-9,
              1e-15);
  expect_near("a step of any length stops at the equilibrium", rates::cooled(0.02, 0.01, 1e9, tau),
              0.01, rounding);
  expect_near("no time changes nothing", rates::cooled(0.02, 0.01, 0.0, tau), 0.02, 0.0);
  return failures == 0 ? 0 : 1;
}
