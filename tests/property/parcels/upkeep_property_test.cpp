// A step's upkeep as a whole: counts, conservation, order and identities after many rounds.
#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <map>
#include <set>

#include "../../unit/parcels/parcel_cloud.hpp"
#include "parcels/upkeep.hpp"
#include "parcels/walls.hpp"

namespace pileus::parcels {
namespace {

const std::vector<Scalar> scalars = {{"specific", "1", Nature::intensive, "", 0, 0, 0},
                                     {"amount", "kg", Nature::extensive, "", 0, 0, 0},
                                     {"diagnosed", "1", Nature::derived, "", 0, 0, 0}};

template <int D>
struct World {
  World(const mesh::Grid<D>& mesh_grid, std::size_t count, unsigned seed)
      : grid(mesh_grid),
        tiling(grid),
        store(D, scalars),
        upkeep(grid, tiling, grid.cell_volume() / 20, SplitCriterion<D>::make(grid, 4, 2.89)),
        random(seed) {
    testing::fill_randomly<D>(store, grid, count, grid.domain_volume() / static_cast<double>(count),
                              3, random);
  }
  std::vector<long double> totals() const {
    std::vector<long double> sums(4, 0.0L);
    for (std::size_t p = 0; p < store.size(); ++p) {
      const long double v = store.volume()[p];
      sums[0] += v;
      sums[1] += v * store.vorticity(0)[p];
      sums[2] += v * store.scalar(0)[p];
      sums[3] += store.scalar(1)[p];
    }
    return sums;
  }
  /// Stretches and shifts everything a little, as a step does.
  void stir() {
    for (std::size_t p = 0; p < store.size(); ++p) {
      const double s = std::exp(testing::uniform(random, 0, 0.4));
      if constexpr (D == 3) {
        const double f[6] = {s * s, 1, s, 1 / (s * s), 1 / s, 1};
        for (int c = 0; c < 6; ++c) store.shape(c)[p] *= f[c];
      } else {
        store.shape(0)[p] *= s * s;
        store.shape(2)[p] /= s * s;
      }
      for (int d = 0; d < D; ++d)
        store.position(d)[p] += grid.spacing[d] * testing::uniform(random, -0.3, 0.3);
    }
    confine<D>(store, grid);
  }

