// Collision kernels against values computed by an independent program from the same formulas.
#include "../../../plugins/superdroplets/collision_kernels.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace pileus::superdroplets {
namespace {

Drop drop(double radius_um, FallSpeedScheme scheme) {
  const double radius = 1e-6 * radius_um;
  return {drops::mass_of_radius(radius), radius, fall_speed(scheme, radius, 293.15, 101325.0)};
}

struct Pair {
  double large, small, kernel;  // µm, µm, m3 s-1
};

/// The kernel's value for each pair to the seven digits given, and its symmetry.
template <class Kernel>
void expect_values(const Kernel& kernel, FallSpeedScheme scheme,
                   std::initializer_list<Pair> pairs) {
  for (const Pair& p : pairs) {
    const Drop a = drop(p.large, scheme), b = drop(p.small, scheme);
    double value = 0, mirrored = 0;
    if constexpr (KernelOfMasses<Kernel>) {
      value = kernel(a.mass, b.mass);
      mirrored = kernel(b.mass, a.mass);
    } else {
      value = kernel(a, b);
      mirrored = kernel(b, a);
    }
    EXPECT_NEAR(value / p.kernel, 1.0, 5e-7) << p.large << " " << p.small;
    EXPECT_EQ(value, mirrored);
  }
}

TEST(CollisionKernel, golovin_is_the_sum_of_volumes) {
  expect_values(GolovinKernel{}, FallSpeedScheme::none,
                {{20, 10, 5.654867e-11},
                 {30, 10, 1.759292e-10},
                 {40, 20, 4.523893e-10},
                 {100, 20, 6.333451e-9},
                 {500, 100, 7.916813e-7}});
}

TEST(CollisionKernel, geometric_with_speeds_of_beard_1977) {
  expect_values(GeometricKernel{}, FallSpeedScheme::beard_1977,
                {{20, 10, 9.894859e-11},
                 {30, 10, 4.515074e-10},
                 {40, 20, 1.413493e-9},
                 {100, 20, 2.916858e-8},
                 {500, 100, 3.708652e-6}});
  const Drop a = drop(30, FallSpeedScheme::beard_1977), b = drop(10, FallSpeedScheme::beard_1977);
  EXPECT_NEAR(GeometricKernel{0.5}(a, b) / GeometricKernel{}(a, b), 0.5, 1e-15);
}

TEST(CollisionKernel, long_with_speeds_of_simmel) {
  expect_values(LongKernel{}, FallSpeedScheme::simmel,
                {{20, 10, 1.271827e-11},
                 {30, 10, 1.356615e-10},
                 {40, 20, 9.883911e-10},
                 {100, 20, 3.403193e-8},
                 {500, 100, 3.618528e-6}});
  EXPECT_NEAR(LongKernel::efficiency(20e-6, 10e-6), 0.126, 1e-12);
  EXPECT_NEAR(LongKernel::efficiency(30e-6, 10e-6), 0.2835, 1e-12);
  EXPECT_NEAR(LongKernel::efficiency(40e-6, 20e-6), 0.612, 1e-12);
  EXPECT_EQ(LongKernel::efficiency(49.9e-6, 49e-6), 1.0);  // the fit itself exceeds 1 there
  EXPECT_EQ(LongKernel::efficiency(60e-6, 2e-6), 1.0);
  for (const double tiny : {3e-6, 1e-6, 1e-9, 0.0})
    EXPECT_EQ(LongKernel::efficiency(40e-6, tiny), 1e-3);
}

TEST(CollisionKernel, long_polynomial_needs_masses_alone) {
  expect_values(LongPolynomialKernel{}, FallSpeedScheme::none,
                {{20, 10, 1.076620e-11},
                 {30, 10, 1.209127e-10},
                 {40, 20, 6.890370e-10},
                 {60, 10, 5.253832e-9},
                 {100, 20, 2.440490e-8},
                 {500, 100, 3.050612e-6}});
}

TEST(CollisionKernel, of_a_constant_is_that) {
  EXPECT_EQ(ConstantKernel{3e-10}(1e-12, 1e-9), 3e-10);
}

TEST(CollisionKernel, hall_is_the_swept_volume_times_the_efficiency) {
  const Drop a = drop(40, FallSpeedScheme::beard_1976), b = drop(20, FallSpeedScheme::beard_1976);
  EXPECT_NEAR(HallKernel{}(a, b), 0.8 * GeometricKernel{}(a, b), 1e-22);
  EXPECT_EQ(HallKernel{}(a, b), HallKernel{}(b, a));
}

TEST(HallEfficiency, has_the_nodes_of_the_table) {
  const struct {
    double large;
    std::array<double, 10> at_tenths;
  } rows[] = {{10, {.0001, .014, .019, .027, .033, .037, .038, .036, .032, .027}},
              {20, {.0001, .016, .030, .052, .072, .082, .076, .057, .040, .027}},
              {30, {.002, .040, .170, .400, .550, .590, .540, .490, .450, .520}},
              {40, {.070, .500, .680, .780, .800, .780, .760, .770, .790, 1.40}},
              {50, {.400, .700, .830, .880, .900, .900, .880, .890, 1.01, 2.30}},
              {60, {.430, .770, .870, .900, .910, .910, .920, .950, 1.03, 3.00}},
              {70, {.580, .840, .900, .940, .950, .950, .950, 1.00, 1.04, 4.00}},
              {100, {.790, .950, 1, 1, 1, 1, 1, 1, 1, 1}},
              {200, {.960, 1, 1, 1, 1, 1, 1, 1, 1, 1}}};
  for (const auto& row : rows) {
    for (std::size_t j = 0; j < 10; ++j) {
      const double small = row.large * 0.1 * static_cast<double>(j + 1);
      EXPECT_NEAR(hall_efficiency(1e-6 * row.large, 1e-6 * small), row.at_tenths[j], 1e-12)
          << row.large << " " << small;
    }
  }
}

TEST(HallEfficiency, has_the_halves_of_four_rows) {
  const struct {
    double large;
    std::array<double, 10> at_halves;  // r/R = .05, .15 …
  } rows[] = {{20, {.0001, .005, .022, .043, .064, .079, .080, .067, .048, .033}},
              {40, {.001, .28, .62, .74, .80, .80, .77, .77, .78, .95}},
              {60, {.05, .64, .84, .89, .91, .91, .91, .93, 1.0, 1.7}},
              {100, {.5, .91, .95, 1, 1, 1, 1, 1, 1, 1}}};
  for (const auto& row : rows) {
    for (std::size_t j = 0; j < 10; ++j) {
      const double small = row.large * (0.05 + 0.1 * static_cast<double>(j));
      EXPECT_NEAR(hall_efficiency(1e-6 * row.large, 1e-6 * small), row.at_halves[j], 1e-12)
          << row.large << " " << small;
    }
  }
}

TEST(HallEfficiency, is_linear_between_nodes_and_has_ends) {
  EXPECT_NEAR(hall_efficiency(25e-6, 12.5e-6), 0.5 * (.072 + .550), 1e-12);
  EXPECT_NEAR(hall_efficiency(85e-6, 8.5e-6), 0.5 * (.580 + .790), 1e-12);
  EXPECT_NEAR(hall_efficiency(40e-6, 21e-6), .80, 1e-12);
  EXPECT_EQ(hall_efficiency(9.9e-6, 5e-6), 0.0);
  EXPECT_EQ(hall_efficiency(300e-6, 1e-6), 1.0);
  EXPECT_EQ(hall_efficiency(1e-2, 1e-9), 1.0);
  EXPECT_EQ(hall_efficiency(50e-6, 0.0), 0.0);
  EXPECT_EQ(hall_efficiency(0.0, 0.0), 0.0);
}

TEST(TabulatedKernel, equals_the_kernel_of_the_exact_speeds) {
  const FallSpeedTable table(FallSpeedScheme::beard_1976, 293.15, 101325.0);
  const TabulatedKernel tabulated{GeometricKernel{}, table};
  const Beard1976 beard(293.15, 101325.0);
  for (double large = 12e-6; large < 3e-3; large *= 1.37) {
    for (double small = 1.1e-6; small < 0.7 * large; small *= 1.41) {
      const double m = drops::mass_of_radius(large), n = drops::mass_of_radius(small);
      const double exact =
          GeometricKernel{}(Drop{m, large, beard(large)}, Drop{n, small, beard(small)});
      EXPECT_NEAR(tabulated(m, n) / exact, 1.0, 4e-4) << large << " " << small;
    }
  }
}

}  // namespace
}  // namespace pileus::superdroplets
