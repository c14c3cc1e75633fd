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
  const double a = 1e-3, k = 1e-3, rounding = 1e-17;
  expect_near("half of the excess is left after ln(2)/k",
              rates::cloud_left(3e-3, a, k, std::log(2.0) / k), 2e-3, rounding);
  const double half = rates::cloud_left(3e-3, a, k, 150.0);
  expect_near("two half steps are one step", rates::cloud_left(half, a, k, 150.0),
              rates::cloud_left(3e-3, a, k, 300.0), rounding);
  expect_near("a step of any length stops at the threshold", rates::cloud_left(3e-3, a, k, 1e9), a,
              rounding);
  expect_near("thin cloud stays", rates::cloud_left(0.9e-3, a, k, 1e4), 0.9e-3, 0.0);
  expect_near("no time changes nothing", rates::cloud_left(3e-3, a, k, 0.0), 3e-3, 0.0);
  return failures == 0 ? 0 : 1;
}
