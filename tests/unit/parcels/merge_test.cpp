// Merging: the numbers of the method's shipped tests, and what a merge must leave alone.
#include "parcels/merge.hpp"

#include <gtest/gtest.h>

#include "parcel_cloud.hpp"
#include "parcels/split.hpp"

namespace pileus::parcels {
namespace {

using std::numbers::pi;
using testing::get_shape;
using testing::put_shape;

const std::vector<Scalar> two_scalars = {
    {"buoyancy", "m s-2", Nature::intensive, "", 0, 0, 0},
    {"humidity", "1", Nature::intensive, "", 0, 0, 0},
    {"amount", "kg", Nature::extensive, "", 0, 0, 0},
    {"temperature", "K", Nature::derived, "", 0, 0, 0},
};

struct Member {
  double x, z, ab, buoyancy, humidity;
};

/// Circles of the given (ab); everything else from its place in the list.
Store circles(const std::vector<Member>& members) {
  Store store(2, two_scalars);
  store.resize(members.size());
  for (std::size_t p = 0; p < members.size(); ++p) {
    const Member& m = members[p];
    store.position(0)[p] = m.x;
    store.position(1)[p] = m.z;
    store.volume()[p] = m.ab * pi;
    store.vorticity(0)[p] = m.buoyancy;
    put_shape<2>(store, p, m.ab * Eigen::Matrix2d::Identity());
    store.scalar(0)[p] = m.buoyancy;
    store.scalar(1)[p] = m.humidity;
    store.scalar(2)[p] = static_cast<double>(p + 1);
    store.scalar(3)[p] = -1e30;
    store.uid()[p] = 100 + p;
  }
  return store;
}

// Dossier 8.3: 1×1 cell, box [−π/2, π/2]².
const mesh::Grid<2> one_cell({1, 1}, {-pi / 2, -pi / 2}, {pi, pi});

struct Outcome {
  MergeCounts counts;
  std::vector<std::size_t> left;  // indices that remain
};
template <int D>
Outcome merge_once(Store& store, const mesh::Grid<D>& grid, double smallest) {
  const Tiling<D> tiling(grid);
  CellOrder<D> order(grid, tiling);
  std::vector<std::uint32_t> keys;
  order.sort(store, keys);
  Merge<D> merge(grid, smallest);
  Outcome outcome{merge.run(store, order), {}};
  for (std::size_t p = 0; p < store.size(); ++p)
    if (merge.gone().empty() || !merge.gone()[p]) outcome.left.push_back(p);
  return outcome;
}

// Dossier 8.5 test 1, numbers as printed there.
TEST(Merge, FourCirclesIntoTheCentralOne) {
  Store store = circles({{0, 0, 0.49, 1.5, 1.3},
                         {0.6, 0, 0.25, 1.8, 1.2},
                         {-0.6, 0, 0.25, 1.4, 1.1},
                         {0, 0.6, 0.25, 1.7, 1.0},
                         {0, -0.6, 0.25, 1.5, 1.4}});
  const auto outcome = merge_once(store, one_cell, 0.3 * pi);
  ASSERT_EQ(outcome.left, std::vector<std::size_t>{0});
  EXPECT_EQ(outcome.counts.small, 4u);
  EXPECT_EQ(outcome.counts.merged, 4u);
  EXPECT_EQ(outcome.counts.clusters[3], 1u);
  EXPECT_NEAR(store.volume()[0], 1.49 * pi, 1e-15 * 8);
  EXPECT_NEAR(store.position(0)[0], 0, 1e-15);
  EXPECT_NEAR(store.position(1)[0], 0, 1e-15);
  EXPECT_NEAR(store.shape(0)[0], 1.49, 1e-13);
  EXPECT_NEAR(store.shape(1)[0], 0, 1e-13);
  EXPECT_NEAR(store.shape(2)[0], 1.49, 1e-13);
  EXPECT_NEAR(store.scalar(0)[0], 1.567114093959731, 1e-13);
  EXPECT_NEAR(store.scalar(1)[0], 1.216107382550336, 1e-13);
  EXPECT_EQ(store.scalar(2)[0], 15);
  EXPECT_EQ(store.scalar(3)[0], -1e30) << "derived quantities do not merge";
  EXPECT_EQ(store.uid()[0], 100u);
}

void expect_numbers_of_test_2(const Store& store, std::size_t r) {
  EXPECT_NEAR(store.shape(0)[r], 2.357021724372224, 1e-13);
  EXPECT_NEAR(store.shape(2)[r], 2.357021724372224, 1e-13);
  EXPECT_NEAR(store.shape(1)[r], 1.338637893219299, 1e-13);
  EXPECT_NEAR(store.volume()[r], 1.94 * pi, 1e-14);
  EXPECT_NEAR(store.scalar(0)[r], 1.525773195876289, 1e-13);
  EXPECT_NEAR(store.scalar(1)[r], 1.261340206185567, 1e-13);
}

// Dossier 8.5 test 2: ab = 1.44 at 0 and two ab = 0.25 at ±d(1,1). The box is widened so that no
// periodic image is nearer. b = 1.5257…= (1.44·1.5 + 0.25(b1 + b2))/1.94 with b1 + b2 = 3.2.
TEST(Merge, TwoCirclesOnTheDiagonal) {
  const double d = 1.202081528;
  const mesh::Grid<2> grid({1, 1}, {-2 * pi, -2 * pi}, {4 * pi, 4 * pi});
  Store store = circles({{0, 0, 1.44, 1.5, 1.3}, {-d, -d, 0.25, 1.8, 1.2}, {d, d, 0.25, 1.4, 1.1}});
  ASSERT_EQ(merge_once(store, grid, 0.3 * pi).left, std::vector<std::size_t>{0});
  // d is printed with nine decimals: its rounding reaches B through 2·4·μ·d.
  EXPECT_NEAR(store.shape(0)[0], 2.357021724372224, 2e-9);
  const double exact = (1.2 + 0.5) / std::sqrt(2.0);
  store = circles(
      {{0, 0, 1.44, 1.5, 1.3}, {-exact, -exact, 0.25, 1.8, 1.2}, {exact, exact, 0.25, 1.4, 1.1}});
  ASSERT_EQ(merge_once(store, grid, 0.3 * pi).left, std::vector<std::size_t>{0});
  expect_numbers_of_test_2(store, 0);
}

// Dossier 8.5 test 3: the same cluster across the periodic edge; the centre comes back into the
// box. In the box of width π the outer two are 0.74 apart across the edge, so both must link to the
// big one: the box is again wider, centred so that the right parcel is across the edge.
TEST(Merge, AcrossThePeriodicEdge) {
  const double d = (1.2 + 0.5) / std::sqrt(2.0), edge = 2 * pi;
  const mesh::Grid<2> grid({1, 1}, {-edge, -edge}, {2 * edge, 2 * edge});
  const double x = edge - 0.07;
  Store store = circles({{x, 0.2, 1.44, 1.5, 1.3},
                         {x - d, 0.2 - d, 0.25, 1.8, 1.2},
                         {x + d - 2 * edge, 0.2 + d, 0.25, 1.4, 1.1}});
  ASSERT_EQ(merge_once(store, grid, 0.3 * pi).left, std::vector<std::size_t>{0});
  expect_numbers_of_test_2(store, 0);
  EXPECT_NEAR(store.position(0)[0], x, 1e-14);
  EXPECT_NEAR(store.position(1)[0], 0.2, 1e-14);
}

// Dossier 8.5 test 4: three small parcels in a row become one in a single call.
TEST(Merge, ThreeSmallParcelsBecomeOne) {
  Store store = circles({{-0.5, 0, 0.25, 1, 1}, {0, 0, 0.26, 2, 1}, {0.5, 0, 0.27, 3, 1}});
  const auto outcome = merge_once(store, one_cell, pi * pi / 3);
  ASSERT_EQ(outcome.left.size(), 1u);
  const std::size_t r = outcome.left[0];
  EXPECT_NEAR(store.volume()[r], 0.78 * pi, 1e-15 * 4);
  EXPECT_NEAR(store.position(0)[r], (0.27 - 0.25) * 0.5 / 0.78, 1e-15);
  EXPECT_EQ(store.uid()[r], 102u) << "the largest member gives its identity";
}

// Dossier 8.5: a cluster and its mirror image give exactly opposite B12.
TEST(Merge, MirrorImagesGiveOppositeShapes) {
  testing::Random random(21);
  const mesh::Grid<2> grid({1, 1}, {-8, -8}, {16, 16});
  for (int draw = 0; draw < 200; ++draw) {
    std::vector<Member> members = {{0, 0, 1.44, 1.5, 1.3}};
    for (int m = 0; m < 3; ++m)
      members.push_back({testing::uniform(random, -1, 1), testing::uniform(random, -1, 1),
                         testing::uniform(random, 0.1, 0.25), 1.5, 1.2});
    std::vector<Member> mirrored = members;
    for (Member& m : mirrored) m.x = -m.x;
    Store a = circles(members), b = circles(mirrored);
    for (std::size_t p = 0; p < a.size(); ++p) {
      put_shape<2>(a, p, testing::random_shape_of_volume<2>(random, a.volume()[p], 2));
      for (int c = 0; c < 3; ++c) b.shape(c)[p] = (c == 1 ? -1 : 1) * a.shape(c)[p];
    }
    const auto left_a = merge_once(a, grid, 0.3 * pi).left,
               left_b = merge_once(b, grid, 0.3 * pi).left;
    ASSERT_EQ(left_a, left_b);
    for (const std::size_t p : left_a) {
      EXPECT_EQ(a.shape(1)[p], -b.shape(1)[p]);
      EXPECT_EQ(a.shape(0)[p], b.shape(0)[p]);
      EXPECT_EQ(a.position(0)[p], -b.position(0)[p]);
      EXPECT_EQ(a.position(1)[p], b.position(1)[p]);
    }
  }
}

// Dossier 7.3: split, then merge the two halves alone: position, volume and shape come back
// exactly, because second moments match and det B is right (1e-14).
template <int D>
void expect_round_trip() {
  testing::Random random(22);
  std::array<int, D> cells;
  std::array<double, D> lower, extent;
  cells.fill(4);
  lower.fill(0);
  extent.fill(40);
  const mesh::Grid<D> grid(cells, lower, extent);
  for (int draw = 0; draw < 500; ++draw) {
    const double volume = testing::uniform(random, 0.5, 2);
    const auto b = testing::random_shape_of_volume<D>(random, volume, 3);
    Store store(D, {});
    store.resize(2);
    Eigen::Matrix<double, D, 1> x;
    for (int d = 0; d < D; ++d) x(d) = testing::uniform(random, 18, 22);
    for (std::size_t p = 0; p < 2; ++p) {
      for (int d = 0; d < D; ++d) store.position(d)[p] = x(d);
      store.volume()[p] = volume;
      put_shape<D>(store, p, b);
      for (int c = 0; c < store.vorticity_components(); ++c) store.vorticity(c)[p] = 0.1 + c;
      store.uid()[p] = 5;
    }
    split_pair<D>(store, grid, CellMetric<D>(grid), 0, 1, 1);
    const auto outcome = merge_once(store, grid, volume * 0.75);
    ASSERT_EQ(outcome.left.size(), 1u);
    const std::size_t r = outcome.left[0];
    EXPECT_EQ(store.volume()[r], volume);
    EXPECT_LT((testing::get_position<D>(store, r) - x).norm(), 1e-14 * 22);
    EXPECT_LT((get_shape<D>(store, r) - b).norm(), 1e-14 * b.norm());
    for (int c = 0; c < store.vorticity_components(); ++c)
      EXPECT_EQ(store.vorticity(c)[r], 0.1 + c);
  }
}
TEST(Merge, UndoesASplitInThePlane) {
  expect_round_trip<2>();
}
TEST(Merge, UndoesASplitInSpace) {
  expect_round_trip<3>();
}

// Strictly below the smallest volume (dossier 7.1, 8.1: "< in merging").
TEST(Merge, SmallMeansStrictlyBelow) {
  Store store = circles({{0, 0, 0.25, 1, 1}, {0.1, 0, 0.26, 2, 1}});
  EXPECT_EQ(merge_once(store, one_cell, store.volume()[0]).counts.small, 0u);
  EXPECT_EQ(merge_once(store, one_cell, std::nextafter(store.volume()[0], 9.0)).counts.merged, 1u);
}

// A void around a small parcel must not stop the run (EPIC aborts, dossier 8.2).
TEST(Merge, SearchesBeyondEmptyCells) {
  const mesh::Grid<3> grid({16, 16, 16}, {0, 0, 0}, {16, 16, 16});
  Store store(3, {});
  store.resize(2);
  for (std::size_t p = 0; p < 2; ++p) {
    for (int d = 0; d < 3; ++d) store.position(d)[p] = p == 0 ? 0.5 : 8.5 + (d == 2 ? 7 : 0);
    store.volume()[p] = p == 0 ? 0.01 : 0.2;
    put_shape<3>(store, p,
                 testing::squared_axes_product<3>(store.volume()[p]) * Eigen::Matrix3d::Identity());
    for (int c = 0; c < 3; ++c) store.vorticity(c)[p] = 0;
    store.uid()[p] = p;
  }
  EXPECT_EQ(merge_once(store, grid, 0.05).left, std::vector<std::size_t>{1});
}

TEST(Merge, ALoneParcelStaysAlone) {
  Store store = circles({{0, 0, 0.25, 1, 1}});
  const auto outcome = merge_once(store, one_cell, 10);
  EXPECT_EQ(outcome.counts.small, 1u);
  EXPECT_EQ(outcome.counts.merged, 0u);
  Store empty = circles({});
  EXPECT_EQ(merge_once(empty, one_cell, 10).counts.small, 0u);
}

}  // namespace
}  // namespace pileus::parcels
