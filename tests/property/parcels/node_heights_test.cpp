// Buoyancy gathered from parcels that lie anywhere: stratified air has no gradients along levels.
#include <gtest/gtest.h>

#include <cmath>

#include "../../unit/parcels/parcel_cloud.hpp"
#include "base/phase_timer.hpp"
#include "mesh/node_heights.hpp"
#include "parcels/deposit.hpp"
#include "parcels/upkeep.hpp"

namespace pileus::parcels {
namespace {

template <int D>
struct Gathered {
  using Record = mesh::DepositRecord<D>;

  /// `count` random parcels with a buoyancy that is a function of height alone.
  template <class Profile>
  Gathered(const mesh::Grid<D>& on, std::size_t count, unsigned seed, Profile&& profile)
      : grid(on), records(on.nodes() * Record::width) {
    Store store(D, {{"buoyancy", "m s-2", Nature::intensive, "", 0, 0, 0}});
    testing::Random random(seed);
    testing::fill_randomly<D>(store, grid, count, grid.domain_volume() / double(count), 3, random);
    Deposit<D> deposit(grid);
    Upkeep<D> upkeep(grid, deposit.tiling(), 0, SplitCriterion<D>::make(grid, 4, 2.89));
    SupportOffsets<D> offsets;
    PhaseTimes times;
    upkeep.reorder(store, offsets, times);
    const double* z = store.position(D - 1);
    for (std::size_t p = 0; p < count; ++p) store.scalar(0)[p] = profile(z[p]);
    std::vector<const double*> values;
    for (int c = 0; c < store.vorticity_components(); ++c) values.push_back(store.vorticity(c));
    values.push_back(store.scalar(0));
    values.push_back(z);
    empty = deposit.means(store, upkeep.tile_begin(), values, {}, records.data());
  }
  double at(std::size_t column, int k, int lane) const {
    return records[grid.node(column, k) * std::size_t(Record::width) + std::size_t(lane)];
  }
  double buoyancy(std::size_t column, int k) const { return at(column, k, Record::buoyancy); }
  /// The largest difference of the buoyancy along a level.
  double unevenness() const {
    double largest = 0;
    for (int k = 0; k <= grid.nz(); ++k) {
      double low = buoyancy(0, k), high = low;
      for (std::size_t c = 1; c < grid.columns(); ++c) {
        low = std::min(low, buoyancy(c, k));
        high = std::max(high, buoyancy(c, k));
      }
      largest = std::max(largest, high - low);
    }
    return largest;
  }

  mesh::Grid<D> grid;
  AlignedArray<double> records;
  std::size_t empty = 0;
};

constexpr double slope = 0.37, intercept = -2.1;

/// Linear in height: the value at the node's height, at walls that a third of a cell inside, to the
/// rounding of sums of some dozen terms of at most `size`; before, it is off by the scatter.
template <int D>
void expect_linear_is_exact(const mesh::Grid<D>& grid, std::size_t per_cell, unsigned seed) {
  Gathered<D> gathered(grid, per_cell * grid.cell_count(), seed,
                       [](double z) { return intercept + slope * z; });
  ASSERT_EQ(gathered.empty, 0u);
  const double dz = grid.spacing[D - 1];
  EXPECT_GT(gathered.unevenness(), 0.05 * slope * dz);
  std::vector<double> as_gathered;
  for (std::size_t c = 0; c < grid.columns(); ++c)
    for (int k = 0; k <= grid.nz(); ++k) as_gathered.push_back(gathered.buoyancy(c, k));
  mesh::refer_buoyancy_to_nodes(grid, gathered.records.data());
  for (std::size_t c = 0, i = 0; c < grid.columns(); ++c)
    for (int k = 0; k <= grid.nz(); ++k, ++i)
      EXPECT_EQ(gathered.at(c, k, mesh::gathered_buoyancy<D>), as_gathered[i]) << "for outputs";
  const double size = std::abs(intercept) + slope * std::abs(grid.top());
  for (std::size_t c = 0; c < grid.columns(); ++c)
    for (int k = 0; k <= grid.nz(); ++k) {
      double h = grid.bottom() + k * dz;
      if (k == 0) h += dz / 3;
      if (k == grid.nz()) h -= dz / 3;
      EXPECT_NEAR(gathered.buoyancy(c, k), intercept + slope * h, 1e-13 * size) << c << ", " << k;
    }
}

TEST(NodeHeights, TakeTheScatterOutOfALinearProfile) {
  expect_linear_is_exact<3>(mesh::Grid<3>({6, 5, 7}, {-1, 2, 0.5}, {6, 5, 3.5}), 40, 1);
  expect_linear_is_exact<2>(mesh::Grid<2>({9, 6}, {-1, 0.5}, {9, 3}), 40, 2);
  expect_linear_is_exact<3>(mesh::Grid<3>({4, 4, 1}, {0, 0, 0}, {4, 4, 1}), 60, 3);
  expect_linear_is_exact<2>(mesh::Grid<2>({4, 2}, {0, 0}, {4, 2}), 60, 4);
}

/// Twice curved: what remains is of second order, ½ b″ times a variance of heights of at most
/// Δz²/4, here on both sides.
TEST(NodeHeights, LeaveSecondOrderOfACurvedProfile) {
  const mesh::Grid<2> grid({12, 8}, {0, 0}, {12, 8});
  Gathered<2> gathered(grid, 40 * grid.cell_count(), 5, [](double z) { return z * z; });
  const double before = gathered.unevenness();
  mesh::refer_buoyancy_to_nodes(grid, gathered.records.data());
  EXPECT_LT(gathered.unevenness(), 0.25 * before);
  EXPECT_LT(gathered.unevenness(), 2 * 0.25);
}

/// Nodes without parcels stay as they are, and their neighbours take no slope from them.
TEST(NodeHeights, LeaveEmptyNodesOut) {
  const mesh::Grid<2> grid({1, 4}, {0, 0}, {1, 4});
  using Record = mesh::DepositRecord<2>;
  std::vector<double> records(grid.nodes() * Record::width, 0.0);
  const auto put = [&](int k, double z) {
    double* node = &records[grid.node(0, k) * Record::width];
    node[Record::volume] = 1;
    node[Record::buoyancy] = 5 + 2 * z;
    node[mesh::mean_height<2>] = z;
  };
  put(1, 1.2);
  put(2, 1.9);
  put(4, 3.5);  // with nothing on either side that it could compare with
  mesh::refer_buoyancy_to_nodes(grid, records.data());
  const auto buoyancy = [&](int k) { return records[grid.node(0, k) * Record::width + 2]; };
  EXPECT_EQ(buoyancy(0), 0);
  EXPECT_EQ(buoyancy(3), 0);
  EXPECT_DOUBLE_EQ(buoyancy(1), 5 + 2 * 1.0);
  EXPECT_DOUBLE_EQ(buoyancy(2), 5 + 2 * 2.0);
  EXPECT_EQ(buoyancy(4), 5 + 2 * 3.5);
}

}  // namespace
}  // namespace pileus::parcels
