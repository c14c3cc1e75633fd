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
  const double c = 0.01, h = 100.0, rounding = 4e-16;
  expect_near("half way to the surface's value after (h/C) ln(2)",
              rates::exchanged(0.0, 1.0, c, h, h / c * std::log(2.0)), 0.5, rounding);
  const double half = rates::exchanged(0.25, 1.0, c, h, 500.0);
  expect_near("two half steps are one step", rates::exchanged(half, 1.0, c, h, 500.0),
              rates::exchanged(0.25, 1.0, c, h, 1000.0), rounding);
  expect_near("a short step brings the flux C (q_s - q)",
              h * rates::exchanged(0.0, 1.0, c, h, 1e-6) / 1e-6, c, 1e-12);
  expect_near("a step of any length stops at the surface's value",
              rates::exchanged(0.25, 1.0, c, h, 1e9), 1.0, rounding);
  expect_near("no time changes nothing", rates::exchanged(0.25, 1.0, c, h, 0.0), 0.25, 0.0);
  return failures == 0 ? 0 : 1;
}
