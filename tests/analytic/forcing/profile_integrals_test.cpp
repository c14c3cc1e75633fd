// Integrals of profiles over hat functions against sums over many points and closed forms.
#include "../../../plugins/large_scale_forcing/profile_integrals.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "../../../plugins/large_scale_forcing/level_sources.hpp"

namespace pileus::large_scale {
namespace {

const Levels levels{-50, 100, 30};

PiecewiseLinear kinked() {
  static constexpr std::array<double, 10> points = {0,    0,    1500, -0.0065, 2100,
                                                    0.25, 2101, 3,    2400,    -1};
  return PiecewiseLinear(points);
}

double hat(std::size_t k, double z) {
  return std::max(0.0, 1 - std::abs(z - levels.height(k)) / levels.spacing);
}

TEST(ProfileIntegrals, agree_with_sums_over_many_points) {
  const PiecewiseLinear profile = kinked();
  constexpr int n = 300000;
  std::vector<double> sums(levels.count(), 0.0);
  for (int i = 0; i < n; ++i) {
    const double z = levels.bottom + (i + 0.5) / n * levels.depth();
    const std::size_t below = levels.place(z).below;
    sums[below] += profile(z) * hat(below, z) * levels.depth() / n;
    sums[below + 1] += profile(z) * hat(below + 1, z) * levels.depth() / n;
  }
  // The midpoint rule on points 0.01 m apart is off by their square times the slopes' jumps.
  for (std::size_t k = 0; k < levels.count(); ++k)
    EXPECT_NEAR(hat_integral(profile, levels, k), sums[k], 1e-4) << k;
}

/// Hat functions sum to one: so do the integrals, for any kinks between the levels.
TEST(ProfileIntegrals, sum_to_the_integral_of_the_profile) {
  const PiecewiseLinear profile = kinked();
  double sum = 0, slopes = 0;
  for (std::size_t k = 0; k < levels.count(); ++k) {
    sum += hat_integral(profile, levels, k);
    slopes += slope_integral(profile, levels, k);
  }
  const double exact = profile.integral(levels.bottom, levels.top());
  EXPECT_NEAR(sum, exact, 1e-13 * std::abs(exact));
  EXPECT_NEAR(slopes, profile(levels.top()) - profile(levels.bottom), 1e-14);
  EXPECT_NEAR(depth_mean(profile, levels), exact / 3000, 1e-16);
}

TEST(ProfileIntegrals, of_a_straight_line_are_exact) {
  static constexpr std::array<double, 4> points = {-1000, -2, 9000, 18};  // 2e-3 z
  const PiecewiseLinear line(points);
  for (std::size_t k = 0; k < levels.count(); ++k) {
    // The mean over the half hat of a wall lies a third of a spacing inside.
    const double z = levels.height(k) + (k == 0              ? levels.spacing / 3
                                         : k == levels.cells ? -levels.spacing / 3
                                                             : 0.0);
    EXPECT_NEAR(hat_integral(line, levels, k) / levels.length(k), 2e-3 * z, 1e-13) << k;
    EXPECT_NEAR(slope_integral(line, levels, k) / levels.length(k), 2e-3, 1e-15) << k;
  }
}

/// A jump of the slope within a layer is shared between its levels by where it lies.
TEST(ProfileIntegrals, of_a_slope_that_changes_within_a_layer) {
  static constexpr std::array<double, 6> points = {-100, 0, 75, 0, 1075, 5};  // 25 m above level 1
  const PiecewiseLinear bent(points);
  // 5e-3 times the part of the hat above the kink: triangles of base 75 m and height 0.75, and the
  // remainder of the layer and half a hat.
  EXPECT_NEAR(slope_integral(bent, levels, 1), 5e-3 * 0.5 * 75 * 0.75, 1e-15);
  EXPECT_NEAR(slope_integral(bent, levels, 2), 5e-3 * (100 - 0.5 * 25 * 0.25), 1e-15);
}

/// The core turns the wind by R; with the push, R u + (1 − R) u_g leaves u_g as it is.
TEST(GeostrophicPush, completes_the_rotation_about_the_geostrophic_wind) {
  const double f = 1e-4, dt = 30, angle = f * dt, u = -8, v = 3;
  const GeostrophicPush push(f, dt);
  EXPECT_NEAR(u * std::cos(angle) + v * std::sin(angle) + push.x(u, v), u, 1e-15 * 10);
  EXPECT_NEAR(v * std::cos(angle) - u * std::sin(angle) + push.y(u, v), v, 1e-15 * 10);
  // du/dt = −f v_g, dv/dt = f u_g to first order.
  EXPECT_NEAR(push.x(u, v) / dt, -f * v, f * 10 * angle);
  EXPECT_NEAR(push.y(u, v) / dt, f * u, f * 10 * angle);
}

}  // namespace
}  // namespace pileus::large_scale
