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
  const double tau = 600.0, rounding = 4e-16;
  expect_near("half of a difference is gone after tau ln(2)",
              rates::share_exchanged(tau * std::log(2.0), tau), 0.5, rounding);
  const double half = rates::share_exchanged(100.0, tau);
  expect_near("two half steps are one step", 1.0 - (1.0 - half) * (1.0 - half),
              rates::share_exchanged(200.0, tau), rounding);
  expect_near("a short step exchanges dt/tau", rates::share_exchanged(1e-9 * tau, tau), 1e-9,
              1e-18);
  expect_near("no step exchanges more than all", rates::share_exchanged(1e9, tau), 1.0, 0.0);
  expect_near("no time changes nothing", rates::share_exchanged(0.0, tau), 0.0, 0.0);
  return failures == 0 ? 0 : 1;
}
