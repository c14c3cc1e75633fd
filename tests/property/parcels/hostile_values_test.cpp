// A store full of NaN and infinities may give nonsense, never a crash or an index outside the mesh
// (the sanitizer builds run this too). The guards of the run report such parcels.
#include <gtest/gtest.h>

#include <limits>

#include "../../unit/parcels/parcel_cloud.hpp"
#include "parcels/deposit.hpp"
#include "parcels/upkeep.hpp"
#include "parcels/walls.hpp"

namespace pileus::parcels {
namespace {

template <int D>
void survive(const mesh::Grid<D>& grid, unsigned seed) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  constexpr double hostile[] = {std::numeric_limits<double>::quiet_NaN(),
                                inf,
                                -inf,
                                0.0,
                                -1.0,
                                1e300,
                                -1e300,
                                1e30,
                                -1e17,
                                1e-310};
  testing::Random random(seed);
  Store store(D, {{"amount", "kg", Nature::extensive, "", 0, 0, 0}});
  testing::fill_randomly<D>(store, grid, 800, grid.domain_volume() / 800, 3, random);
  for (std::size_t p = 0; p < store.size(); p += 3)
    store.column(static_cast<int>(random() % static_cast<unsigned>(store.state_columns())))[p] =
        hostile[random() % std::size(hostile)];
  Deposit<D> deposit(grid);
  Upkeep<D> upkeep(grid, deposit.tiling(), grid.domain_volume() / 1000,
                   SplitCriterion<D>::make(grid, 4, 2.89));
  SupportOffsets<D> offsets;
  PhaseTimes times;
  AlignedArray<double> record(grid.nodes() * mesh::DepositRecord<D>::width), volume(grid.nodes());
  for (std::uint64_t step = 0; step < 4; ++step) {
    const std::size_t before = store.size();
    const UpkeepCounts counts = upkeep.run(store, offsets, step, times);
    EXPECT_EQ(store.size(), before - counts.merges.merged + counts.splits);
    EXPECT_EQ(upkeep.tile_begin().back(), store.size());
    offsets.update(store);
    deposit.means(store, offsets, upkeep.tile_begin(), {store.vorticity(0)}, record.data());
    deposit.volume(store, offsets, upkeep.tile_begin(), volume.data());
    confine<D>(store, grid);
  }
}

TEST(HostileValues, NeverLeaveTheMesh) {
  for (unsigned seed = 0; seed < 15; ++seed) {
    survive<3>(mesh::Grid<3>({20, 10, 4}, {0, 0, 0}, {2, 1, 1}), seed);
    survive<3>(mesh::Grid<3>({1, 2, 1}, {0, 0, 0}, {2, 1, 1}), seed);
    survive<2>(mesh::Grid<2>({20, 8}, {0, 0}, {2, 1}), seed);
  }
}

// A broken parcel must show in what it is deposited into, not vanish.
TEST(HostileValues, NotANumberIsSeenInTheDeposit) {
  const mesh::Grid<3> grid({4, 4, 4}, {0, 0, 0}, {1, 1, 1});
  for (int column = 0; column < 3; ++column) {
    testing::Random random(91);
    Store store(3, {});
    testing::fill_randomly<3>(store, grid, 500, 1.0 / 500, 2, random);
    store.column(column)[123] = std::numeric_limits<double>::quiet_NaN();
    Deposit<3> deposit(grid);
    SupportOffsets<3> offsets;
    offsets.update(store);
    AlignedArray<double> volume(grid.nodes());
    deposit.volume(store, offsets, {0, store.size()}, volume.data());
    double sum = 0;
    for (std::size_t c = 0; c < grid.columns(); ++c)
      for (int k = 0; k <= grid.nz(); ++k) sum += volume[grid.node(c, k)];
    EXPECT_TRUE(std::isnan(sum)) << store.column_name(column);
  }
}

}  // namespace
}  // namespace pileus::parcels
