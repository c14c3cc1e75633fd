// How runs begin: counts, volumes, shapes and identities of the lattice of parcels.
#include "parcels/lattice.hpp"

#include <gtest/gtest.h>

#include "parcel_cloud.hpp"

namespace pileus::parcels {
namespace {

// Dossier 10.1: EPIC's int(n^{1/3}) rejects 64, 125 and 216.
TEST(Lattice, RecognisesEveryPower) {
  for (int m = 1; m <= 30; ++m) {
    EXPECT_EQ(parcels_per_direction(m * m, 2), m);
    EXPECT_EQ(parcels_per_direction(m * m * m, 3), m);
    EXPECT_EQ(parcels_per_direction(m * m * m + 1, 3), 0) << m;
  }
  EXPECT_EQ(parcels_per_direction(7, 3), 0);
  EXPECT_EQ(parcels_per_direction(8, 2), 0);
  EXPECT_EQ(parcels_per_direction(0, 3), 0);
  EXPECT_EQ(parcels_per_direction(-8, 3), 0);
}

template <int D>
void expect_lattice(const mesh::Grid<D>& grid, int per_cell, double jitter) {
  Store store(D, {{"humidity", "1", Nature::intensive, "", 0, 1, 0}});
  fill_lattice<D>(store, grid, {.per_cell = per_cell, .jitter = jitter, .seed = 5});
  ASSERT_EQ(store.size(), grid.cell_count() * static_cast<std::size_t>(per_cell));
  long double total = 0;
  std::vector<int> count(grid.cell_count());
  for (std::size_t p = 0; p < store.size(); ++p) {
    total += store.volume()[p];
    EXPECT_EQ(store.uid()[p], p + 1);
    EXPECT_EQ(store.scalar(0)[p], 0);
    std::size_t cell = 0;
    for (int d = 0; d < D; ++d) {
      const double xi = (store.position(d)[p] - grid.lower[d]) / grid.spacing[d];
      EXPECT_GE(store.position(D - 1)[p], grid.bottom());
      EXPECT_LE(store.position(D - 1)[p], grid.top());
      cell = cell * static_cast<std::size_t>(grid.cells[d]) +
             std::min(static_cast<std::size_t>(std::max(xi, 0.0)),
                      static_cast<std::size_t>(grid.cells[d] - 1));
    }
    ++count[cell];
    // The volume per parcel exactly, in the cell's aspect ratio.
    const auto b = testing::get_shape<D>(store, p);
    EXPECT_NEAR(b.determinant() / testing::squared_axes_product<D>(store.volume()[p]), 1, 1e-13);
    for (int d = 1; d < D; ++d)
      EXPECT_NEAR(b(d, d) / b(0, 0), std::pow(grid.spacing[d] / grid.spacing[0], 2),
                  1e-13 * b(d, d) / b(0, 0));
    EXPECT_EQ(b(0, 1), 0);
  }
  EXPECT_NEAR(static_cast<double>(total), grid.domain_volume(), 1e-13 * grid.domain_volume());
  if (jitter == 0) {
    for (const int n : count) EXPECT_EQ(n, per_cell);
  }
}
TEST(Lattice, FillsTheDomain) {
  for (const int per_cell : {1, 8, 27, 64, 125, 216})
    expect_lattice<3>(mesh::Grid<3>({3, 4, 5}, {-1, 2, 0}, {1, 1.5, 0.7}), per_cell, 0);
  for (const int per_cell : {1, 4, 9, 64})
    expect_lattice<2>(mesh::Grid<2>({5, 3}, {-1, 2}, {1, 1.5}), per_cell, 0);
  expect_lattice<3>(mesh::Grid<3>({3, 4, 5}, {-1, 2, 0}, {1, 1.5, 0.7}), 8, 0.9);
  expect_lattice<2>(mesh::Grid<2>({5, 3}, {-1, 2}, {1, 1.5}), 9, 0.9);
}

// Offsets 0 and 1 put parcels on walls, faces and corners; what would lie on the upper side of the
// periodic seam lies on the lower.
TEST(Lattice, OffsetsReachWallsAndSeam) {
  const mesh::Grid<3> grid({2, 3, 4}, {-1, 2, 0}, {1, 1.5, 0.7});
  for (const double offset : {0.0, 1.0}) {
    Store store(3, {});
    fill_lattice<3>(store, grid, {.per_cell = 8, .offset = offset});
    std::size_t on_wall = 0, on_seam = 0;
    for (std::size_t p = 0; p < store.size(); ++p) {
      on_wall += store.position(2)[p] == (offset == 0 ? grid.bottom() : grid.top()) ? 1 : 0;
      on_seam += store.position(0)[p] == grid.lower[0] ? 1 : 0;
      EXPECT_LT(store.position(0)[p], grid.lower[0] + grid.extent[0]);
      EXPECT_LE(store.position(2)[p], grid.top());
    }
    EXPECT_EQ(on_wall, 4u * 6u) << offset;
    EXPECT_EQ(on_seam, 6u * 8u) << offset;
  }
}

// The parcels that stay have the whole domain's volume, and shapes that enclose theirs.
TEST(Lattice, KeptParcelsHaveTheWholeVolume) {
  const mesh::Grid<3> grid({3, 4, 5}, {-1, 2, 0}, {1, 1.5, 0.7});
  Store store(3, {{"humidity", "1", Nature::intensive, "", 0, 1, 0}});
  fill_lattice<3>(store, grid, {.per_cell = 8});
  std::vector<double> indicator(store.size(), -1);
  const std::vector<std::size_t> kept = {3, 17, 18, 400};
  for (const std::size_t p : kept) indicator[p] = 1e-30;
  ASSERT_EQ(keep_positive(store, indicator), kept.size());
  ASSERT_EQ(store.size(), kept.size());
  for (std::size_t p = 0; p < kept.size(); ++p) {
    EXPECT_EQ(store.uid()[p], kept[p] + 1);
    EXPECT_NEAR(store.volume()[p], grid.domain_volume() / 4, 1e-14);
    EXPECT_NEAR(testing::get_shape<3>(store, p).determinant() /
                    testing::squared_axes_product<3>(store.volume()[p]),
                1, 1e-13);
  }
}

// Jitter is bounded by its fraction of the lattice spacing, fills that range, averages to nothing,
// and is a function of seed and identity alone.
TEST(Lattice, Jitter) {
  const mesh::Grid<3> grid({16, 16, 16}, {0, 0, 0}, {1, 1, 1});
  Store regular(3, {}), moved(3, {}), again(3, {}), other(3, {});
  fill_lattice<3>(regular, grid, {.per_cell = 8});
  fill_lattice<3>(moved, grid, {.per_cell = 8, .jitter = 0.5, .seed = 5});
  fill_lattice<3>(again, grid, {.per_cell = 8, .jitter = 0.5, .seed = 5});
  fill_lattice<3>(other, grid, {.per_cell = 8, .jitter = 0.5, .seed = 6});
  const double bound = 0.5 / 32;
  for (int d = 0; d < 3; ++d) {
    double largest = 0, sum = 0, same = 0;
    for (std::size_t p = 0; p < moved.size(); ++p) {
      const double shift = moved.position(d)[p] - regular.position(d)[p];
      largest = std::max(largest, std::abs(shift));
      sum += shift;
      EXPECT_EQ(moved.position(d)[p], again.position(d)[p]);
      same += moved.position(d)[p] == other.position(d)[p];
    }
    EXPECT_LE(largest, bound * (1 + 1e-12));
    EXPECT_GT(largest, 0.99 * bound);
    // A mean of 32768 uniform draws has standard deviation bound/√(3·32768); five of them.
    EXPECT_LT(std::abs(sum / 32768), 5 * bound / std::sqrt(3.0 * 32768));
    EXPECT_LT(same, 3);
  }
}

}  // namespace
}  // namespace pileus::parcels
