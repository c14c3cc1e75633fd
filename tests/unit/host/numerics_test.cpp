// The numerical building blocks plugins share.
#include "pileus/numerics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace pileus::numerics {
namespace {

TEST(VectorExp, is_within_two_units_in_the_last_place) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> x(-700, 700);
  for (int i = 0; i < 200000; ++i) {
    const double at = i % 2 == 0 ? x(random) : x(random) * 1e-3;
    // long double exp is correct to well below half a unit of double.
    const long double exact = std::exp(static_cast<long double>(at));
    const double unit =
        std::nextafter(static_cast<double>(exact), INFINITY) - static_cast<double>(exact);
    ASSERT_LE(std::abs(static_cast<double>(vector_exp(at) - exact)), 2 * unit) << "at " << at;
  }
  EXPECT_EQ(vector_exp(0.0), 1.0);
  EXPECT_GT(vector_exp(-1e9), 0.0);
  EXPECT_TRUE(std::isfinite(vector_exp(1e9)));
  EXPECT_TRUE(std::isnan(vector_exp(std::nan(""))));
}

TEST(BracketedNewton, finds_roots_of_functions_that_newton_alone_cannot) {
  // Increasing functions with flat parts, poles nearby, kinks: Newton overshoots or stalls.
  const auto check = [](auto f, double low, double high, double root) {
    const Root found = bracketed_newton(f, low, high, low, 1e-15);
    EXPECT_TRUE(found.converged);
    EXPECT_NEAR(found.x, root, 4e-16 * std::max(1.0, std::abs(root)) + 1e-300);
    EXPECT_LT(found.iterations, 200);
  };
  check(
      [](double x) {
        return ValueAndSlope{std::atan(x - 3), 1 / (1 + (x - 3) * (x - 3))};
      },
      -1e6, 1e6, 3.0);
  check(
      [](double x) {
        return ValueAndSlope{x < 1 ? x - 1 : 100 * (x - 1), x < 1 ? 1.0 : 100.0};
      },
      -50, 50, 1.0);
  check([](double x) { return ValueAndSlope{x < 2 ? -1.0 : 1.0, 0.0}; }, 0, 1e3, 2.0);
  check(
      [](double x) {
        return ValueAndSlope{std::cbrt(x - 0.5), 1 / (3 * std::cbrt((x - 0.5) * (x - 0.5)))};
      },
      -7, 9, 0.5);
  check(
      [](double x) {
        return ValueAndSlope{std::exp(x) - 2, std::exp(x)};
      },
      0, 700, std::log(2.0));
}

TEST(BracketedNewton, reports_a_nan) {
  const auto f = [](double) { return ValueAndSlope{std::nan(""), 1}; };
  EXPECT_FALSE(bracketed_newton(f, 0, 1, 0.5, 1e-12).converged);
}

TEST(BracketedRoot, ends_within_the_evaluations_it_promises) {
  // Flat parts, kinks and jumps, where false position alone creeps.
  const auto check = [](auto f, double low, double high, double root) {
    int evaluations = 0;
    const auto counted = [&](double x) {
      ++evaluations;
      return f(x);
    };
    const Root found = bracketed_root(counted, low, high, 1e-12);
    EXPECT_TRUE(found.converged);
    EXPECT_NEAR(found.x, root, 2e-12);
    EXPECT_LE(evaluations, most_evaluations(high - low, 1e-12));
    EXPECT_EQ(found.iterations, evaluations);
  };
  check([](double x) { return std::atan(x - 3); }, -1e6, 1e6, 3.0);
  check([](double x) { return std::pow(x, 9) - 1e-9; }, -10, 20, 0.1);
  check([](double x) { return x < 2 ? -1.0 : 1e6; }, 0, 1e3, 2.0);
  check([](double x) { return std::exp(x) - 2; }, 0, 700, std::log(2.0));
}

TEST(BracketedRoot, is_the_nearer_end_where_nothing_changes_its_sign) {
  const auto rising = [](double x) { return x; };
  EXPECT_EQ(bracketed_root(rising, 1, 2, 1e-12).x, 1);
  EXPECT_EQ(bracketed_root(rising, -2, -1, 1e-12).x, -1);
  EXPECT_FALSE(bracketed_root(rising, 1, 2, 1e-12).converged);
  EXPECT_FALSE(bracketed_root(rising, -2, -1, 1e-12).converged);
  EXPECT_TRUE(bracketed_root(rising, 0, 1, 1e-12).converged);
  EXPECT_FALSE(bracketed_root([](double) { return std::nan(""); }, 0, 1, 1e-12).converged);
}

TEST(Relaxed, is_exact_for_every_ratio) {
  EXPECT_EQ(relaxed(3.0, 7.0, 0.0), 3.0);
  EXPECT_EQ(relaxed(3.0, 7.0, 1e6), 7.0);
  EXPECT_NEAR(relaxed(3.0, 7.0, 0.5), 7.0 - 4.0 * std::exp(-0.5), 1e-15 * 7);
  EXPECT_NEAR(decay_mean(1e-9), 1 - 0.5e-9, 1e-16);
  EXPECT_EQ(decay_mean(0.0), 1.0);
  EXPECT_NEAR(relaxed_part(1e-9), 1e-9, 1e-18);
}

}  // namespace
}  // namespace pileus::numerics
