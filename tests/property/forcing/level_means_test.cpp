// Means over levels and changes given back: what is conserved, bounded and independent of the
// order.
#include "../../../plugins/large_scale_forcing/level_means.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "../../../plugins/large_scale_forcing/changes.hpp"
#include "../../analytic/forcing/column.hpp"

namespace pileus::large_scale {
namespace {

const Levels levels{-1, 0.4, 12};

std::vector<double> random_values(std::size_t count, double low, double high, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> value(low, high);
  std::vector<double> values(count);
  for (double& v : values) v = value(random);
  return values;
}

long double total(const Cloud& cloud, const std::vector<double>& values) {
  long double sum = 0;
  for (std::size_t p = 0; p < values.size(); ++p)
    sum += static_cast<long double>(cloud.volume[p]) * values[p];
  return sum;
}

TEST(LevelMeans, of_even_parcels_are_those_of_a_straight_line) {
  const Cloud cloud = even_cloud(levels, 400);
  std::vector<double> line;
  for (const double z : cloud.height) line.push_back(3 - 2 * z);
  const Gathered gathered(levels, cloud, {line.data()}, in_order);
  for (std::size_t k = 0; k < levels.count(); ++k) {
    EXPECT_NEAR(gathered.means.volume(k), levels.length(k), 1e-12);
    EXPECT_NEAR(gathered.means.mean(k, 0), 3 - 2 * gathered.means.height(k), 1e-12);
  }
  // The mean over half a hat of parcels d apart is off by their square.
  EXPECT_NEAR(gathered.means.height(0), -1 + 0.4 / 3, 1e-6);
}

TEST(LevelMeans, do_not_depend_on_the_order_of_the_chunks) {
  const Cloud cloud = random_cloud(levels, 20000, 3);
  const auto values = random_values(20000, -1, 1, 4);
  const Gathered a(levels, cloud, {values.data()}, in_order);
  const Gathered b(levels, cloud, {values.data()}, backwards);
  for (std::size_t k = 0; k < levels.count(); ++k) {
    EXPECT_EQ(a.means.volume(k), b.means.volume(k));
    EXPECT_EQ(a.means.height(k), b.means.height(k));
    EXPECT_EQ(a.means.mean(k, 0), b.means.mean(k, 0));
  }
}

/// Σ_p V_p Δφ_p is what the levels were given, wherever the parcels are: sums of 5000 rounded
/// terms.
TEST(LevelIncrements, bring_exactly_what_the_levels_are_given) {
  const Cloud cloud = random_cloud(levels, 5000, 5);
  auto values = random_values(5000, 200, 300, 6);
  const auto amounts = random_values(levels.count(), -50, 70, 7);
  const Gathered gathered(levels, cloud, {values.data()}, in_order);
  std::vector<double> increments(levels.count());
  long double brought = 0;
  for (std::size_t k = 0; k < levels.count(); ++k) {
    increments[k] = amounts[k] / gathered.means.volume(k);
    brought += amounts[k];
  }
  const long double before = total(cloud, values);
  carry_out({values.data(), Sharing::evenly, increments.data(), nullptr, nullptr}, levels,
            cloud.column(), 0, 5000);
  EXPECT_NEAR(static_cast<double>(total(cloud, values) - before), static_cast<double>(brought),
              1e-13 * static_cast<double>(before));
}

TEST(LevelIncrements, in_proportion_bring_as_much_and_leave_nothing_negative) {
  const Cloud cloud = random_cloud(levels, 5000, 8);
  auto values = random_values(5000, -1, 1, 9);
  for (double& v : values) v = std::max(v, 0.0);  // half of the parcels have none
  const Gathered gathered(levels, cloud, {values.data()}, in_order);
  std::vector<double> ratios = random_values(levels.count(), -1, 0.5, 10);
  ratios[3] = -1;
  long double brought = 0;
  for (std::size_t k = 0; k < levels.count(); ++k)
    brought += ratios[k] * gathered.means.mean(k, 0) * gathered.means.volume(k);
  const std::vector<double> old = values;
  const Cuts cuts =
      carry_out({values.data(), Sharing::in_proportion, ratios.data(), nullptr, nullptr}, levels,
                cloud.column(), 0, 5000);
  EXPECT_EQ(cuts.count, 0);
  EXPECT_NEAR(static_cast<double>(total(cloud, values) - total(cloud, old)),
              static_cast<double>(brought), 1e-13 * static_cast<double>(total(cloud, old)));
  for (std::size_t p = 0; p < values.size(); ++p) {
    EXPECT_GE(values[p], 0);
    if (old[p] == 0) {
      EXPECT_EQ(values[p], 0);
    }
  }
}

TEST(LevelIncrements, are_cut_at_zero_and_what_is_cut_is_told) {
  const Cloud cloud = random_cloud(levels, 5000, 11);
  auto values = random_values(5000, 0, 1e-3, 12);
  const std::vector<double> old = values, increments(levels.count(), -2e-4);
  std::vector<double> changeable = increments;
  const Cuts cuts =
      carry_out({values.data(), Sharing::evenly_above_zero, changeable.data(), nullptr, nullptr},
                levels, cloud.column(), 0, 5000);
  EXPECT_GT(cuts.count, 500);
  long double volume = 0;
  for (const double v : cloud.volume) volume += v;
  EXPECT_NEAR(static_cast<double>(total(cloud, values) - total(cloud, old)),
              static_cast<double>(-2e-4L * volume) + cuts.amount, 1e-14);
  EXPECT_EQ(*std::min_element(values.begin(), values.end()), 0);
}

/// Relaxation towards the means of the levels conserves and creates no extrema, for any strength;
/// a mean of n values is itself rounded, by less than n units.
TEST(Relaxation, conserves_and_keeps_extrema) {
  for (const double strongest : {0.1, 1.0}) {
    const Cloud cloud = random_cloud(levels, 5000, 13);
    auto values = random_values(5000, 2, 5, 14);
    auto parts = random_values(levels.count(), 0, strongest, 15);
    parts[2] = strongest, parts[5] = 0;
    const Gathered gathered(levels, cloud, {values.data()}, in_order);
    std::vector<double> target(levels.count());
    for (std::size_t k = 0; k < levels.count(); ++k) target[k] = gathered.means.mean(k, 0);
    const std::vector<double> old = values;
    carry_out({values.data(), Sharing::evenly, nullptr, parts.data(), target.data()}, levels,
              cloud.column(), 0, 5000);
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    EXPECT_GE(*low, *std::min_element(old.begin(), old.end()));
    EXPECT_LE(*high, *std::max_element(old.begin(), old.end()));
    EXPECT_NEAR(static_cast<double>(total(cloud, values) - total(cloud, old)), 0,
                1e-13 * static_cast<double>(total(cloud, old)));
    EXPECT_NE(values, old);
  }
}

TEST(Levels, take_what_is_outside_for_the_nearest_wall) {
  EXPECT_EQ(levels.place(-7).below, 0u);
  EXPECT_EQ(levels.place(-7).above, 0.0);
  EXPECT_EQ(levels.place(std::numeric_limits<double>::quiet_NaN()).below, 0u);
  EXPECT_EQ(levels.place(100).below, levels.cells - 1);
  EXPECT_EQ(levels.place(100).above, 1.0);
}

TEST(LevelMeans, of_an_empty_level_are_told_apart) {
  Cloud cloud;
  cloud.height = {-0.95, -0.9}, cloud.volume = {1, 1};
  const std::vector<double> values = {1, 2};
  const Gathered gathered(levels, cloud, {values.data()}, in_order);
  EXPECT_FALSE(gathered.means.is_empty(1));
  EXPECT_TRUE(gathered.means.is_empty(2));
  EXPECT_EQ(gathered.means.height(2), levels.height(2));
}

}  // namespace
}  // namespace pileus::large_scale
