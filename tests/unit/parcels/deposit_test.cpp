// Parcel to grid: the expected numbers of the method (dossier 3.5) and the meaning of the record.
#include "parcels/deposit.hpp"

#include <gtest/gtest.h>

#include "parcel_cloud.hpp"
#include "parcels/lattice.hpp"
#include "parcels/upkeep.hpp"

namespace pileus::parcels {
namespace {

using testing::mesh_sum;

/// Parcels put in order, their offsets, and the deposit that belongs to them.
template <int D>
struct Gridded {
  Gridded(const mesh::Grid<D>& mesh_grid, Store& parcel_store)
      : grid(mesh_grid), store(parcel_store), deposit(grid) {
    Upkeep<D> upkeep(grid, deposit.tiling(), 0, SplitCriterion<D>::make(grid, 4, 2.89));
    PhaseTimes times;
    upkeep.reorder(store, offsets, times);
    tile_begin = upkeep.tile_begin();
    offsets.update(store);
    record.discard_and_resize(grid.nodes() * mesh::DepositRecord<D>::width);
    volume.discard_and_resize(grid.nodes());
  }
  std::size_t means(const std::vector<const double*>& values) {
    deposit.volume(store, offsets, tile_begin, volume.data());
    return deposit.means(store, offsets, tile_begin, values, record.data());
  }
  double at(int i, int j, int k, int f) const {
    return record[grid.node(grid.column(i, j), k) * mesh::DepositRecord<D>::width +
                  static_cast<std::size_t>(f)];
  }

