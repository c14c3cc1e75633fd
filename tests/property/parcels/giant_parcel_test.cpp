// One giant parcel splits until none is too large, and loses nothing on the way (scenes reference
// 9, case 22).
#include <gtest/gtest.h>

#include "../../unit/parcels/parcel_cloud.hpp"
#include "parcels/upkeep.hpp"

namespace pileus::parcels {
namespace {

struct Moments {
  double volume = 0;
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();  // about `centre`
};

Moments moments_of(const Store& store, const Eigen::Vector3d& centre) {
  Moments m;
  for (std::size_t p = 0; p < store.size(); ++p) {
    const double v = store.volume()[p];
    const Eigen::Vector3d d = testing::get_position<3>(store, p) - centre;
    m.volume += v;
    m.centroid += v * d;
    m.second += v * (testing::get_shape<3>(store, p) / 5 + d * d.transpose());
  }
  m.centroid /= m.volume;
  m.second /= m.volume;
  return m;
}

/// A parcel of `cells` cells' volume, in a domain that its children do not reach the walls of.
void expect_cascade(const mesh::Grid<3>& grid, double cells, double spread) {
  const Tiling<3> tiling(grid);
  const auto criterion = SplitCriterion<3>::make(grid, 4, 2.89);
  Upkeep<3> upkeep(grid, tiling, 0, criterion);  // nothing merges
  Store store(3, {{"buoyancy", "m s-2", Nature::intensive, "", 0, 0, 0}});
  store.resize(1);
  const Eigen::Vector3d centre =
      Eigen::Vector3d(grid.extent[0], grid.extent[1], grid.extent[2]) / 2;
  for (int d = 0; d < 3; ++d) store.position(d)[0] = centre(d);
  store.volume()[0] = cells * grid.cell_volume();
  testing::Random random(4);
  testing::put_shape<3>(store, 0,
                        testing::random_shape_of_volume<3>(random, store.volume()[0], spread));
  for (int c = 0; c < 3; ++c) store.vorticity(c)[0] = 1;
  store.scalar(0)[0] = 0.25;
  store.uid()[0] = 1;
  const Moments before = moments_of(store, centre);

  SupportOffsets<3> offsets;
  PhaseTimes times;
  const double edge = CellMetric<3>(grid).edge;
  const double longest = std::sqrt(criterion.squared_longest);
  // Every axis is halved until it is below the longest allowed.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(5.0 * before.second);
  const Eigen::Vector3d axes = solver.eigenvalues().cwiseSqrt();
  int halvings = 0;
  for (int a = 0; a < 3; ++a)
    halvings += std::max(0, int(std::ceil(std::log2(axes(a) / longest))) + 1);
  int rounds = 0;
  while (upkeep.run(store, offsets, static_cast<std::uint64_t>(rounds), times).splits > 0)
    ASSERT_LE(++rounds, halvings) << "cells of edge " << edge;
  EXPECT_GT(rounds, 5);
  const Moments after = moments_of(store, centre);
  EXPECT_NEAR(after.volume / before.volume, 1, 1e-12);
  EXPECT_LT(after.centroid.norm(), 1e-10 * longest);
  EXPECT_LT((after.second - before.second).norm(), 1e-10 * before.second.norm());
  for (std::size_t p = 0; p < store.size(); ++p) EXPECT_EQ(store.scalar(0)[p], 0.25);
}

TEST(GiantParcel, SplitsWithoutLoss) {
  const mesh::Grid<3> grid({64, 64, 64}, {0, 0, 0}, {64, 64, 64});
  expect_cascade(grid, 100, 1.0);
  expect_cascade(grid, 100, 2.0);
  expect_cascade(grid, 5000, 1.3);
}

}  // namespace
}  // namespace pileus::parcels
