// What the ground gives to the parcels next to it: exact sums wherever the parcels are, the shape
// of the force, and values at points.
#include "../../../plugins/surface_fluxes/ground_layer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include "../../../plugins/surface_fluxes/surface_stress.hpp"

namespace pileus::surface {
namespace {

struct Cloud {
  std::vector<double> x, y, z, volume;
  ParcelArrays arrays(bool plane = false) const {
    return {x.data(), plane ? nullptr : y.data(), z.data(), volume.data(),
            static_cast<std::int64_t>(x.size())};
  }
  double sum(const std::vector<double>& values) const {
    long double s = 0;
    for (std::size_t p = 0; p < x.size(); ++p) s += static_cast<long double>(volume[p]) * values[p];
    return static_cast<double>(s);
  }
};

const Ground ground{{6, 5}, {-3, 2}, {50, 40}, -10, 25, 200};

Cloud random_cloud(std::size_t n, unsigned seed, double lowest = 0) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> u(0, 1);
  Cloud c;
  for (std::size_t p = 0; p < n; ++p) {
    c.x.push_back(ground.origin[0] + 300 * u(random));
    c.y.push_back(ground.origin[1] + 200 * u(random));
    c.z.push_back(ground.bottom + lowest + (200 - lowest) * u(random));
    c.volume.push_back(300 * 200 * 200 / static_cast<double>(n) * (0.1 + 1.8 * u(random)));
  }
  return c;
}

struct Sums {
  explicit Sums(std::size_t n) : reach(n), volume(n) {}
  std::vector<double> reach, volume;
  PointSums spans() { return {reach, volume}; }
};

struct Layer {
  Layer(const Ground& g, const Cloud& cloud, double reach, bool plane = false)
      : near(GroundLayer::count_below(g, cloud.arrays(plane), reach)),
        layer(g, cloud.arrays(plane), reach, near) {}
  std::vector<std::int64_t> near;
  GroundLayer layer;
};

std::vector<double> random_amounts(unsigned seed, double low, double high) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> u(low, high);
  std::vector<double> m(ground.points());
  for (double& value : m) value = u(random);
  return m;
}

std::vector<double> shares(const std::vector<double>& amounts, const Sums& sums) {
  std::vector<double> s(amounts.size());
  for (std::size_t j = 0; j < s.size(); ++j)
    s[j] = sums.volume[j] > 0 ? amounts[j] / sums.volume[j] : 0;
  return s;
}

TEST(GroundLayer, GivesExactlyWhatComes) {
  for (const VerticalWeight shape : {VerticalWeight::ramp, VerticalWeight::box}) {
    const Cloud cloud = random_cloud(4000, 1);
    Layer l(ground, cloud, ground.depth);
    Sums sums(ground.points());
    EXPECT_EQ(l.layer.weigh(shape, ground.depth, sums.spans()), 0u);
    const std::vector<double> amounts = random_amounts(2, -1, 3);
    std::vector<double> values(cloud.x.size(), 0.0);
    l.layer.add(shape, sums.spans(), shares(amounts, sums), values.data());
    const double expected = std::accumulate(amounts.begin(), amounts.end(), 0.0);
    EXPECT_NEAR(cloud.sum(values), expected, 1e-13 * expected);
    for (std::size_t p = 0; p < values.size(); ++p) {
      if (cloud.z[p] >= ground.bottom + ground.depth) {
        EXPECT_EQ(values[p], 0);
      }
    }
  }
}

/// What one point gives stays within a cell's width of it, across the sides of the domain too.
TEST(GroundLayer, GivesToTheParcelsAround) {
  const Cloud cloud = random_cloud(4000, 3);
  Layer l(ground, cloud, ground.depth);
  Sums sums(ground.points());
  l.layer.weigh(VerticalWeight::ramp, ground.depth, sums.spans());
  std::vector<double> amounts(ground.points(), 0.0);
  amounts[0] = 1;
  std::vector<double> values(cloud.x.size(), 0.0);
  l.layer.add(VerticalWeight::ramp, sums.spans(), shares(amounts, sums), values.data());
  bool across = false;
  for (std::size_t p = 0; p < values.size(); ++p) {
    double dx = std::abs(cloud.x[p] - (ground.origin[0] + 25));
    double dy = std::abs(cloud.y[p] - (ground.origin[1] + 20));
    dx = std::min(dx, 300 - dx), dy = std::min(dy, 200 - dy);
    const double z = cloud.z[p] - ground.bottom;
    const double weight = std::max(0.0, 1 - dx / 50) * std::max(0.0, 1 - dy / 40) *
                          std::max(0.0, 1 - z / 25) / sums.volume[0];
    EXPECT_NEAR(values[p], weight, 1e-12 * (weight + 1 / sums.volume[0]));
    across |= weight > 0 && cloud.x[p] > ground.origin[0] + 200;
  }
  EXPECT_TRUE(across);
}