  mesh::Grid<D> grid;
  Store& store;
  Deposit<D> deposit;
  SupportOffsets<D> offsets;
  std::vector<std::size_t> tile_begin;
  AlignedArray<double> record, volume;
};

template <int D>
double volume_sum(const Gridded<D>& gridded) {
  long double sum = 0;
  for (std::size_t c = 0; c < gridded.grid.columns(); ++c)
    for (int k = 0; k <= gridded.grid.nz(); ++k) sum += gridded.volume[gridded.grid.node(c, k)];
  return static_cast<double>(sum);
}

// Dossier 3.5: 2×2 circles per cell, 32², box 0.4²: |Σ_g V_g − nx(nz+1) V_cell| < 1e-14; every node
// holds V_cell, walls included (3.3).
TEST(Deposit, RegularCirclesFillEveryNode) {
  const mesh::Grid<2> grid({32, 32}, {-0.2, -0.2}, {0.4, 0.4});
  Store store(2, {});
  fill_lattice<2>(store, grid, {.per_cell = 4});
  Gridded<2> gridded(grid, store);
  EXPECT_EQ(gridded.means({}), 0u);
  EXPECT_NEAR(volume_sum(gridded), 32 * 33 * grid.cell_volume(), 1e-14);
  for (int i = 0; i < 32; ++i)
    for (int k = 0; k <= 32; ++k) EXPECT_NEAR(gridded.at(i, 0, k, 0), grid.cell_volume(), 1e-17);
}

// Dossier 3.5: 3D, 27 per cell, 32³, ω_x = 1.5 everywhere.
TEST(Deposit, RegularSpheresFillEveryNode) {
  const mesh::Grid<3> grid({32, 32, 32}, {0, 0, 0}, {1, 1, 1});
  Store store(3, {});
  fill_lattice<3>(store, grid, {.per_cell = 27});
  std::fill(store.vorticity(0), store.vorticity(0) + store.size(), 1.5);
  Gridded<3> gridded(grid, store);
  EXPECT_EQ(gridded.means({store.vorticity(0)}), 0u);
  EXPECT_NEAR(volume_sum(gridded), 32 * 32 * 33 * grid.cell_volume(), 3e-14 * 33 / 32);
  for (int k = 0; k <= 32; ++k)
    for (int i = 0; i < 32; ++i) EXPECT_NEAR(gridded.at(i, 7, k, 1), 1.5, 1e-14);
}

// Dossier 3.5, 2D overhang: 4×4 cells, 4 parcels per cell, ellipses λ = 3.5 upright, so that one
// support point is outside the wall.
TEST(Deposit, OverhangingEllipsesAreFoldedBack) {
  const mesh::Grid<2> grid({4, 4}, {0, 0}, {1, 1});
  Store store(2, {});
  fill_lattice<2>(store, grid, {.per_cell = 4});
  const double ab = store.volume()[0] / std::numbers::pi;
  const Eigen::Matrix2d upright = Eigen::Vector2d(ab / 3.5, ab * 3.5).asDiagonal();
  for (std::size_t p = 0; p < store.size(); ++p) testing::put_shape<2>(store, p, upright);
  EXPECT_GT(0.5 * std::sqrt(3.5 * ab - ab / 3.5), 0.5 * store.position(1)[0]);
  Gridded<2> gridded(grid, store);
  gridded.means({});
  EXPECT_NEAR(volume_sum(gridded), 4 * 5 * grid.cell_volume(), 4e-15);
}

// Dossier 3.5, 3D overhang: 2³ cells, 8 per cell, elongated.
TEST(Deposit, OverhangingEllipsoidsAreFoldedBack) {
  const mesh::Grid<3> grid({2, 2, 2}, {0, 0, 0}, {1, 1, 1});
  Store store(3, {});
  fill_lattice<3>(store, grid, {.per_cell = 8});
  const double r2 = std::cbrt(testing::squared_axes_product<3>(store.volume()[0]));
  const Eigen::Matrix3d upright =
      r2 * Eigen::Vector3d(1 / std::sqrt(10.0), 1 / std::sqrt(10.0), 10).asDiagonal();
  for (std::size_t p = 0; p < store.size(); ++p) testing::put_shape<3>(store, p, upright);
  Gridded<3> gridded(grid, store);
  gridded.means({});
  EXPECT_NEAR(volume_sum(gridded), 2 * 2 * 3 * grid.cell_volume(), 8e-15);
}

// The volume-only deposit and the record agree to the rounding of another order of products.
TEST(Deposit, VolumeAloneEqualsTheRecord) {
  testing::Random random(61);
  const mesh::Grid<3> grid({12, 11, 6}, {0, 0, 0}, {3, 2, 1});
  Store store(3, {});
  testing::fill_randomly<3>(store, grid, 4000, grid.domain_volume() / 4000, 4, random);
  Gridded<3> gridded(grid, store);
  gridded.means({store.vorticity(0)});
  for (std::size_t c = 0; c < grid.columns(); ++c)
    for (int k = 0; k <= grid.nz(); ++k) {
      const std::size_t node = grid.node(c, k);
      EXPECT_NEAR(gridded.record[node * 8], gridded.volume[node],
                  1e-14 * std::abs(gridded.volume[node]));
    }
}

TEST(Deposit, EmptyNodesAreCountedAndZero) {
  const mesh::Grid<2> grid({8, 8}, {0, 0}, {8, 8});
  Store store(2, {});
  store.resize(1);
  store.position(0)[0] = 3.5;
  store.position(1)[0] = 3.5;
  store.volume()[0] = 0.5;
  store.vorticity(0)[0] = 2;
  testing::put_shape<2>(store, 0, Eigen::Matrix2d::Identity());
  Gridded<2> gridded(grid, store);
  EXPECT_EQ(gridded.means({store.vorticity(0)}), 8u * 9u - 4u);
  EXPECT_EQ(gridded.at(3, 0, 4, 0), 0.125);
  EXPECT_EQ(gridded.at(3, 0, 4, 1), 2);
  EXPECT_EQ(gridded.at(0, 0, 0, 1), 0);
  Store nobody(2, {});
  Gridded<2> empty(grid, nobody);
  EXPECT_EQ(empty.means({}), 8u * 9u);
}

// Dossier 10.2 and acceptance 14: nodes → parcels by linear interpolation at the centre → nodes is
// the separable smoothing (3, 10, 3)/16 for two parcels per direction.
TEST(Deposit, InterpolationKernelOfADelta) {
  const mesh::Grid<3> grid({8, 8, 8}, {0, 0, 0}, {8, 8, 8});
  Store store(3, {});
  fill_lattice<3>(store, grid, {.per_cell = 8});
  for (std::size_t p = 0; p < store.size(); ++p) {
    double value = 1;
    for (int d = 0; d < 3; ++d) value *= std::max(0.0, 1 - std::abs(store.position(d)[p] - 4));
    store.vorticity(1)[p] = value;
  }
  Gridded<3> gridded(grid, store);
  gridded.means({store.vorticity(1)});
  const double kernel[3] = {3.0 / 16, 10.0 / 16, 3.0 / 16};
  for (int i = 3; i <= 5; ++i)
    for (int j = 3; j <= 5; ++j)
      for (int k = 3; k <= 5; ++k)
        EXPECT_NEAR(gridded.at(i, j, k, 1), kernel[i - 3] * kernel[j - 3] * kernel[k - 3], 1e-15);
  EXPECT_EQ(gridded.at(2, 4, 4, 1), 0);
}

}  // namespace
}  // namespace pileus::parcels
