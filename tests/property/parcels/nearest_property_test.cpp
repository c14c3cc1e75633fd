// The quick search finds what looking at every parcel of the cells around finds.
#include "parcels/nearest.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "../../unit/parcels/parcel_cloud.hpp"
#include "parcels/merge.hpp"

namespace pileus::parcels {
namespace {

using pileus::testing::Random;
using pileus::testing::uniform;

/// Double loop over the cells around the node nearest to p; of equal distances the smaller
/// identity.
template <int D>
std::uint32_t plain_nearest(const mesh::Grid<D>& grid, const Store& store, std::uint32_t p) {
  const auto near = [&](std::uint32_t q) {
    for (int d = 0; d < D; ++d) {
      const int n = grid.cells[d];
      const double xi = (store.position(d)[p] - grid.lower[d]) * grid.inverse_spacing[d];
      const double xq = (store.position(d)[q] - grid.lower[d]) * grid.inverse_spacing[d];
      const int node = static_cast<int>(std::lround(xi)), cell = static_cast<int>(xq);
      const int below = d == D - 1 ? node - 1 : (node - 1 + n) % n;
      const int above = d == D - 1 ? node : node % n;
      if (cell != below && cell != above) return false;
    }
    return true;
  };
  double best_distance = std::numeric_limits<double>::infinity();
  std::uint32_t best = NearestParcel<D>::nobody;
  for (std::uint32_t q = 0; q < store.size(); ++q) {
    if (q == p || !near(q)) continue;
    double distance = 0;
    for (int d = 0; d < D; ++d) {
      double x = store.position(d)[q] - store.position(d)[p];
      if (d < D - 1) x = minimum_image(x, grid.extent[d]);
      distance += x * x;
    }
    if (distance < best_distance ||
        (distance == best_distance && store.uid()[q] < store.uid()[best])) {
      best_distance = distance;
      best = q;
    }
  }
  return best;
}

template <int D>
void expect_agreement(const mesh::Grid<D>& grid, const Store& store) {
  const Tiling<D> tiling(grid);
  CellOrder<D> order(grid, tiling);
  std::vector<std::uint32_t> keys;
  order.sort(store, keys);
  NearestParcel<D> nearest(grid);
  nearest.prepare(store, order);
  for (std::uint32_t p = 0; p < store.size(); ++p)
    ASSERT_EQ(nearest.of(p), plain_nearest<D>(grid, store, p)) << "parcel " << p;
}

/// Parcels crowded around one point, on a lattice of equal distances, and at one point.
template <int D>
void place(Store& store, const mesh::Grid<D>& grid, Random& random, int kind) {
  for (std::size_t p = 0; p < store.size(); ++p) {
    store.uid()[p] = (p * 7919) % 10007 + 1;  // not in the order of the places
    for (int d = 0; d < D; ++d) {
      const double lattice = static_cast<double>((p >> (3 * d)) % 8) / 8;
      const double place = kind == 0   ? uniform(random, 0.0, 1.0)
                           : kind == 1 ? uniform(random, 0.0, 0.3)
                           : kind == 2 ? lattice
                                       : 0.25;
      store.position(d)[p] = grid.lower[d] + place * grid.extent[d] * (1 - 1e-15);
    }
  }
}

template <int D>
void expect_agreement_on_crowds() {
  Random random(7);
  for (const int cells : {1, 2, 3, 5}) {
    std::array<int, D> n;
    std::array<double, D> lower, extent;
    n.fill(cells);
    lower.fill(-1.5);
    extent.fill(4.0);
    const mesh::Grid<D> grid(n, lower, extent);
    for (int kind = 0; kind < 4; ++kind) {
      Store store(D, {});
      store.resize(700);
      place<D>(store, grid, random, kind);
      SCOPED_TRACE(::testing::Message() << cells << " cells, kind " << kind);
      expect_agreement<D>(grid, store);
    }
  }
}

TEST(NearestProperty, EqualsLookingAtEveryParcelInThePlane) {
  expect_agreement_on_crowds<2>();
}
TEST(NearestProperty, EqualsLookingAtEveryParcelInSpace) {
  expect_agreement_on_crowds<3>();
}

// A hundred thousand parcels in one cell: by comparing all pairs this takes minutes. Anywhere in
// the cell, on a lattice of ties, and all at one point (scenes reference 9, cases 23 and 24).
TEST(MergeStorm, IsOverInOneCall) {
  const mesh::Grid<3> grid({4, 4, 4}, {0, 0, 0}, {4, 4, 4});
  constexpr std::size_t count = 100000;
  for (int kind = 0; kind < 3; ++kind) {
    Store store(3, {{"buoyancy", "m s-2", Nature::intensive, "", 0, 0, 0}});
    store.resize(count);
    Random random(3);
    double volume = 0;
    for (std::size_t p = 0; p < count; ++p) {
      store.uid()[p] = p + 1;
      store.volume()[p] = 1e-5;
      volume += store.volume()[p];
      const std::size_t index[3] = {p % 47, p / 47 % 47, p / (47 * 47)};
      for (int d = 0; d < 3; ++d)
        store.position(d)[p] = kind == 0   ? uniform(random, 1.0, 2.0)
                               : kind == 1 ? 1 + static_cast<double>(index[d]) / 48
                                           : 1.25;
      for (int c = 0; c < 3; ++c) store.vorticity(c)[p] = 0;
      for (int c = 0; c < 6; ++c) store.shape(c)[p] = c == 0 || c == 3 || c == 5 ? 1e-4 : 0;
      store.scalar(0)[p] = uniform(random, -1, 1);
    }
    const Tiling<3> tiling(grid);
    CellOrder<3> order(grid, tiling);
    std::vector<std::uint32_t> keys;
    order.sort(store, keys);
    Merge<3> merge(grid, 0.05);
    const MergeCounts counts = merge.run(store, order);
    EXPECT_EQ(counts.small, count);
    double left = 0;
    for (std::size_t p = 0; p < count; ++p)
      if (!merge.gone()[p]) left += store.volume()[p];
    // Sums of n equal numbers round by at most n/2 units in the last place of the whole.
    EXPECT_NEAR(left, volume, volume * count * 1.1e-16);
    // Everyone is source or receiver, so at least half of them go; ties may leave one per cycle.
    EXPECT_GE(counts.merged, count / 3) << "kind " << kind;
    if (kind == 2) {
      EXPECT_EQ(counts.merged, count - 1);  // all have the same nearest
    }
  }
}

}  // namespace
}  // namespace pileus::parcels
