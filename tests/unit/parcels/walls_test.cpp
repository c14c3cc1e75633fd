// Reflection at the walls and the periodic wrap, exact edges and far overshoots included.
#include "parcels/walls.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "parcel_cloud.hpp"
#include "parcels/ellipsoid.hpp"

namespace pileus::parcels {
namespace {

using std::numbers::pi;

// Dossier 11.1 and A.1: a² = 4ab, b² = ab/4, half a cell outside, every angle: z mirrored, angle →
// −angle, B12 → −B12, at 1e-14.
TEST(Walls, EllipsesAreReflectedInEveryOrientation) {
  const mesh::Grid<2> grid({4, 4}, {-1, -2}, {2, 3});
  const double half = 0.5 * grid.spacing[1];
  for (int degree = 0; degree < 360; ++degree)
    for (const bool below : {true, false}) {
      const double angle = degree * pi / 180, c = std::cos(angle), s = std::sin(angle);
      Store store(2, {});
      store.resize(1);
      store.position(0)[0] = 0.3;
      store.position(1)[0] = below ? grid.bottom() - half : grid.top() + half;
      store.vorticity(0)[0] = 0.7;
      store.volume()[0] = pi;
      const double shape[3] = {4 * c * c + 0.25 * s * s, 3.75 * s * c, 4 * s * s + 0.25 * c * c};
      for (int k = 0; k < 3; ++k) store.shape(k)[0] = shape[k];
      confine<2>(store, grid);
      EXPECT_NEAR(store.position(1)[0], below ? grid.bottom() + half : grid.top() - half, 1e-14);
      EXPECT_EQ(store.position(0)[0], 0.3);
      EXPECT_EQ(store.shape(0)[0], shape[0]);
      EXPECT_EQ(store.shape(1)[0], -shape[1]);
      EXPECT_EQ(store.shape(2)[0], shape[2]);
      EXPECT_EQ(store.vorticity(0)[0], 0.7) << "the parcel turns back, not the flow";
      const auto axes = baseline::principal_axes(
          baseline::Symmetric2<double>{store.shape(0)[0], store.shape(1)[0], store.shape(2)[0]});
      EXPECT_NEAR(axes.major_x * s + axes.major_z * c, 0, 1e-14);
    }
}

TEST(Walls, EllipsoidsAreReflectedInEveryOrientation) {
  const mesh::Grid<3> grid({4, 4, 4}, {0, 0, 0}, {1, 1, 1});
  const double half = 0.5 * grid.spacing[2];
  testing::Random random(41);
  for (int draw = 0; draw < 2000; ++draw) {
    const Eigen::Matrix3d b = testing::random_shape<3>(random, Eigen::Vector3d(4, 1, 0.25));
    const bool below = draw % 2 == 0;
    Store store(3, {});
    store.resize(1);
    for (int d = 0; d < 3; ++d) store.position(d)[0] = 0.4;
    store.position(2)[0] = below ? -half : 1 + half;
    for (int c = 0; c < 3; ++c) store.vorticity(c)[0] = c + 1;
    testing::put_shape<3>(store, 0, b);
    confine<3>(store, grid);
    const Eigen::Matrix3d mirror = Eigen::Vector3d(1, 1, -1).asDiagonal();
    EXPECT_EQ(testing::get_shape<3>(store, 0), Eigen::Matrix3d(mirror * b * mirror));
    EXPECT_NEAR(store.position(2)[0], below ? half : 1 - half, 1e-15);
    for (int c = 0; c < 3; ++c) EXPECT_EQ(store.vorticity(c)[0], c + 1);
  }
}

/// x after confine() in a periodic direction of the grid.
double wrapped(const mesh::Grid<2>& grid, double x) {
  Store store(2, {});
  store.resize(1);
  store.position(0)[0] = x;
  store.position(1)[0] = 0.5 * (grid.bottom() + grid.top());
  confine<2>(store, grid);
  return store.position(0)[0];
}

// Dossier 11.1: EPIC's formula is wrong beyond one box length and at the lower edge.
TEST(Walls, PeriodicEdgesAndOvershoots) {
  const mesh::Grid<2> grid({4, 4}, {-1, 0}, {2, 1});
  EXPECT_EQ(wrapped(grid, -1), -1);
  EXPECT_EQ(wrapped(grid, 1), -1);
  EXPECT_EQ(wrapped(grid, std::nextafter(1.0, 0.0)), std::nextafter(1.0, 0.0));
  EXPECT_NEAR(wrapped(grid, std::nextafter(-1.0, -2.0)), 1, 3e-16);
  const mesh::Grid<2> at_zero({4, 4}, {0, 0}, {2, 1});
  EXPECT_EQ(wrapped(at_zero, -1e-30), 0) << "rounds up to the seam";
  EXPECT_EQ(wrapped(grid, 0.25 + 2 * 1000), 0.25);
  EXPECT_EQ(wrapped(grid, 0.25 - 2 * 1000), 0.25);
  EXPECT_EQ(wrapped(grid, -3), -1);
  EXPECT_EQ(wrapped(grid, 3), -1);
}

TEST(Walls, WrappedPositionsAreAlwaysInside) {
  testing::Random random(42);
  for (int draw = 0; draw < 200000; ++draw) {
    const double lower = testing::uniform(random, -3, 3), extent = testing::uniform(random, 0.1, 7);
    const mesh::Grid<2> grid({3, 3}, {lower, 0}, {extent, 1});
    const double periods = std::floor(testing::uniform(random, -6, 6));
    // Around the images of the edges, a few roundings to either side.
    double x = lower + periods * extent;
    for (int nudge = static_cast<int>(random() % 5); nudge > 0; --nudge)
      x = std::nextafter(x, random() % 2 ? 1e9 : -1e9);
    if (draw % 3 == 0) x += testing::uniform(random, 0, extent);
    const double w = wrapped(grid, x);
    EXPECT_GE(w, lower) << x;
    EXPECT_LT(w, lower + extent) << x;
    const double turns = (x - w) / extent;
    EXPECT_NEAR(turns, std::round(turns), 1e-13 / extent + 1e-14 * 6);
  }
}

TEST(Walls, OnTheWallIsInside) {
  const mesh::Grid<3> grid({4, 4, 4}, {0, 0, -1}, {1, 1, 2});
  Store store(3, {});
  store.resize(4);
  const double heights[4] = {-1, 1, 1 + 7.3, -1 - 1e300};
  for (std::size_t p = 0; p < 4; ++p) {
    store.position(0)[p] = store.position(1)[p] = 0.5;
    store.position(2)[p] = heights[p];
    for (int c = 0; c < 6; ++c) store.shape(c)[p] = c + 1;
  }
  confine<3>(store, grid);
  EXPECT_EQ(store.position(2)[0], -1);
  EXPECT_EQ(store.position(2)[1], 1);
  EXPECT_EQ(store.shape(2)[0], 3) << "not reflected";
  EXPECT_EQ(store.shape(2)[1], 3);
  // Beyond the other wall after one reflection: on the nearest wall.
  EXPECT_EQ(store.position(2)[2], -1);
  EXPECT_EQ(store.position(2)[3], 1);
}

// What is not a number must be seen by the guards, not tidied away.
TEST(Walls, NotANumberStaysOne) {
  const mesh::Grid<3> grid({4, 4, 4}, {0, 0, 0}, {1, 1, 1});
  for (int axis = 0; axis < 3; ++axis) {
    Store store(3, {});
    store.resize(1);
    for (int d = 0; d < 3; ++d) store.position(d)[0] = 0.5;
    store.position(axis)[0] = std::numeric_limits<double>::quiet_NaN();
    for (int c = 0; c < 6; ++c) store.shape(c)[0] = 1;
    confine<3>(store, grid);
    EXPECT_TRUE(std::isnan(store.position(axis)[0])) << axis;
  }
}

}  // namespace
}  // namespace pileus::parcels
