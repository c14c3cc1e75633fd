// Parcel to grid on random clouds: against a plain double loop, conserving, monotone, and the same
// bits for any number of threads.
#include <gtest/gtest.h>
#include <omp.h>

#include <cstring>

#include "../../unit/parcels/parcel_cloud.hpp"
#include "parcels/deposit.hpp"
#include "parcels/upkeep.hpp"
#include "parcels/walls.hpp"

namespace pileus::parcels {
namespace {

using testing::mesh_sum;
using testing::uniform;

template <int D>
constexpr int record_width = mesh::DepositRecord<D>::width;

template <int D>
struct Cloud {
  Cloud(const mesh::Grid<D>& mesh_grid, std::size_t count, double spread, unsigned seed)
      : grid(mesh_grid),
        store(D, {{"buoyancy", "m s-2", Nature::intensive, "", 0, 0, 0}}),
        deposit(grid),
        random(seed) {
    testing::fill_randomly<D>(store, grid, count, grid.domain_volume() / static_cast<double>(count),
                              spread, random);
    Upkeep<D> upkeep(grid, deposit.tiling(), 0, SplitCriterion<D>::make(grid, 4, 2.89));
    PhaseTimes times;
    upkeep.reorder(store, offsets, times);
    tile_begin = upkeep.tile_begin();
  }
  std::vector<const double*> values() const {
    std::vector<const double*> list;
    for (int c = 0; c < store.vorticity_components(); ++c) list.push_back(store.vorticity(c));
    list.push_back(store.scalar(0));
    return list;
  }
  void run() {
    record.discard_and_resize(grid.nodes() * record_width<D>);
    offsets.update(store);
    empty = deposit.means(store, offsets, tile_begin, values(), record.data());
  }
  double total(int f) const {
    long double sum = 0;
    const auto list = values();
    for (std::size_t p = 0; p < store.size(); ++p)
      sum += static_cast<long double>(store.volume()[p]) *
             (f < 0 ? 1.0 : list[static_cast<std::size_t>(f)][p]);
    return static_cast<double>(sum);
  }

