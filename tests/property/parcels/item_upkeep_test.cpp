// What splits and mergers of parcels do to the items they own, over a long life of both.
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>

#include "../../unit/parcels/parcel_cloud.hpp"
#include "parcels/upkeep.hpp"
#include "parcels/walls.hpp"

namespace pileus::parcels {
namespace {

using Kind = ItemColumn::Kind;
constexpr std::int64_t most = 12;

ItemDeclaration declaration() {
  return {"number",
          {{"mass", "kg", Kind::of_each, "", 0, 1e9}, {"place", "1", Kind::height, "", -9, 9}}};
}

template <int D>
struct World {
  explicit World(const mesh::Grid<D>& mesh_grid, std::size_t count)
      : grid(mesh_grid),
        tiling(grid),
        store(D, {}, declaration()),
        upkeep(grid, tiling, grid.cell_volume() / 20, SplitCriterion<D>::make(grid, 4, 2.89)) {
    testing::fill_randomly<D>(store, grid, count, grid.domain_volume() / static_cast<double>(count),
                              3, random);
    ItemLists& items = store.items();
    items.set_most_per_parcel(most);
    items.start(count);
    std::vector<std::int32_t> lengths(count);
    std::size_t total = 0;
    for (auto& n : lengths) total += static_cast<std::size_t>(n = static_cast<int>(random() % 8));
    items.regroup(lengths, std::vector<std::int64_t>(total, -1));
    for (std::size_t i = 0; i < total; ++i) {
      items.multiplicity()[i] = 1 + static_cast<std::int64_t>(random() % (i % 3 == 0 ? 3 : 100000));
      items.column(0)[i] = std::pow(10.0, testing::uniform(random, -18, -6));
      items.column(1)[i] = testing::uniform(random, -1, 1);
    }
  }
  std::int64_t number() const {
    std::int64_t sum = 0;
    for (std::size_t i = 0; i < store.items().size(); ++i) sum += store.items().multiplicity()[i];
    return sum;
  }
  /// Total mass, and mass times height.
  std::array<long double, 2> moments() const {
    std::array<long double, 2> sums{};
    const ItemLists& items = store.items();
    for (std::size_t p = 0; p < store.size(); ++p)
      for (std::int64_t i = items.begin()[p]; i < items.begin()[p] + items.count()[p]; ++i) {
        const long double mass =
            static_cast<long double>(items.multiplicity()[i]) * items.column(0)[i];
        const double half_extent = std::sqrt(store.shape(store.shape_components() - 1)[p]);
        sums[0] += mass;
        sums[1] += mass * (store.position(D - 1)[p] + items.column(1)[i] * half_extent);
      }
    return sums;
  }
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
    }
  }

  mesh::Grid<D> grid;
  Tiling<D> tiling;
  Store store;
  Upkeep<D> upkeep;
  SupportOffsets<D> offsets;
  PhaseTimes times;
  testing::Random random{7};
};

template <int D>
std::vector<double> live_through(const mesh::Grid<D>& grid, std::size_t count, int steps) {
  World<D> world(grid, count);
  const std::int64_t number = world.number();
  const auto before = world.moments();
  std::uint64_t united = 0;
  for (int step = 0; step < steps; ++step) {
    united +=
        world.upkeep.run(world.store, world.offsets, static_cast<std::uint64_t>(step), world.times)
            .items_united;
    const ItemLists& items = world.store.items();
    EXPECT_EQ(items.parcels(), world.store.size());
    EXPECT_EQ(world.number(), number) << "whole numbers are exact";
    for (std::size_t p = 0; p < items.parcels(); ++p) EXPECT_LE(items.count()[p], most);
    for (std::size_t i = 0; i < items.size(); ++i) EXPECT_GT(items.multiplicity()[i], 0);
    world.stir();
  }
  EXPECT_GT(united, 0u) << "nothing was shortened";
  const auto after = world.moments();
  // Each union rounds a mean once.
  EXPECT_NEAR(static_cast<double>(after[0] / before[0]), 1.0, 1e-14 * std::sqrt(double(united)));
  const ItemLists& items = world.store.items();
  std::vector<double> state(items.column(0), items.column(0) + items.size());
  for (std::size_t i = 0; i < items.size(); ++i)
    state.push_back(static_cast<double>(items.multiplicity()[i]));
  state.insert(state.end(), items.column(1), items.column(1) + items.size());
  return state;
}

TEST(ItemUpkeep, sums_are_kept_in_space_and_in_the_plane) {
  live_through<3>(mesh::Grid<3>({20, 10, 6}, {0, -1, 2}, {2, 1, 0.6}), 9600, 12);
  live_through<2>(mesh::Grid<2>({40, 20}, {0, -1}, {4, 2}), 7200, 12);
}

TEST(ItemUpkeep, same_bits_for_any_number_of_threads) {
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

/// Mergers leave every item at its height; what the receiver's new place changes is how that is
/// said.
TEST(ItemUpkeep, items_stay_at_their_height_when_parcels_merge) {
  const mesh::Grid<2> grid({4, 4}, {0, 0}, {4, 4});
  World<2> world(grid, 2);
  Store& store = world.store;
  store.items().set_most_per_parcel(0);
  store.items().start(2);
  store.items().regroup(std::vector<std::int32_t>{1, 2}, std::vector<std::int64_t>(3, -1));
  for (int i = 0; i < 3; ++i) {
    store.items().multiplicity()[i] = 1 + i;
    store.items().column(0)[i] = 1.0 + i;
    store.items().column(1)[i] = 0.5 - 0.4 * i;
  }
  const double heights[2] = {2.0, 2.2}, volumes[2] = {0.3, 0.01};
  for (std::size_t p = 0; p < 2; ++p) {
    store.position(0)[p] = 2.0;
    store.position(1)[p] = heights[p];
    store.volume()[p] = volumes[p];
    const double b = volumes[p] / std::numbers::pi;  // a circle
    store.shape(0)[p] = store.shape(2)[p] = b;
    store.shape(1)[p] = 0;
    store.uid()[p] = p + 1;
  }
  std::vector<double> before;
  for (int i = 0; i < 3; ++i)
    before.push_back(heights[i > 0] +
                     store.items().column(1)[i] * std::sqrt(volumes[i > 0] / std::numbers::pi));
  const UpkeepCounts counts = world.upkeep.run(store, world.offsets, 0, world.times);
  ASSERT_EQ(counts.merges.merged, 1u);
  ASSERT_EQ(store.size(), 1u);
  ASSERT_EQ(store.items().size(), 3u);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(store.items().multiplicity()[i], 1 + i);
    EXPECT_NEAR(store.position(1)[0] + store.items().column(1)[i] * std::sqrt(store.shape(2)[0]),
                before[static_cast<std::size_t>(i)], 1e-14);
  }
}

}  // namespace
}  // namespace pileus::parcels
