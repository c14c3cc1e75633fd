// Splitting: the numbers of the method's shipped tests and the moments it promises to keep.
#include "parcels/split.hpp"

#include <gtest/gtest.h>

#include <set>

#include "parcel_cloud.hpp"
#include "parcels/identity.hpp"

namespace pileus::parcels {
namespace {

using std::numbers::pi;
using testing::get_position;
using testing::get_shape;
using testing::put_shape;

const std::vector<Scalar> scalars = {{"specific", "1", Nature::intensive, "", 0, 0, 0},
                                     {"amount", "kg", Nature::extensive, "", 0, 0, 0}};

template <int D>
mesh::Grid<D> wide_grid() {
  std::array<int, D> cells;
  std::array<double, D> lower, extent;
  cells.fill(8);
  lower.fill(-50);
  extent.fill(100);
  return {cells, lower, extent};
}

/// Two copies of one parcel, as split_pair expects them.
template <int D>
Store two_copies(const Eigen::Matrix<double, D, D>& b, double volume,
                 const Eigen::Matrix<double, D, 1>& x) {
  Store store(D, scalars);
  store.resize(2);
  for (std::size_t p = 0; p < 2; ++p) {
    for (int d = 0; d < D; ++d) store.position(d)[p] = x(d);
    store.volume()[p] = volume;
    put_shape<D>(store, p, b);
    for (int c = 0; c < store.vorticity_components(); ++c) store.vorticity(c)[p] = 0.1 * (c + 1);
    store.scalar(0)[p] = 0.3;
    store.scalar(1)[p] = 0.7;
    store.uid()[p] = 42;
  }
  return store;
}

// Dossier 7.3, 2D: ab = 1, λ = 5 at 45°: B11' = B11 − ¾ a² cos², centres ± (√3/4) a (cos, sin).
TEST(Split, EllipseAtFortyFiveDegrees) {
  const double a2 = 5, b2 = 0.2, half = 0.5;
  Eigen::Matrix2d b;
  b << (a2 + b2) * half, (a2 - b2) * half, (a2 - b2) * half, (a2 + b2) * half;
  Store store = two_copies<2>(b, pi, Eigen::Vector2d(0, 0));
  split_pair<2>(store, wide_grid<2>(), CellMetric<2>(wide_grid<2>()), 0, 1, 3);
  const double reach = std::sqrt(3.0) / 4 * std::sqrt(a2) * std::sqrt(half);
  for (std::size_t p = 0; p < 2; ++p) {
    EXPECT_NEAR(store.shape(0)[p], b(0, 0) - 0.75 * a2 * half, 1e-15);
    EXPECT_NEAR(store.shape(1)[p], b(0, 1) - 0.75 * a2 * half, 1e-15);
    EXPECT_NEAR(store.shape(2)[p], b(1, 1) - 0.75 * a2 * half, 1e-15);
    EXPECT_EQ(store.volume()[p], pi / 2);
    EXPECT_NEAR(std::abs(store.position(0)[p]), reach, 1e-15);
    EXPECT_NEAR(store.position(0)[p], store.position(1)[p], 1e-15);
  }
  EXPECT_EQ(store.position(0)[0], -store.position(0)[1]);
}

// Dossier 7.3, 3D: abc = 1, a² = 5, b² = 1/5, c² = 1, all spherical angles, 1e-14.
TEST(Split, EllipsoidInEveryOrientation) {
  for (int azimuth = 0; azimuth < 360; azimuth += 10)
    for (int polar = 0; polar <= 180; polar += 10) {
      const double t = azimuth * pi / 180, f = polar * pi / 180;
      Eigen::Matrix3d axes;  // columns: radial, azimuthal, polar
      axes << std::cos(t) * std::sin(f), -std::sin(t), std::cos(t) * std::cos(f),
          std::sin(t) * std::sin(f), std::cos(t), std::sin(t) * std::cos(f), std::cos(f), 0,
          -std::sin(f);
      const Eigen::Matrix3d b = axes * Eigen::Vector3d(5, 0.2, 1).asDiagonal() * axes.transpose();
      Store store = two_copies<3>(b, 4 * pi / 3, Eigen::Vector3d(1, 2, 3));
      split_pair<3>(store, wide_grid<3>(), CellMetric<3>(wide_grid<3>()), 0, 1, 3);
      const Eigen::Vector3d radial = axes.col(0);
      const double h = 0.5 * std::sqrt(0.6) * std::sqrt(5.0);
      for (std::size_t p = 0; p < 2; ++p) {
        EXPECT_LT((get_shape<3>(store, p) - (b - 0.75 * 5 * radial * radial.transpose())).norm(),
                  1e-14);
        const Eigen::Vector3d shift = get_position<3>(store, p) - Eigen::Vector3d(1, 2, 3);
        EXPECT_LT(std::min((shift - h * radial).norm(), (shift + h * radial).norm()), 1e-14);
        EXPECT_EQ(store.volume()[p], 2 * pi / 3);
      }
    }
}

/// Volume, centroid, second moment V B/(D+2) + V x xᵀ and determinant, for random shapes.
template <int D>
void expect_moments_kept() {
  testing::Random random(11);
  using Matrix = Eigen::Matrix<double, D, D>;
  using Vector = Eigen::Matrix<double, D, 1>;
  for (int draw = 0; draw < 2000; ++draw) {
    const double volume = testing::uniform(random, 0.1, 3);
    const Matrix b = testing::random_shape_of_volume<D>(random, volume, 6);
    Vector x;
    for (int d = 0; d < D; ++d) x(d) = testing::uniform(random, -2, 2);
    Store store = two_copies<D>(b, volume, x);
    split_pair<D>(store, wide_grid<D>(), CellMetric<D>(wide_grid<D>()), 0, 1, 9);
    Vector first = Vector::Zero();
    Matrix second = Matrix::Zero();
    for (std::size_t p = 0; p < 2; ++p) {
      const Vector dx = get_position<D>(store, p) - x;
      first += store.volume()[p] * dx;
      second += store.volume()[p] * (get_shape<D>(store, p) / (D + 2) + dx * dx.transpose());
      // Halving one axis quarters det B, as halving the volume asks.
      EXPECT_NEAR(get_shape<D>(store, p).determinant() /
                      testing::squared_axes_product<D>(store.volume()[p]),
                  1, 1e-12);
    }
    EXPECT_EQ(store.volume()[0] + store.volume()[1], volume);
    EXPECT_LT(first.norm(), 1e-15 * volume * 10);
    EXPECT_LT((second - volume * b / (D + 2)).norm(), 1e-14 * volume * b.norm());
    EXPECT_EQ(store.scalar(0)[0], 0.3);
    EXPECT_EQ(store.scalar(0)[1], 0.3);
    EXPECT_EQ(store.scalar(1)[0] + store.scalar(1)[1], 0.7);
    EXPECT_EQ(store.scalar(1)[0], 0.35);
    EXPECT_EQ(store.vorticity(0)[1], 0.1);
  }
}
TEST(Split, KeepsMomentsInThePlane) {
  expect_moments_kept<2>();
}
TEST(Split, KeepsMomentsInSpace) {
  expect_moments_kept<3>();
}

TEST(Split, ExtensiveScalarsSumToTheWholeBitwise) {
  testing::Random random(12);
  for (int draw = 0; draw < 1000; ++draw) {
    Store store = two_copies<2>(Eigen::Matrix2d::Identity(), pi, Eigen::Vector2d(0, 0));
    const double amount = draw == 0 ? 5e-324 : testing::uniform(random, 0, 1);
    store.scalar(1)[0] = store.scalar(1)[1] = amount;
    split_pair<2>(store, wide_grid<2>(), CellMetric<2>(wide_grid<2>()), 0, 1, 1);
    EXPECT_EQ(store.scalar(1)[0] + store.scalar(1)[1], amount);
  }
}

// The parent keeps its identity; siblings, generations and steps give different ones.
TEST(Split, IdentitiesAreNew) {
  Store store = two_copies<2>(Eigen::Matrix2d::Identity(), pi, Eigen::Vector2d(0, 0));
  split_pair<2>(store, wide_grid<2>(), CellMetric<2>(wide_grid<2>()), 0, 1, 17);
  EXPECT_EQ(store.uid()[0], 42u);
  EXPECT_EQ(store.uid()[1], child_uid(42, 17));
  std::set<std::uint64_t> seen;
  for (std::uint64_t parent = 0; parent < 500; ++parent) {
    seen.insert(parent);
    for (std::uint64_t step = 0; step < 200; ++step) seen.insert(child_uid(parent, step));
  }
  EXPECT_EQ(seen.size(), 500u * 201u);
}

// In cells that are no cubes a split halves what is longest in cells; volume, centroid and second
// moment are kept, which any affine map leaves true.
TEST(Split, KeepsMomentsInTheMetricOfFlatCells) {
  const mesh::Grid<3> grid({8, 8, 8}, {-80, -80, -8}, {160, 160, 16});
  const CellMetric<3> metric(grid);
  testing::Random random(5);
  for (int draw = 0; draw < 200; ++draw) {
    const double volume = testing::uniform(random, 0.5, 2);
    const Eigen::Matrix3d b = testing::random_shape_of_volume<3>(random, volume, 3);
    const Eigen::Vector3d x(1, 2, 0.5);
    Store store = two_copies<3>(b, volume, x);
    split_pair<3>(store, grid, metric, 0, 1, 1);
    Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
    Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
    for (std::size_t p = 0; p < 2; ++p) {
      const Eigen::Vector3d d = testing::get_position<3>(store, p) - x;
      centroid += 0.5 * d;
      second += 0.5 * (get_shape<3>(store, p) + 5 * d * d.transpose());
      // (abc)^2 of half the volume is a quarter.
      EXPECT_NEAR(get_shape<3>(store, p).determinant() / (0.25 * b.determinant()), 1, 1e-11);
      EXPECT_EQ(store.volume()[p], 0.5 * volume);
    }
    EXPECT_LT(centroid.norm(), 1e-14);
    EXPECT_LT((second - b).norm(), 1e-13 * b.norm());
  }
}

// A parcel of the cell's own shape is round to the mesh, whatever the cell; the same parcel turned
// on its side is twenty-five cells as long as thick.
TEST(Split, ShapeOfTheCellIsRound) {
  const mesh::Grid<3> grid({8, 8, 8}, {0, 0, 0}, {40, 40, 8});
  const auto criterion = SplitCriterion<3>::make(grid, 4, 2.89);
  const CellMetric<3> metric(grid);
  EXPECT_FALSE(metric.plain);
  EXPECT_NEAR(metric.stretch[0] * metric.stretch[1] * metric.stretch[2], 1, 1e-14);
  EXPECT_NEAR(metric.stretch[2] / metric.stretch[0], 5, 1e-14);
  const double radius = 0.31 * metric.edge;  // half the longest allowed
  EXPECT_FALSE(criterion.splits(radius * radius, 1.0, 1.0));
  EXPECT_TRUE(criterion.splits(radius * radius, 25.0 * 25.0, 1.0));
}

// Dossier 7.2: a child whose centre is outside the wall is reflected; horizontally it wraps.
TEST(Split, ChildrenAreReflectedAndWrapped) {
  const mesh::Grid<3> grid({4, 4, 4}, {0, 0, 0}, {4, 4, 4});
  Eigen::Matrix3d b = Eigen::Vector3d(0.04, 0.04, 1).asDiagonal();
  b(0, 2) = b(2, 0) = 0.05;
  Store store = two_copies<3>(b, 1, Eigen::Vector3d(3.999, 2, 0.1));
  split_pair<3>(store, grid, CellMetric<3>(grid), 0, 1, 1);
  const double xx = std::abs(store.shape(2)[0]);
  EXPECT_GT(xx, 0);
  EXPECT_EQ(store.shape(2)[0], -store.shape(2)[1]) << "one of the two was mirrored";
  for (std::size_t p = 0; p < 2; ++p) {
    EXPECT_GE(store.position(2)[p], 0);
    EXPECT_GE(store.position(0)[p], 0);
    EXPECT_LT(store.position(0)[p], 4);
  }
}

// Dossier 7.1: 3D λ = a/c ≥ 4 or a ≥ (3/4π)^⅓ Δ = 0.6203505 Δ, with the edge Δ of the cube of the
// cell's volume; 2D λ > 4 strictly, or V > V_cell/2.89.
TEST(SplitCriterion, ThresholdsOfTheMethod) {
  const mesh::Grid<3> space({10, 10, 10}, {0, 0, 0}, {20, 30, 10});
  const auto in_space = SplitCriterion<3>::make(space, 4, 2.89);
  EXPECT_NEAR(std::sqrt(in_space.squared_longest), 0.6203505 * std::cbrt(6.0), 2e-7);
  EXPECT_TRUE(in_space.splits(0.01, 16, 1e9));
  EXPECT_FALSE(in_space.splits(0.01, std::nextafter(16.0, 0.0), 1e9));
  EXPECT_TRUE(in_space.splits(in_space.squared_longest, 1, 0));
  EXPECT_FALSE(in_space.splits(std::nextafter(in_space.squared_longest, 0.0), 1, 0));
  const mesh::Grid<2> plane({10, 10}, {0, 0}, {20, 10});
  const auto in_plane = SplitCriterion<2>::make(plane, 4, 2.89);
  EXPECT_FALSE(in_plane.splits(1e9, 16, 0));
  EXPECT_TRUE(in_plane.splits(0, std::nextafter(16.0, 17.0), 0));
  EXPECT_FALSE(in_plane.splits(0, 1, 2 / 2.89));
  EXPECT_TRUE(in_plane.splits(0, 1, std::nextafter(2 / 2.89, 1.0)));
}

}  // namespace
}  // namespace pileus::parcels