  mesh::Grid<D> grid;
  Store store;
  Deposit<D> deposit;
  SupportOffsets<D> offsets;
  std::vector<std::size_t> tile_begin;
  AlignedArray<double> record;
  std::size_t empty = 0;
  testing::Random random;
};

/// Against the double loop over nodes whose neighbourhood is not nearly void. A node's mean carries
/// the rounding of all its contributions over its volume.
template <int D>
void expect_plain_deposit(const Cloud<D>& cloud) {
  const auto reference = testing::plain_deposit<D>(cloud.grid, cloud.store, cloud.values());
  // Weights err by the rounding of positions in cells, times the volume they share out.
  const double typical =
      std::max(cloud.grid.cell_volume(), cloud.total(-1) / static_cast<double>(cloud.store.size()));
  for (std::size_t c = 0; c < cloud.grid.columns(); ++c)
    for (int k = 0; k <= cloud.grid.nz(); ++k) {
      const std::size_t node = cloud.grid.node(c, k) * record_width<D>;
      EXPECT_NEAR(cloud.record[node], reference[node], 2e-13 * typical);
      if (reference[node] < 1e-2 * typical) continue;
      for (std::size_t f = 1; f <= cloud.values().size(); ++f)
        EXPECT_NEAR(cloud.record[node + f], reference[node + f], 4e-11);
    }
}
/// Dossier 3.3, acceptance 4: Σ c V_g = Σ V_p and Σ c V_g φ_g = Σ V_p φ_p to 1e-13 relative.
template <int D>
void expect_conserved(const Cloud<D>& cloud) {
  const double volume = cloud.total(-1);
  EXPECT_NEAR(mesh_sum<D>(cloud.grid, cloud.record.data(), record_width<D>, -1), volume,
              1e-13 * volume);
  for (int f = 0; f < static_cast<int>(cloud.values().size()); ++f)
    EXPECT_NEAR(mesh_sum<D>(cloud.grid, cloud.record.data(), record_width<D>, f + 1),
                cloud.total(f), 1e-13 * volume);
}

template <int D>
void expect_cloud(const mesh::Grid<D>& grid, std::size_t count, double spread) {
  Cloud<D> cloud(grid, count, spread, 71);
  cloud.run();
  expect_conserved(cloud);
  expect_plain_deposit(cloud);
}

TEST(DepositProperty, ElongatedParcelsInSpace) {
  for (const double spread : {1.0, 3.0, 30.0})
    expect_cloud<3>(mesh::Grid<3>({20, 10, 8}, {-1, 2, 0.5}, {2, 1, 0.9}), 6000, spread);
}
TEST(DepositProperty, ElongatedParcelsInThePlane) {
  for (const double spread : {1.0, 3.0, 30.0})
    expect_cloud<2>(mesh::Grid<2>({23, 9}, {-1, 2}, {2, 1}), 4000, spread);
}
TEST(DepositProperty, TinyGrids) {
  for (const std::array<int, 3>& n : {std::array<int, 3>{1, 1, 1},
                                      {2, 2, 2},
                                      {7, 5, 9},
                                      {1, 9, 1},
                                      {2, 1, 3},
                                      {10, 1, 2},
                                      {1, 10, 2}})
    for (const std::size_t count : {1ul, 3ul, 8ul, 77ul})
      expect_cloud<3>(mesh::Grid<3>(n, {0, 0, 0}, {1, 2, 1.5}), count, 2);
  for (const std::array<int, 2>& n : {std::array<int, 2>{1, 1}, {2, 2}, {7, 5}, {10, 1}})
    for (const std::size_t count : {1ul, 3ul, 8ul, 77ul})
      expect_cloud<2>(mesh::Grid<2>(n, {0, 0}, {1, 2}), count, 2);
}

/// Parcels that moved after the sort, some of them many tiles, some many domains away, are found
/// and give the same sums.
template <int D>
void expect_strays(const mesh::Grid<D>& grid, double distance) {
  Cloud<D> cloud(grid, 3000, 3, 72);
  for (std::size_t p = 0; p < cloud.store.size(); ++p)
    for (int d = 0; d < D - 1; ++d)
      cloud.store.position(d)[p] += grid.spacing[d] * uniform(cloud.random, -distance, distance);
  cloud.run();
  expect_conserved(cloud);
  if (distance < 100) expect_plain_deposit(cloud);
  // Far away the position itself is only known to its rounding: compare with the wrapped cloud.
  const AlignedArray<double> before = std::move(cloud.record);
  cloud.record = {};
  confine<D>(cloud.store, grid);
  cloud.run();
  const double tolerance = 1e-13 + 1e-15 * distance * 10;
  for (std::size_t c = 0; c < grid.columns(); ++c)
    for (int k = 0; k <= grid.nz(); ++k) {
      const std::size_t node = grid.node(c, k) * record_width<D>;
      EXPECT_NEAR(before[node], cloud.record[node], tolerance * grid.cell_volume() * 10);
    }
}
TEST(DepositProperty, ParcelsFarFromTheirTile) {
  for (const double distance : {1.0, 4.0, 30.0, 1e6}) {
    expect_strays<3>(mesh::Grid<3>({40, 20, 4}, {-1, 2, 0.5}, {4, 2, 0.4}), distance);
    expect_strays<2>(mesh::Grid<2>({40, 4}, {-1, 2}, {4, 0.4}), distance);
  }
}

// Beyond a wall by more than the halo: held there, nothing is lost.
TEST(DepositProperty, PointsBeyondTheHaloAreHeld) {
  Cloud<3> cloud(mesh::Grid<3>({8, 8, 4}, {0, 0, 0}, {1, 1, 1}), 500, 3, 73);
  for (std::size_t p = 0; p < cloud.store.size(); ++p)
    cloud.store.position(2)[p] += uniform(cloud.random, -3, 3);
  cloud.run();
  expect_conserved(cloud);
  expect_plain_deposit(cloud);
}

// A constant is deposited exactly whatever the positions: 1e-13, as every mean is a quotient of two
// sums with the same weights. Means never leave the range of the parcels by more.
TEST(DepositProperty, ConstantsAndBounds) {
  Cloud<3> cloud(mesh::Grid<3>({20, 20, 8}, {0, 0, 0}, {1, 1, 1}), 25600, 4, 74);
  std::fill(cloud.store.vorticity(2), cloud.store.vorticity(2) + cloud.store.size(), -2.25);
  cloud.run();
  ASSERT_EQ(cloud.empty, 0u);
  for (std::size_t c = 0; c < cloud.grid.columns(); ++c)
    for (int k = 0; k <= cloud.grid.nz(); ++k) {
      const double* node = &cloud.record[cloud.grid.node(c, k) * 8];
      EXPECT_NEAR(node[3], -2.25, 1e-13);
      for (const int f : {1, 2, 4}) EXPECT_LE(std::abs(node[f]), 1 + 1e-13);
    }
}

// Acceptance 4: linear fields exact in the interior when the parcels tile it regularly, for any
// (common) shape: the support points are symmetric about centres that are symmetric about nodes.
TEST(DepositProperty, LinearFieldsInTheInterior) {
  testing::Random random(75);
  const mesh::Grid<3> grid({12, 12, 12}, {0, 0, 0}, {12, 12, 12});
  Cloud<3> cloud(grid, 12 * 12 * 12 * 8, 1, 75);
  const Eigen::Matrix3d b = testing::random_shape_of_volume<3>(random, 1.0 / 8, 2);
  std::size_t p = 0;
  for (int i = 0; i < 24; ++i)
    for (int j = 0; j < 24; ++j)
      for (int k = 0; k < 24; ++k, ++p) {
        const int index[3] = {i, j, k};
        for (int d = 0; d < 3; ++d) cloud.store.position(d)[p] = 0.25 + 0.5 * index[d];
        cloud.store.volume()[p] = 1.0 / 8;
        testing::put_shape<3>(cloud.store, p, b);
        cloud.store.scalar(0)[p] = 3 + 0.7 * cloud.store.position(0)[p] -
                                   1.1 * cloud.store.position(1)[p] +
                                   0.3 * cloud.store.position(2)[p];
      }
  cloud.run();
  for (int i = 2; i <= 10; ++i)
    for (int j = 2; j <= 10; ++j)
      for (int k = 2; k <= 10; ++k)
        EXPECT_NEAR(cloud.record[grid.node(grid.column(i, j), k) * 8 + 4],
                    3 + 0.7 * i - 1.1 * j + 0.3 * k, 2e-13);
}

template <int D>
void expect_same_bits(const mesh::Grid<D>& grid) {
  const int before = omp_get_max_threads();
  std::vector<double> first;
  for (const int threads : {1, 2, 3}) {
    omp_set_num_threads(threads);
    Cloud<D> cloud(grid, 20000, 4, 76);
    for (std::size_t p = 0; p < cloud.store.size(); p += 17)
      cloud.store.position(0)[p] += 0.4 * grid.extent[0];
    cloud.run();
    std::vector<double> record(cloud.record.data(), cloud.record.data() + cloud.record.size());
    if (first.empty()) first = record;
    EXPECT_EQ(std::memcmp(first.data(), record.data(), first.size() * sizeof(double)), 0)
        << threads << " threads";
  }
  omp_set_num_threads(before);
}
TEST(DepositProperty, SameBitsForAnyNumberOfThreads) {
  expect_same_bits<3>(mesh::Grid<3>({40, 40, 8}, {0, 0, 0}, {1, 1, 1}));
  expect_same_bits<2>(mesh::Grid<2>({80, 40}, {0, 0}, {1, 1}));
}

}  // namespace
}  // namespace pileus::parcels