TEST(GroundLayer, ReachesFurtherWhereThereAreNoParcels) {
  const Cloud cloud = random_cloud(3000, 4, 60);
  for (const VerticalWeight shape : {VerticalWeight::ramp, VerticalWeight::box}) {
    Layer l(ground, cloud, ground.depth);
    Sums sums(ground.points());
    EXPECT_EQ(l.layer.weigh(shape, ground.depth, sums.spans()), ground.points());
    for (const double reach : sums.reach) EXPECT_EQ(reach, 100);
    const std::vector<double> amounts = random_amounts(5, 0, 1);
    std::vector<double> values(cloud.x.size(), 0.0);
    l.layer.add(shape, sums.spans(), shares(amounts, sums), values.data());
    const double expected = std::accumulate(amounts.begin(), amounts.end(), 0.0);
    EXPECT_NEAR(cloud.sum(values), expected, 1e-13 * expected);
  }
}

/// A single point without parcels does not change what others do, and no parcels at all end it.
TEST(GroundLayer, EndsWithoutParcels) {
  Cloud cloud = random_cloud(3000, 6);
  for (double& x : cloud.x) x = ground.origin[0] + 0.1 * (x - ground.origin[0]);
  Layer l(ground, cloud, ground.depth);
  Sums sums(ground.points());
  EXPECT_GT(l.layer.weigh(VerticalWeight::ramp, ground.depth, sums.spans()), 0u);
  EXPECT_EQ(sums.reach[0], ground.depth);
  EXPECT_EQ(sums.reach[3], ground.height);
  EXPECT_EQ(sums.volume[3], 0);
  const Cloud none;
  Layer empty(ground, none, ground.depth);
  EXPECT_EQ(empty.layer.weigh(VerticalWeight::tent, ground.depth, sums.spans()), ground.points());
}

/// Never below zero, and what is lacking is owed exactly.
TEST(GroundLayer, TakesNoMoreThanThereIs) {
  const Cloud cloud = random_cloud(4000, 7);
  Layer l(ground, cloud, ground.depth);
  Sums sums(ground.points());
  l.layer.weigh(VerticalWeight::ramp, ground.depth, sums.spans());
  const std::vector<double> amounts = random_amounts(8, -3, 1);
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> u(0, 2e-5);
  std::vector<double> values(cloud.x.size()), owed(ground.points(), 0.0);
  for (double& q : values) q = u(random);
  const double before = cloud.sum(values);
  const std::uint64_t cut = l.layer.add_to_fraction(VerticalWeight::ramp, sums.spans(),
                                                    shares(amounts, sums), values.data(), owed);
  EXPECT_GT(cut, 0u);
  for (const double q : values) EXPECT_GE(q, 0);
  for (std::size_t j = 0; j < owed.size(); ++j) {
    EXPECT_LE(owed[j], 0);
    EXPECT_GE(owed[j], std::min(amounts[j], 0.0) * (1 + 1e-12));
  }
  const double came = std::accumulate(amounts.begin(), amounts.end(), 0.0) -
                      std::accumulate(owed.begin(), owed.end(), 0.0);
  EXPECT_NEAR(cloud.sum(values) - before, came, 1e-13 * before);
}

/// Never more than all of a parcel, and what it could not take is owed exactly.
TEST(GroundLayer, GivesNoMoreThanAParcelCanTake) {
  const Cloud cloud = random_cloud(4000, 7);
  Layer l(ground, cloud, ground.depth);
  Sums sums(ground.points());
  l.layer.weigh(VerticalWeight::ramp, ground.depth, sums.spans());
  const double much = ground.cell_volume();
  const std::vector<double> amounts = random_amounts(8, -0.1 * much, much);
  std::vector<double> values(cloud.x.size(), 0.5), owed(ground.points(), 0.0);
  const double before = cloud.sum(values);
  const std::uint64_t cut = l.layer.add_to_fraction(VerticalWeight::ramp, sums.spans(),
                                                    shares(amounts, sums), values.data(), owed);
  EXPECT_GT(cut, 0u);
  for (const double q : values) EXPECT_LE(q, 1);
  for (std::size_t j = 0; j < owed.size(); ++j)
    EXPECT_LE(owed[j], std::max(amounts[j], 0.0) * (1 + 1e-12));
  const double came = std::accumulate(amounts.begin(), amounts.end(), 0.0) -
                      std::accumulate(owed.begin(), owed.end(), 0.0);
  EXPECT_NEAR(cloud.sum(values) - before, came, 1e-13 * before);
}

/// The mean of a linear profile at z_1 = h, of parcels that fill the layer evenly, is its value.
TEST(GroundLayer, ReadsValuesAtTheFirstLevel) {
  Cloud cloud;
  for (int k = 0; k < 8; ++k)
    for (int j = 0; j < 20; ++j)
      for (int i = 0; i < 24; ++i) {
        cloud.x.push_back(ground.origin[0] + 12.5 * (i + 0.5));
        cloud.y.push_back(ground.origin[1] + 10 * (j + 0.5));
        cloud.z.push_back(ground.bottom + 6.25 * (k + 0.5));
        cloud.volume.push_back(12.5 * 10 * 6.25);
      }
  Layer l(ground, cloud, 2 * ground.depth);
  Sums sums(ground.points());
  EXPECT_EQ(l.layer.weigh(VerticalWeight::tent, ground.depth, sums.spans()), 0u);
  std::vector<double> theta(cloud.x.size()), means(ground.points());
  for (std::size_t p = 0; p < theta.size(); ++p)
    theta[p] = 300 + 0.01 * (cloud.z[p] - ground.bottom);
  l.layer.mean(VerticalWeight::tent, sums.spans(), theta.data(), 0, means);
  for (const double m : means) EXPECT_NEAR(m, 300.25, 1e-11);
}

