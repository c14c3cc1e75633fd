// Kernels in the sampling: the mean number of coalescences of many independent steps from one state
// is the sum over all pairs of superdroplets, Σ ξ_i ξ_k K_ik dt/ΔV.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "droplet_box.hpp"

namespace pileus::superdroplets {
namespace {

/// Mean over its expectation. Multiplicities differ by up to a factor of eight; the
/// standard deviation of the mean is 0.4 % (30000 steps), and 0.07 % for a million steps, which
/// gave 0.9998 for Golovin's kernel.
template <class Kernel>
double mean_over_expected(const Kernel& kernel, double dt, std::uint64_t steps) {
  constexpr std::size_t n = 301;
  ShimaBox start(n, 4);
  start.options = {std::numeric_limits<double>::infinity(), 1};
  for (std::size_t i = 0; i < n; ++i) start.multiplicity[i] >>= (i * 7) % 4;
  double expected = 0, counted = 0;
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      expected += static_cast<double>(start.multiplicity[i]) *
                  static_cast<double>(start.multiplicity[k]) *
                  kernel(start.water_mass[i], start.water_mass[k]);
    }
  }
  expected *= dt / ShimaBox::volume;
  for (std::uint64_t step = 0; step < steps; ++step) {
    ShimaBox box = start;
    box.step = step;
    box.run(kernel, dt, dt);
    counted += static_cast<double>(box.did.coalescences) / static_cast<double>(steps);
    EXPECT_EQ(box.did.deficit, 0.0);
  }
  return counted / expected;
}

TEST(CoalescenceRate, is_the_sum_over_all_pairs) {
  const FallSpeedTable table(FallSpeedScheme::beard_1976, 283.15, 9e4);
  EXPECT_NEAR(mean_over_expected(GolovinKernel{}, 10.0, 30000), 1.0, 0.02);
  EXPECT_NEAR(mean_over_expected(LongPolynomialKernel{}, 10.0, 30000), 1.0, 0.02);
  EXPECT_NEAR(mean_over_expected(TabulatedKernel{GeometricKernel{}, table}, 10.0, 30000), 1.0,
              0.02);
  EXPECT_NEAR(mean_over_expected(TabulatedKernel{HallKernel{}, table}, 10.0, 30000), 1.0, 0.02);
  EXPECT_NEAR(mean_over_expected(TabulatedKernel{LongKernel{}, table}, 10.0, 30000), 1.0, 0.02);
}

TEST(CoalescenceRate, of_falling_drops_makes_rain) {
  // Shima et al. 2009, fig. 2b: mean radius 30.531 µm, geometric kernel: within half an hour most
  // water is in drops of a millimetre. No published digit: water is kept and the mean grows.
  const FallSpeedTable table(FallSpeedScheme::beard_1976, 293.15, 101325.0);
  const TabulatedKernel kernel{GeometricKernel{}, table};
  ShimaBox box(4096, 6);
  const double water = box.moment(1);
  double number = box.number();
  for (int k = 0; k < 3; ++k) {
    box.run(kernel, 600, 5.0);
    EXPECT_LT(box.number(), 0.5 * number);
    number = box.number();
    EXPECT_NEAR(box.moment(1) / water, 1.0, 1e-12);
  }
  EXPECT_GT(drops::radius_of_mass(box.moment(2) / box.moment(1)), 0.5e-3);
  EXPECT_EQ(box.did.deficit, 0.0);
}

}  // namespace
}  // namespace pileus::superdroplets
