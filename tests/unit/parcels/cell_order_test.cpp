// Tiles and the order of parcels: every column, tile and parcel once; nothing written twice.
#include "parcels/cell_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

#include "parcel_cloud.hpp"

namespace pileus::parcels {
namespace {

/// Nodes along one direction that a tile of base cells [first, first + count) mod n writes.
std::set<int> written(std::int32_t first, std::int32_t count, int n) {
  std::set<int> nodes;
  for (int b = 0; b < std::min(count, n); ++b)
    for (const int side : {0, 1}) nodes.insert((first + b + side) % n);
  return nodes;
}

template <int D>
void expect_tiling(const mesh::Grid<D>& grid) {
  const Tiling<D> tiling(grid);
  const int ny = D == 3 ? grid.ny() : 1;
  // Ranks are a permutation of the columns, tiles own consecutive ranges of them.
  std::vector<std::uint32_t> ranks = tiling.column_rank();
  std::vector<std::size_t> column_of_rank(ranks.size());
  for (std::size_t c = 0; c < ranks.size(); ++c) column_of_rank[ranks[c]] = c;
  std::sort(ranks.begin(), ranks.end());
  for (std::uint32_t r = 0; r < ranks.size(); ++r) ASSERT_EQ(ranks[r], r);
  std::uint32_t next = 0;
  for (const auto& tile : tiling.tiles()) {
    EXPECT_EQ(tile.first_column_rank, next);
    EXPECT_GT(tile.last_column_rank, tile.first_column_rank);
    next = tile.last_column_rank;
    for (auto r = tile.first_column_rank; r < tile.last_column_rank; ++r) {
      const int i = static_cast<int>(column_of_rank[r]) % grid.nx(),
                j = static_cast<int>(column_of_rank[r]) / grid.nx();
      // A tile may write to its own cells and `reach` around them.
      for (int shift = -Tiling<D>::reach; shift <= Tiling<D>::reach; ++shift) {
        const int di = ((i + shift - tile.first[0]) % grid.nx() + grid.nx()) % grid.nx();
        EXPECT_LT(di, tile.count[0]);
        EXPECT_TRUE(D == 2 || ((j + shift - tile.first[1]) % ny + ny) % ny < tile.count[1]);
      }
    }
  }
  EXPECT_EQ(next, grid.columns());
  // Every tile in one colour once; tiles of one colour write to different nodes.
  std::set<std::uint32_t> seen;
  for (const auto& colour : tiling.colours())
    for (std::size_t a = 0; a < colour.size(); ++a) {
      EXPECT_TRUE(seen.insert(colour[a]).second);
      const auto& one = tiling.tiles()[colour[a]];
      for (std::size_t b = 0; b < a; ++b) {
        const auto& two = tiling.tiles()[colour[b]];
        bool overlap = true;
        for (int d = 0; d < D - 1; ++d) {
          const auto x = written(one.first[d], one.count[d], grid.cells[d]),
                     y = written(two.first[d], two.count[d], grid.cells[d]);
          std::vector<int> common;
          std::set_intersection(x.begin(), x.end(), y.begin(), y.end(), std::back_inserter(common));
          overlap = overlap && !common.empty();
        }
        EXPECT_FALSE(overlap) << grid.nx() << " cells";
      }
    }
  EXPECT_EQ(seen.size(), tiling.tiles().size());
}

TEST(Tiling, CoversEveryColumnAndColoursDoNotOverlap) {
  for (int n = 1; n <= 64; ++n) expect_tiling<2>(mesh::Grid<2>({n, 3}, {0, 0}, {1, 1}));
  for (const int nx : {1, 2, 7, 9, 10, 11, 19, 20, 21, 33, 48})
    for (const int ny : {1, 5, 10, 14, 20, 23})
      expect_tiling<3>(mesh::Grid<3>({nx, ny, 2}, {0, 0, 0}, {1, 1, 1}));
}

template <int D>
void expect_order(const mesh::Grid<D>& grid, std::size_t count) {
  testing::Random random(51);
  Store store(D, {});
  testing::fill_randomly<D>(store, grid, count, 1, 2, random);
  const Tiling<D> tiling(grid);
  CellOrder<D> order(grid, tiling);
  for (int round = 0; round < 2; ++round) {
    std::vector<std::uint32_t> keys;
    order.sort(store, keys);
    ASSERT_EQ(order.order().size(), count);
    std::vector<bool> seen(count);
    std::uint32_t start = 0;
    for (std::size_t key = 0; key < grid.cell_count(); ++key) {
      EXPECT_EQ(order.first(key), start);
      start = order.first(key + 1);
      for (auto s = order.first(key); s < start; ++s) {
        const auto p = order.order()[s];
        EXPECT_FALSE(seen[p]);
        seen[p] = true;
        int cell[3] = {0, 0, 0};
        for (int d = 0; d < D; ++d)
          cell[d == D - 1 ? 2 : d] = static_cast<int>(
              std::floor((store.position(d)[p] - grid.lower[d]) / grid.spacing[d]));
        EXPECT_EQ(order.key(cell[0], cell[1], cell[2]), key);
        // Stable: storage order inside a cell.
        EXPECT_TRUE(s == order.first(key) || p > order.order()[s - 1]);
      }
    }
    EXPECT_EQ(start, count);
  }
}
TEST(CellOrder, EveryParcelOnceInItsCell) {
  expect_order<3>(mesh::Grid<3>({1, 1, 1}, {0, 0, 0}, {1, 1, 1}), 20);
  expect_order<3>(mesh::Grid<3>({7, 5, 9}, {-1, 2, 0.5}, {2, 3, 4}), 5000);
  expect_order<3>(mesh::Grid<3>({20, 10, 3}, {-1, 2, 0.5}, {2, 3, 4}), 5000);
  expect_order<2>(mesh::Grid<2>({21, 9}, {-1, 2}, {2, 3}), 5000);
  expect_order<2>(mesh::Grid<2>({2, 2}, {-1, 2}, {2, 3}), 0);
}

TEST(CellOrder, AnyNumberHasACell) {
  const double inf = std::numeric_limits<double>::infinity();
  EXPECT_EQ(periodic_cell(std::numeric_limits<double>::quiet_NaN(), 0, 1, 8), 0);
  for (const double x : {inf, -inf, 1e300, -1e300, 1e30, -1e30, 1e17, -1e17, 8.0, -0.0, 1e-300,
                         -1e-300, 7.999999999999999}) {
    const int i = periodic_cell(x, 0, 1, 8), k = vertical_cell(x, 0, 1, 8);
    EXPECT_GE(i, 0) << x;
    EXPECT_LT(i, 8) << x;
    EXPECT_GE(k, 0) << x;
    EXPECT_LT(k, 8) << x;
  }
  EXPECT_EQ(periodic_cell(-0.5, 0, 1, 8), 7);
  EXPECT_EQ(periodic_cell(8.5 + 80, 0, 1, 8), 0);
  EXPECT_EQ(vertical_cell(8, 0, 1, 8), 7);
  EXPECT_EQ(vertical_cell(-3, 0, 1, 8), 0);
}

}  // namespace
}  // namespace pileus::parcels