TEST(GroundLayer, InThePlaneIsLinearInX) {
  const Ground line{{8, 1}, {0, 0}, {10, 1}, 0, 5, 40};
  std::mt19937_64 random(10);
  std::uniform_real_distribution<double> u(0, 1);
  Cloud cloud;
  for (int p = 0; p < 2000; ++p) {
    cloud.x.push_back(80 * u(random));
    cloud.z.push_back(40 * u(random));
    cloud.volume.push_back(1.6);
  }
  Layer l(line, cloud, line.depth, true);
  Sums sums(line.points());
  EXPECT_EQ(l.layer.weigh(VerticalWeight::ramp, line.depth, sums.spans()), 0u);
  std::vector<double> values(cloud.x.size(), 0.0), amounts(8, 0.0);
  amounts[7] = 2;
  l.layer.add(VerticalWeight::ramp, sums.spans(), shares(amounts, sums), values.data());
  EXPECT_NEAR(cloud.sum(values), 2, 2e-13);
  for (std::size_t p = 0; p < values.size(); ++p) {
    const double dx = std::min(std::abs(cloud.x[p] - 75), 80 - std::abs(cloud.x[p] - 75));
    const double weight =
        std::max(0.0, 1 - dx / 10) * std::max(0.0, 1 - cloud.z[p] / 5) / sums.volume[7];
    EXPECT_NEAR(values[p], 2 * weight, 1e-12);
  }
}

TEST(GroundLayer, PositionsThatAreNoneStayInside) {
  for (const double x : {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e300, -1e15, 297.0, -3.0}) {
    const Corners c = corners_around(ground, x, x);
    for (const std::size_t j : c.point) EXPECT_LT(j, ground.points());
  }
}

/// The vertical vorticity given sums to nothing, and is the curl of a periodic stress.
TEST(SurfaceStress, CurlOfAPeriodicStress) {
  const Ground g{{64, 48}, {0, 0}, {10, 20}, 0, 25, 500};
  std::vector<double> x(g.points()), y(g.points()), amounts(g.points());
  const double k = 2 * M_PI / 640, l = 2 * M_PI / 960;
  for (std::size_t p = 0; p < x.size(); ++p) {
    const double px = 10 * (static_cast<double>(p % 64) + 0.5),
                 py = 20 * (static_cast<double>(p / 64) + 0.5);
    x[p] = std::cos(l * py), y[p] = 0.3 + std::sin(k * px);
  }
  vertical_vorticity_amounts(g, x, y, 2.0, amounts);
  double sum = 0;
  for (std::size_t p = 0; p < x.size(); ++p) {
    const double px = 10 * (static_cast<double>(p % 64) + 0.5),
                 py = 20 * (static_cast<double>(p / 64) + 0.5);
    const double curl =
        std::sin(10 * k) / 10 * std::cos(k * px) + std::sin(20 * l) / 20 * std::sin(l * py);
    EXPECT_NEAR(amounts[p], -2.0 * 200 * curl, 1e-12);
    sum += amounts[p];
  }
  EXPECT_NEAR(sum, 0, 1e-11);
}

/// Moeng's distribution has the plane's stress as its mean, and is it for a uniform wind.
TEST(SurfaceStress, DistributedStressKeepsItsMean) {
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal;
  std::vector<HorizontalVector> winds(1000);
  PlaneWind plane;
  for (HorizontalVector& w : winds) {
    w = {5 + normal(random), -2 + normal(random)};
    plane.mean.x += w.x / 1000, plane.mean.y += w.y / 1000;
    plane.speed += std::hypot(w.x, w.y) / 1000;
  }
  HorizontalVector mean;
  for (const HorizontalVector& w : winds) {
    const auto s = distributed_stress(0.09, plane, w, std::hypot(w.x, w.y), 0.1);
    mean.x += s.x / 1000, mean.y += s.y / 1000;
  }
  EXPECT_NEAR(mean.x, 0.09 * plane.mean.x / plane.speed, 1e-14);
  EXPECT_NEAR(mean.y, 0.09 * plane.mean.y / plane.speed, 1e-14);
  const auto uniform = distributed_stress(0.09, {{3, 4}, 5}, {3, 4}, 5, 0.1);
  EXPECT_NEAR(uniform.x, 0.09 * 0.6, 1e-16);
  EXPECT_NEAR(uniform.y, 0.09 * 0.8, 1e-16);
}

}  // namespace
}  // namespace pileus::surface
