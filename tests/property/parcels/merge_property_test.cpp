// Merging random clouds: what is conserved, what never widens, who is left, and what does not
// depend on the order in memory or the number of threads.
#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <map>
#include <numeric>

#include "../../unit/parcels/parcel_cloud.hpp"
#include "parcels/merge.hpp"

namespace pileus::parcels {
namespace {

using testing::uniform;

const std::vector<Scalar> scalars = {{"specific", "1", Nature::intensive, "", 0, 0, 0},
                                     {"amount", "kg", Nature::extensive, "", 0, 0, 0}};

template <int D>
mesh::Grid<D> unit_box(int cells) {
  std::array<int, D> n;
  std::array<double, D> lower, extent;
  n.fill(cells);
  lower.fill(0);
  extent.fill(1);
  return {n, lower, extent};
}

/// Merges; `left` lists the remaining parcels.
template <int D>
MergeCounts merge(Store& store, const mesh::Grid<D>& grid, double smallest,
                  std::vector<std::size_t>& left) {
  const Tiling<D> tiling(grid);
  CellOrder<D> order(grid, tiling);
  std::vector<std::uint32_t> keys;
  order.sort(store, keys);
  Merge<D> merging(grid, smallest);
  const MergeCounts counts = merging.run(store, order);
  left.clear();
  for (std::size_t p = 0; p < store.size(); ++p)
    if (merging.gone().empty() || !merging.gone()[p]) left.push_back(p);
  return counts;
}

template <int D>
Store cloud(const mesh::Grid<D>& grid, std::size_t count, unsigned seed) {
  testing::Random random(seed);
  Store store(D, scalars);
  testing::fill_randomly<D>(store, grid, count, 1.0 / static_cast<double>(count), 2, random);
  return store;
}

template <int D>
void expect_conservation(int cells, std::size_t count) {
  const mesh::Grid<D> grid = unit_box<D>(cells);
  Store store = cloud<D>(grid, count, 111);
  std::vector<std::size_t> left(count);
  std::iota(left.begin(), left.end(), std::size_t{0});
  const auto totals = [&](bool extensive_too) {
    std::vector<long double> sums(static_cast<std::size_t>(2 + store.vorticity_components()), 0.0L);
    for (const std::size_t p : left) {
      std::size_t s = 0;
      const long double v = store.volume()[p];
      sums[s++] += v;
      for (int c = 0; c < store.vorticity_components(); ++c) sums[s++] += v * store.vorticity(c)[p];
      sums[s++] += v * store.scalar(0)[p];
      if (extensive_too) sums.push_back(store.scalar(1)[p]);
    }
    return sums;
  };
  const auto range = [&](const double* values) {
    double low = 1e300, high = -1e300;
    for (const std::size_t p : left) {
      low = std::min(low, values[p]);
      high = std::max(high, values[p]);
    }
    return std::pair(low, high);
  };
  const auto before = totals(false);
  double amount = 0;
  for (const std::size_t p : left) amount += store.scalar(1)[p];
  const auto bounds = range(store.scalar(0)), turning = range(store.vorticity(0));
  const double smallest = 1.0 / static_cast<double>(count);  // about half of the parcels
  std::size_t merged = 0;
  for (int round = 0; round < 6; ++round) {
    // Merge the survivors of the last round only.
    Store next(D, scalars);
    next.resize(left.size());
    for (int c = 0; c < store.column_count(); ++c)
      for (std::size_t p = 0; p < left.size(); ++p) next.column(c)[p] = store.column(c)[left[p]];
    for (std::size_t p = 0; p < left.size(); ++p) next.uid()[p] = store.uid()[left[p]];
    store = std::move(next);
    const std::size_t size = store.size();
    const MergeCounts counts = merge<D>(store, grid, smallest, left);
    EXPECT_EQ(left.size() + counts.merged, size);
    EXPECT_GE(counts.small, counts.merged);
    merged += counts.merged;
    if (round == 0) {
      EXPECT_GT(counts.merged, counts.small / 2);
    }
    for (const std::size_t p : left) {
      // Volume and shape agree; centres stay in the box.
      EXPECT_NEAR(testing::get_shape<D>(store, p).determinant() /
                      testing::squared_axes_product<D>(store.volume()[p]),
                  1, 1e-11);
      for (int d = 0; d < D; ++d) {
        EXPECT_GE(store.position(d)[p], 0);
        EXPECT_LE(store.position(d)[p], 1);
      }
    }
  }
  EXPECT_GT(merged, count / 4);
  const auto after = totals(false);
  for (std::size_t s = 0; s < before.size(); ++s)
    EXPECT_NEAR(static_cast<double>(after[s]), static_cast<double>(before[s]), 1e-13);
  double amount_after = 0;
  for (const std::size_t p : left) amount_after += store.scalar(1)[p];
  EXPECT_NEAR(amount_after, amount, 1e-12 * static_cast<double>(count));
  // Acceptance 22: min/max never widened, bitwise.
  EXPECT_GE(range(store.scalar(0)).first, bounds.first);
  EXPECT_LE(range(store.scalar(0)).second, bounds.second);
  EXPECT_GE(range(store.vorticity(0)).first, turning.first);
  EXPECT_LE(range(store.vorticity(0)).second, turning.second);
  // Identities remain those of parents, each once.
  std::vector<std::uint64_t> uids;
  for (const std::size_t p : left) uids.push_back(store.uid()[p]);
  std::sort(uids.begin(), uids.end());
  EXPECT_EQ(std::adjacent_find(uids.begin(), uids.end()), uids.end());
  EXPECT_LE(uids.back(), count);
}
TEST(MergeProperty, ConservesAndNeverWidens) {
  expect_conservation<3>(8, 3000);
  expect_conservation<2>(20, 2000);
  expect_conservation<3>(1, 50);
  expect_conservation<3>(2, 300);
}

// A constant stays the same constant, bit by bit, however often it is averaged.
TEST(MergeProperty, ConstantsStayBitwise) {
  const mesh::Grid<3> grid = unit_box<3>(6);
  Store store = cloud<3>(grid, 2000, 112);
  std::fill(store.scalar(0), store.scalar(0) + 2000, 0.1);
  std::vector<std::size_t> left;
  merge<3>(store, grid, 1, left);
  for (const std::size_t p : left) EXPECT_EQ(store.scalar(0)[p], 0.1);
}

/// The centroid of a cluster that does not cross the seam: Σ V x is conserved as well.
TEST(MergeProperty, CentroidAwayFromTheSeam) {
  const mesh::Grid<3> grid({8, 8, 8}, {-5, -5, 0}, {11, 11, 1});
  testing::Random random(113);
  Store store(3, scalars);
  const mesh::Grid<3> middle = unit_box<3>(1);
  testing::fill_randomly<3>(store, middle, 400, 1.0 / 400, 2, random);
  long double before[3] = {}, after[3] = {};
  for (int d = 0; d < 3; ++d)
    for (std::size_t p = 0; p < 400; ++p)
      before[d] += static_cast<long double>(store.volume()[p]) * store.position(d)[p];
  std::vector<std::size_t> left;
  merge<3>(store, grid, 1.0 / 400, left);
  ASSERT_LT(left.size(), 400u);
  for (int d = 0; d < 3; ++d) {
    for (const std::size_t p : left)
      after[d] += static_cast<long double>(store.volume()[p]) * store.position(d)[p];
    EXPECT_NEAR(static_cast<double>(after[d]), static_cast<double>(before[d]), 1e-14);
  }
}

using Result = std::map<std::uint64_t, std::vector<double>>;
template <int D>
Result merged_state(Store& store, const mesh::Grid<D>& grid, double smallest) {
  std::vector<std::size_t> left;
  merge<D>(store, grid, smallest, left);
  Result result;
  for (const std::size_t p : left)
    for (int c = 0; c < store.state_columns(); ++c)
      result[store.uid()[p]].push_back(store.column(c)[p]);
  return result;
}

/// Shuffles the order in memory and the number of threads: every bit of every survivor is the same.
template <int D>
void expect_order_does_not_matter(const Store& original, const mesh::Grid<D>& grid,
                                  double smallest) {
  const int threads_before = omp_get_max_threads();
  testing::Random random(114);
  Result first;
  for (int round = 0; round < 6; ++round) {
    std::vector<std::size_t> place(original.size());
    std::iota(place.begin(), place.end(), std::size_t{0});
    if (round > 0) std::shuffle(place.begin(), place.end(), random);
    Store store(D, scalars);
    store.resize(original.size());
    for (int c = 0; c < store.column_count(); ++c)
      for (std::size_t p = 0; p < place.size(); ++p)
        store.column(c)[p] = original.column(c)[place[p]];
    for (std::size_t p = 0; p < place.size(); ++p) store.uid()[p] = original.uid()[place[p]];
    omp_set_num_threads(1 + round % 3);
    const Result result = merged_state<D>(store, grid, smallest);
    if (round == 0) first = result;
    EXPECT_EQ(result, first) << round;
  }
  omp_set_num_threads(threads_before);
}
TEST(MergeProperty, OrderInMemoryAndThreadsDoNotMatter) {
  const mesh::Grid<3> grid = unit_box<3>(8);
  expect_order_does_not_matter<3>(cloud<3>(grid, 3000, 115), grid, 1.0 / 3000);
  const mesh::Grid<2> plane = unit_box<2>(12);
  expect_order_does_not_matter<2>(cloud<2>(plane, 2000, 116), plane, 1.0 / 2000);
}

// Dossier 8.3: regular lattices tie everywhere. Ties go to the smaller identity, so the outcome is
// a function of the parcels and nobody small is left over.
TEST(MergeProperty, TiesOnLatticesAreResolved) {
  const mesh::Grid<3> grid = unit_box<3>(8);
  Store store = cloud<3>(grid, 4096, 117);
  for (std::size_t p = 0; p < 4096; ++p) {
    // Spacing 1/16: exactly representable, so all distances tie exactly.
    const std::size_t index[3] = {p % 16, p / 16 % 16, p / 256};
    for (int d = 0; d < 3; ++d) store.position(d)[p] = (static_cast<double>(index[d]) + 0.5) / 16;
    store.volume()[p] = 1.0 / 4096;
    store.uid()[p] = (p * 2654435761u) % 1000003 + 1;
  }
  expect_order_does_not_matter<3>(store, grid, 1.5 / 4096);
  std::vector<std::size_t> left;
  const MergeCounts counts = merge<3>(store, grid, 1.5 / 4096, left);
  EXPECT_EQ(counts.small, 4096u);
  EXPECT_GE(counts.merged, 2048u);
  for (const std::size_t p : left) EXPECT_GT(store.volume()[p], 1.5 / 4096);
}

// Many parcels at one point: everything is at distance zero of everything, so all ties are broken
// by identity and one parcel is left. The search is quadratic in the parcels of a cell.
TEST(MergeProperty, AStormAtOnePointTerminates) {
  const mesh::Grid<3> grid = unit_box<3>(16);
  constexpr std::size_t count = 6000;
  Store store = cloud<3>(grid, count, 118);
  for (int d = 0; d < 3; ++d) std::fill(store.position(d), store.position(d) + count, 0.53125);
  std::vector<std::size_t> left;
  const MergeCounts counts = merge<3>(store, grid, 1, left);
  EXPECT_EQ(counts.merged, count - 1);
  ASSERT_EQ(left.size(), 1u);
  EXPECT_EQ(store.position(0)[left[0]], 0.53125);
}

}  // namespace
}  // namespace pileus::parcels
