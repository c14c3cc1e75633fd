// Golovin's kernel has an exact solution: the number of drops falls as exp(−b L t/ρ_w), the second
// moment of mass rises as the square of its inverse (Golovin 1963; Shima et al. 2009, fig. 2a).
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "droplet_box.hpp"

namespace pileus::superdroplets {
namespace {

constexpr double never = std::numeric_limits<double>::infinity();
constexpr std::array<double, 3> exact_number = {0.16530, 0.027323, 0.0045165};

/// Mean over members of N/N_exact at an hour.
double mean_number(double dt, double largest_change, int members) {
  double sum = 0;
  for (int m = 0; m < members; ++m) {
    ShimaBox box(8192, 300 + static_cast<std::uint64_t>(m));
    box.options.largest_change = largest_change;
    box.run(GolovinKernel{}, 3600, dt);
    sum += box.number() / std::exp(-ShimaBox::golovin_rate * 3600);
  }
  return sum / members;
}

/// One run of 2^13 superdroplets: three standard deviations of an ensemble at 1 s, and its bias.
void expect_single_run(double dt) {
  ShimaBox box(8192, 1);
  const double mass = box.moment(1);
  constexpr std::array<double, 3> bound = {0.045, 0.055, 0.06};
  for (std::size_t k = 0; k < 3; ++k) {
    box.run(GolovinKernel{}, 1200, dt);
    const double exact = std::exp(-ShimaBox::golovin_rate * 1200 * static_cast<double>(k + 1));
    EXPECT_NEAR(exact / exact_number[k], 1.0, 3e-5);
    EXPECT_NEAR(box.number() / exact, 1.0, bound[k]) << k;
    EXPECT_NEAR(box.moment(1) / mass, 1.0, 1e-12);
  }
  EXPECT_EQ(box.did.deficit, 0.0);
  EXPECT_EQ(box.did.emptied, 0u);
  EXPECT_GT(box.did.largest_repetition, 10);
}

TEST(Golovin, number_falls_exponentially) {
  expect_single_run(1.0);
}

TEST(Golovin, long_steps_are_divided_as_accuracy_needs) {
  expect_single_run(10.0);
}

TEST(Golovin, undivided_long_steps_lose_too_many_drops) {
  // −4.6 % at an hour: half of b L dt per e-folding of the number, of which there are 5.4.
  EXPECT_NEAR(mean_number(10.0, never, 12), 0.954, 0.015);
  EXPECT_NEAR(mean_number(10.0, CoalescenceOptions{}.largest_change, 12), 0.9865, 0.015);
}

TEST(Golovin, second_moment_grows_with_twice_the_rate) {
  // Heavy-tailed: 36.6 at 1200 s by a few of the largest drops of an ensemble.
  double sum = 0;
  constexpr int members = 8;
  for (int m = 0; m < members; ++m) {
    ShimaBox box(8192, 700 + static_cast<std::uint64_t>(m));
    const double before = box.moment(2);
    box.run(GolovinKernel{}, 1200, 1.0);
    sum += box.moment(2) / before;
  }
  EXPECT_NEAR(sum / members / 36.60, 1.0, 0.05);
}

TEST(Golovin, error_falls_with_the_square_root_of_the_droplets) {
  // Root mean square error of N at 1200 s; its own uncertainty is 1/√(2·members).
  const auto error = [](std::size_t n, int members) {
    double sum = 0;
    for (int m = 0; m < members; ++m) {
      ShimaBox box(n, 1000 + static_cast<std::uint64_t>(m));
      box.run(GolovinKernel{}, 1200, 2.0);
      const double e = box.number() / std::exp(-ShimaBox::golovin_rate * 1200) - 1.0;
      sum += e * e;
    }
    return std::sqrt(sum / members);
  };
  const double few = error(512, 128), more = error(4096, 32), many = error(32768, 16);
  RecordProperty("slope", std::to_string(std::log2(many / few) / 6));
  EXPECT_NEAR(std::log2(many / few) / 6, -0.5, 0.1);
  EXPECT_NEAR(std::log2(more / few) / 3, -0.5, 0.15);
  EXPECT_NEAR(few, 0.05, 0.01);
}

}  // namespace
}  // namespace pileus::superdroplets