  mesh::Grid<D> grid;
  Tiling<D> tiling;
  Store store;
  Upkeep<D> upkeep;
  SupportOffsets<D> offsets;
  PhaseTimes times;
  testing::Random random;
};

/// Parcels of a tile are in its columns, children of splits (at most half a cell away) excepted.
template <int D>
void expect_order(const World<D>& world, std::uint64_t splits) {
  const auto& begin = world.upkeep.tile_begin();
  ASSERT_EQ(begin.size(), world.tiling.tiles().size() + 1);
  EXPECT_EQ(begin.front(), 0u);
  EXPECT_EQ(begin.back(), world.store.size());
  std::size_t displaced = 0;
  for (std::size_t t = 0; t < world.tiling.tiles().size(); ++t) {
    EXPECT_LE(begin[t], begin[t + 1]);
    const auto& tile = world.tiling.tiles()[t];
    for (std::size_t p = begin[t]; p < begin[t + 1]; ++p) {
      int cell[2] = {0, 0};
      for (int d = 0; d < D - 1; ++d)
        cell[d] = periodic_cell(world.store.position(d)[p], world.grid.lower[d],
                                world.grid.inverse_spacing[d], world.grid.cells[d]);
      const auto rank = world.tiling.column_rank()[world.grid.column(cell[0], cell[1])];
      displaced += rank < tile.first_column_rank || rank >= tile.last_column_rank;
    }
  }
  // Also receivers of a merge move to the centroid of their cluster after the sort.
  EXPECT_LE(displaced, 2 * splits + world.store.size() / 20);
}

template <int D>
std::vector<double> live_through(const mesh::Grid<D>& grid, std::size_t count, int steps) {
  World<D> world(grid, count, 121);
  const auto before = world.totals();
  const double low = *std::min_element(world.store.scalar(0), world.store.scalar(0) + count),
               high = *std::max_element(world.store.scalar(0), world.store.scalar(0) + count);
  std::uint64_t merges = 0, splits = 0;
  std::set<std::uint64_t> ever(world.store.uid(), world.store.uid() + count);
  for (int step = 0; step < steps; ++step) {
    const std::size_t size = world.store.size();
    std::set<std::uint64_t> old(world.store.uid(), world.store.uid() + size);
    const UpkeepCounts counts =
        world.upkeep.run(world.store, world.offsets, static_cast<std::uint64_t>(step), world.times);
    EXPECT_EQ(world.store.size(), size - counts.merges.merged + counts.splits);
    merges += counts.merges.merged;
    splits += counts.splits;
    std::set<std::uint64_t> now(world.store.uid(), world.store.uid() + world.store.size());
    EXPECT_EQ(now.size(), world.store.size()) << "identities are unique";
    std::size_t born = 0;
    for (const std::uint64_t uid : now)
      if (!old.contains(uid)) {
        ++born;
        EXPECT_TRUE(ever.insert(uid).second) << "an identity came back";
      }
    EXPECT_EQ(born, counts.splits);
    expect_order(world, counts.splits);
    for (std::size_t p = 0; p < world.store.size(); ++p) {
      EXPECT_NEAR(testing::get_shape<D>(world.store, p).determinant() /
                      testing::squared_axes_product<D>(world.store.volume()[p]),
                  1, 1e-9);
      EXPECT_GE(world.store.scalar(0)[p], low);
      EXPECT_LE(world.store.scalar(0)[p], high);
    }
    world.stir();
  }
  EXPECT_GT(merges, count / 10);
  EXPECT_GT(splits, count / 10);
  // Each of the many thousand merges rounds volume and integral once.
  const auto after = world.totals();
  for (std::size_t s = 0; s < before.size(); ++s)
    EXPECT_NEAR(static_cast<double>(after[s]), static_cast<double>(before[s]),
                1e-13 * (s == 3 ? static_cast<double>(count) : grid.domain_volume()))
        << s;
  std::vector<double> state;
  for (int c = 0; c < world.store.state_columns(); ++c)
    state.insert(state.end(), world.store.column(c), world.store.column(c) + world.store.size());
  return state;
}

TEST(UpkeepProperty, LongLifeInSpace) {
  live_through<3>(mesh::Grid<3>({20, 10, 6}, {0, -1, 2}, {2, 1, 0.6}), 9600, 15);
}
TEST(UpkeepProperty, LongLifeInThePlane) {
  live_through<2>(mesh::Grid<2>({40, 20}, {0, -1}, {4, 2}), 7200, 15);
}
TEST(UpkeepProperty, TinyMeshes) {
  live_through<3>(mesh::Grid<3>({1, 1, 1}, {0, 0, 0}, {1, 1, 1}), 30, 6);
  live_through<3>(mesh::Grid<3>({2, 2, 2}, {0, 0, 0}, {1, 1, 1}), 100, 6);
}

TEST(UpkeepProperty, SameBitsForAnyNumberOfThreads) {
  const int before = omp_get_max_threads();
  std::vector<double> first;
  for (const int threads : {1, 2, 3}) {
    omp_set_num_threads(threads);
    const auto state =
        live_through<3>(mesh::Grid<3>({20, 10, 6}, {0, -1, 2}, {2, 1, 0.6}), 9600, 5);
    if (first.empty()) first = state;
    EXPECT_EQ(state, first) << threads;
  }
  omp_set_num_threads(before);
}

// reorder() changes nothing but the order, and is idempotent.
TEST(UpkeepProperty, ReorderingKeepsEveryParcel) {
  World<3> world(mesh::Grid<3>({20, 10, 6}, {0, -1, 2}, {2, 1, 0.6}), 5000, 122);
  std::map<std::uint64_t, std::vector<double>> before, after;
  const auto record = [&](auto& map) {
    for (std::size_t p = 0; p < world.store.size(); ++p)
      for (int c = 0; c < world.store.state_columns(); ++c)
        map[world.store.uid()[p]].push_back(world.store.column(c)[p]);
  };
  record(before);
  world.upkeep.reorder(world.store, world.offsets, world.times);
  record(after);
  EXPECT_EQ(before, after);
  expect_order(world, 0);
  const std::vector<std::uint64_t> uids(world.store.uid(), world.store.uid() + 5000);
  world.upkeep.reorder(world.store, world.offsets, world.times);
  EXPECT_TRUE(std::equal(uids.begin(), uids.end(), world.store.uid()));
}

TEST(UpkeepProperty, AnEmptyStoreIsFine) {
  World<3> world(mesh::Grid<3>({4, 4, 4}, {0, 0, 0}, {1, 1, 1}), 0, 123);
  const UpkeepCounts counts = world.upkeep.run(world.store, world.offsets, 0, world.times);
  EXPECT_EQ(counts.splits + counts.merges.merged, 0u);
  EXPECT_EQ(world.upkeep.tile_begin().back(), 0u);
}

}  // namespace
}  // namespace pileus::parcels
