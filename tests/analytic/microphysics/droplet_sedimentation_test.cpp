// Drops that change parcels as they fall: where they start, who takes them over, how far they get.
#include "../../../plugins/superdroplets/sedimentation.hpp"

#include <gtest/gtest.h>
#include <pileus/philox.hpp>

#include <array>
#include <cmath>
#include <vector>

namespace pileus::superdroplets {
namespace {

/// Draws of equal spacing: a stratified sample of (0, 1).
double stratified(int i, int n) {
  return (i + 0.5) / n;
}

TEST(DropletSedimentation, heights_at_random_are_those_of_an_ellipsoid) {
  constexpr int n = 20000;
  double mean = 0, square = 0;
  for (int i = 0; i < n; ++i) {
    const double u = stratified(i, n), s = random_relative_height(u);
    EXPECT_NEAR((2 + 3 * s - s * s * s) / 4, u, 1e-14);  // volume below s over the whole
    mean += s / n;
    square += s * s / n;
  }
  EXPECT_NEAR(mean, 0.0, 1e-12);
  EXPECT_NEAR(square, 0.2, 1e-6);  // of a uniform ellipsoid
}

TEST(DropletSedimentation, drops_leave_through_the_lower_surface_of_an_ellipsoid) {
  // At s_0 ≤ 0 drops are spread over the cross-section ∝ 1 − s_0²; 1 − s² of it is above a surface
  // point deeper than s.
  constexpr int n = 20000;
  for (const double from : {0.9, 0.0, -0.4, -0.9}) {
    const double start = std::min(from, 0.0), deep = 0.5 * (start - 1.0);
    int left = 0;
    for (int i = 0; i < n; ++i) {
      const double exit = exit_height(from, stratified(i, n));
      EXPECT_LE(exit, start);
      EXPECT_GE(exit, -1.0);
      left += exit > deep ? 1 : 0;
    }
    const double stay = (1.0 - deep * deep) / (1.0 - start * start);
    EXPECT_NEAR(static_cast<double>(left) / n, 1.0 - stay, 1.0 / n) << from;
  }
  EXPECT_EQ(exit_height(-1.5, 0.3), -1.5);  // left below its parcel: at once
}

TEST(DropletSedimentation, receivers_are_chosen_by_their_upper_surfaces) {
  // At 12 m: V/a² s = 100/25·0.4 = 1.6, 0 (does not reach it), 0 (above its centre), 200/100·0.4.
  const std::array<ParcelSpan, 4> parcels = {ParcelSpan{10, 5, 100}, ParcelSpan{2, 9, 1e6},
                                             ParcelSpan{17, 10, 400}, ParcelSpan{8, 10, 200}};
  constexpr int n = 9000;
  std::array<int, 4> chosen{};
  for (int i = 0; i < n; ++i) {
    const Receiver r = choose_receiver(12, parcels, 50, stratified(i, n));
    ++chosen[r.parcel];
    EXPECT_NEAR(height_of(r.relative_height, parcels[r.parcel]), 12, 1e-12);
    EXPECT_EQ(r.share, 1.0);
  }
  EXPECT_EQ(chosen, (std::array<int, 4>{6000, 0, 0, 3000}));
}

TEST(DropletSedimentation, small_parcels_take_small_shares_more_often) {
  const std::array<ParcelSpan, 2> parcels = {ParcelSpan{10, 5, 100}, ParcelSpan{8, 10, 200}};
  constexpr int n = 3000;  // weights 1.6 and 0.8 as before, shares 1/4 and 1/2 of 400 m3
  std::array<double, 2> taken{};
  for (int i = 0; i < n; ++i) {
    const Receiver r = choose_receiver(12, parcels, 400, stratified(i, n));
    EXPECT_EQ(r.share, r.parcel == 0 ? 0.25 : 0.5);
    taken[r.parcel] += r.share;
  }
  EXPECT_NEAR(taken[0] / taken[1], 2.0, 0.01);
}

TEST(DropletSedimentation, the_nearest_parcel_takes_what_none_reaches) {
  const std::array<ParcelSpan, 3> parcels = {ParcelSpan{100, 10, 1}, ParcelSpan{70, 2, 1},
                                             ParcelSpan{40, 20, 1}};
  for (const double u : {1e-9, 0.5, 1 - 1e-9}) {
    const Receiver r = choose_receiver(75, parcels, 1, u);  // 2.5, 2.5 and 1.75 half-extents away
    EXPECT_EQ(r.parcel, 2u);
    EXPECT_EQ(height_of(r.relative_height, parcels[2]), 75.0);  // not moved to its edge
  }
}

TEST(DropletSedimentation, without_candidates_nobody_is_chosen) {
  EXPECT_EQ(choose_receiver(5, {}, 1, 0.5).parcel, 0u);
}

/// The image of each parcel of a periodic column that is nearest to a height.
std::vector<ParcelSpan> images(const std::vector<ParcelSpan>& column, double depth, double height) {
  std::vector<ParcelSpan> near = column;
  for (ParcelSpan& p : near) p.height += depth * std::round((height - p.height) / depth);
  return near;
}

TEST(DropletSedimentation, parcels_hold_drops_in_proportion_to_their_volume) {
  // A periodic column of 1500 flat, round and tall parcels of two volumes; drops fall through it,
  // and the time they spend in each kind is its share of them. The expected value is that of evenly
  // distributed drops: the share of the volume.
  constexpr double depth = 1000, fall = 0.5;
  std::vector<ParcelSpan> column;
  for (int q = 0; q < 1500; ++q) {
    const double extent = q % 3 == 0 ? 5 : q % 3 == 1 ? 10 : 20;
    column.push_back({std::fmod(0.61803398875 * q, 1.0) * depth, extent, q % 2 == 0 ? 1.0 : 3.0});
  }
  std::array<double, 3> held{}, volume{};
  for (std::size_t q = 0; q < column.size(); ++q) volume[q % 3] += column[q].volume;
  double total = 0;
  std::uint64_t draws = 0;
  for (std::size_t drop = 0; drop < 60; ++drop) {
    std::size_t owner = drop * 25;
    double s = 0, height = column[owner].height;
    for (int step = 0; step < 3000; ++step) {
      std::array<double, 2> u{};
      draw_uniform({1, 2, draws++, 0, 0, 0}, 2, u.data());
      const double exit = exit_height(s, u[0]), end = s - fall / column[owner].half_extent;
      height -= fall;
      if (exit >= end) {
        const double at = height + (exit - end) * column[owner].half_extent;
        const Receiver r = choose_receiver(at, images(column, depth, at), 1, u[1]);
        owner = r.parcel;
        s = r.relative_height - (at - height) / column[owner].half_extent;
      } else {
        s = end;
      }
      if (step < 300) continue;
      held[owner % 3] += 1;
      total += 1;
    }
  }
  const double all = volume[0] + volume[1] + volume[2];
  for (std::size_t kind = 0; kind < 3; ++kind)
    EXPECT_NEAR(held[kind] / total / (volume[kind] / all), 1.0, 0.06) << kind;
}

}  // namespace
}  // namespace pileus::superdroplets
