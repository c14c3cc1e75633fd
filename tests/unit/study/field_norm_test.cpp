// Distances of gridded fields.
#include "study/field_norm.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace pileus::study {
namespace {

/// f at the nodes of (z, x): z on [0, 1] with walls, x periodic with length 2π.
template <class F>
GriddedField sample(std::size_t nz, std::size_t nx, F&& f) {
  GriddedField field;
  field.axes.resize(2);
  const double period = 2 * std::numbers::pi;
  field.period = {0, period};
  for (std::size_t k = 0; k <= nz; ++k)
    field.axes[0].push_back(static_cast<double>(k) / static_cast<double>(nz));
  for (std::size_t i = 0; i < nx; ++i)
    field.axes[1].push_back(period * static_cast<double>(i) / static_cast<double>(nx));
  for (const double z : field.axes[0])
    for (const double x : field.axes[1]) field.values.push_back(f(z, x));
  return field;
}

TEST(FieldNorm, NodesThatCoincideAreComparedExactly) {
  const auto f = [](double z, double x) { return z * std::sin(x); };
  EXPECT_LT(field_error(sample(8, 16, f), sample(32, 64, f)), 1e-15);
}

TEST(FieldNorm, BetweenNodesItInterpolatesLinearlyAndPeriodically) {
  // Linear in z: exact. The last interval of x wraps around: cos interpolated between node 7 and 0.
  const GriddedField coarse = sample(4, 8, [](double z, double x) { return z + std::cos(x); });
  GriddedField wanted = coarse;
  wanted.axes = {{0.3}, {2 * std::numbers::pi * 7.5 / 8}};
  const double middle = 0.5 * (std::cos(2 * std::numbers::pi * 7 / 8) + 1);
  EXPECT_NEAR(values_at(coarse, wanted).at(0), 0.3 + middle, 1e-14);
}

TEST(FieldNorm, IsTheRelativeRmsOfTheDifference) {
  const auto f = [](double, double x) { return 5 + std::sin(x); };
  const auto g = [](double, double x) { return 5 + 1.1 * std::sin(x); };
  EXPECT_NEAR(field_error(sample(4, 16, g), sample(4, 16, f)), 0.1, 1e-12);
}

TEST(FieldNorm, HistogramsDoNotSeeWhereAValueStands) {
  ErrorNorm norm;
  norm.bins = 10;
  norm.low = -1;
  norm.high = 1;
  // Bins of width 0.2 over values ±0.5, ±0.1: none near an edge.
  const auto f = [](double, double x) { return x < 3 ? 0.5 : -0.1; };
  const auto shifted = [](double, double x) { return x < 3 ? -0.1 : 0.5; };
  const GriddedField a = sample(4, 16, f), b = sample(4, 16, shifted);
  EXPECT_GT(field_error(a, b), 1);
  EXPECT_LT(histogram_error(a, b, norm), 1e-12);
  const auto other = [](double, double) { return 0.9; };
  // Densities 1/0.2 in one bin against half of that in each of two: √(1 + ¼ + ¼)/√(¼ + ¼).
  EXPECT_NEAR(histogram_error(sample(4, 16, other), a, norm), std::sqrt(3.0), 1e-12);
}

}  // namespace
}  // namespace pileus::study
