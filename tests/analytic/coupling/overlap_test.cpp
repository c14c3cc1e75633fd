// Overlap of ellipsoids and the exchange between them.
#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "../../../plugins/overlap_exchange/contact.hpp"
#include "../../../plugins/overlap_exchange/exchange.hpp"
#include "../../../plugins/overlap_exchange/neighbours.hpp"
#include "../../unit/coupling/sampled_mesh.hpp"

namespace pileus::testing {
namespace {

using overlap::contact_function;
using overlap::Symmetric;
using overlap::Vector;
constexpr double no_limit = 1e300;

template <int D>
Symmetric<D> packed(const Eigen::Matrix<double, D, D>& b) {
  Symmetric<D> m{};
  int c = 0;
  for (int i = 0; i < D; ++i)
    for (int j = i; j < D; ++j, ++c) m[static_cast<std::size_t>(c)] = b(i, j);
  return m;
}
template <int D>
double contact(const Eigen::Matrix<double, D, D>& b1, const Eigen::Matrix<double, D, D>& b2,
               const Eigen::Matrix<double, D, 1>& d) {
  Vector<D> apart;
  for (int i = 0; i < D; ++i) apart[static_cast<std::size_t>(i)] = d(i);
  return contact_function<D>(packed<D>(b1), packed<D>(b2), apart, no_limit).value;
}

// Spheres: F = |d|²/(r₁ + r₂)² at s = r₂/(r₁ + r₂) of the weight of B₁ … 0.8711, 1.0000, 1.1378 for
// radii 1 and ½.
TEST(Contact, OfSpheres) {
  const struct { double apart, value; } cases[] = {{1.4, 0.8711}, {1.5, 1.0}, {1.6, 1.1378}};
  for (const auto& c : cases) {
    const auto found = contact_function<3>({1, 0, 0, 1, 0, 1}, {0.25, 0, 0, 0.25, 0, 0.25},
                                           {0, c.apart, 0}, no_limit);
    EXPECT_NEAR(found.value, c.apart * c.apart / 2.25, 1e-14);
    EXPECT_NEAR(found.value, c.value, 5e-5);
    // s B₁ + (1 − s) B₂ weights B₁ by s: the maximum is where (1−s) r₂ = s r₁.
    EXPECT_NEAR(found.position, 0.5 / 1.5, 1e-7);
    EXPECT_LE(found.iterations, 8);
  }
}

// x → Ax leaves F unchanged.
TEST(Contact, IsInvariantUnderAffineMaps) {
  Random random(41);
  for (int n = 0; n < 500; ++n) {
    const Eigen::Matrix3d b1 = random_shape_of_volume<3>(random, 1, 4),
                          b2 = random_shape_of_volume<3>(random, 0.3, 4);
    Eigen::Vector3d d;
    Eigen::Matrix3d a;
    for (int i = 0; i < 3; ++i) d(i) = uniform(random, -2, 2);
    for (int i = 0; i < 9; ++i) a(i / 3, i % 3) = uniform(random, -1, 1);
    a += 2 * Eigen::Matrix3d::Identity();
    const double before = contact<3>(b1, b2, d);
    const double after = contact<3>(a * b1 * a.transpose(), a * b2 * a.transpose(), a * d);
    EXPECT_NEAR(after / before, 1.0, 1e-13 * 10);
  }
}

// Halves of a split parcel overlap: in the plane 2h = (√3/2) a with semi-axes a/2 each, F = 0.75;
// in space 2h = 2√(3/20) a = 0.7746 a, F = 0.60.
TEST(Contact, OfTheHalvesOfASplitParcel) {
  const double a = 1.3;
  EXPECT_NEAR((contact_function<2>({a * a / 4, 0, 0.2}, {a * a / 4, 0, 0.2},
                                   {std::sqrt(3.0) / 2 * a, 0}, no_limit)
                   .value),
              0.75, 1e-13);
  EXPECT_NEAR((contact_function<3>({a * a / 4, 0, 0, 0.3, 0, 0.2}, {a * a / 4, 0, 0, 0.3, 0, 0.2},
                                   {2 * std::sqrt(0.15) * a, 0, 0}, no_limit)
                   .value),
              0.60, 1e-13);
}

// The meaning of F: grown by √F about their centres the ellipsoids touch. Points of the one, grown,
// never lie deeper than touching in the other, and the point of contact lies on both.
TEST(Contact, IsTheGrowthAtWhichEllipsoidsTouch) {
  Random random(42);
  for (int n = 0; n < 200; ++n) {
    const Eigen::Matrix2d b1 = random_shape_of_volume<2>(random, 1, 4),
                          b2 = random_shape_of_volume<2>(random, 0.5, 4);
    const Eigen::Vector2d d(uniform(random, -2, 2), uniform(random, -2, 2));
    const double f = contact<2>(b1, b2, d);
    const Eigen::Matrix2d root = b1.llt().matrixL();
    double least = 1e300;
    for (int k = 0; k < 4000; ++k) {
      const double angle = 2 * std::numbers::pi * k / 4000;
      const Eigen::Vector2d x =
          std::sqrt(f) * root * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      least = std::min(least, (x - d).dot(b2.inverse() * (x - d)));
    }
    // The nearest of 4000 points misses the point of contact by up to 8e-4 of the angle.
    EXPECT_NEAR(least / f, 1.0, 2e-5);
    EXPECT_GE(least / f, 1.0 - 1e-9);
  }
}

TEST(Contact, StopsEarlyBeyondTheLimit) {
  const auto found = contact_function<3>({1, 0, 0, 1, 0, 1}, {1, 0, 0, 1, 0, 1}, {5, 0, 0}, 1.0);
  EXPECT_EQ(found.iterations, 1);
  EXPECT_GT(found.value, 1.0);
  EXPECT_EQ((contact_function<3>({1, 0, 0, 1, 0, 1}, {1, 0, 0, 1, 0, 1}, {0, 0, 0}, 1.0).value),
            0.0);
}

TEST(Neighbours, AreVisitedOnceOnAnyMesh) {
  for (const std::array<std::int64_t, 3>& n :
       {std::array<std::int64_t, 3>{1, 1, 1}, {2, 2, 2}, {3, 1, 5}, {7, 4, 2}}) {
    pileus_grid grid{};
    for (int a = 0; a < 3; ++a) grid.cells[a] = n[static_cast<std::size_t>(a)], grid.spacing[a] = 1;
    const overlap::Cells<3> cells(grid);
    for (std::int64_t i = 0; i < n[0]; ++i)
      for (std::int64_t j = 0; j < n[1]; ++j)
        for (std::int64_t k = 0; k < n[2]; ++k) {
          std::set<std::int64_t> expected, found;
          for (int di = -1; di <= 1; ++di)
            for (int dj = -1; dj <= 1; ++dj)
              for (int dk = -1; dk <= 1; ++dk)
                if (k + dk >= 0 && k + dk < n[2])
                  expected.insert((i + di + n[0]) % n[0] +
                                  n[0] * ((j + dj + n[1]) % n[1] + n[1] * (k + dk)));
          const std::int64_t centre[3] = {i, j, k};
          overlap::around(cells, centre, [&](std::int64_t cell) {
            EXPECT_TRUE(found.insert(cell).second) << "visited twice";
          });
          EXPECT_EQ(found, expected);
        }
  }
}

// ---- the exchange ---------------------------------------------------------------------------

// Two coinciding parcels relax to their mixture: the difference decays as exp(−kt) for any step.
TEST(Exchange, OfTwoParcelsIsExact) {
  const mesh::Grid<3> grid({6, 6, 6}, {0, 0, 0}, {6, 6, 6});
  for (const double dt : {0.1, 3.0, 50.0}) {
    MeshRun<3> run(grid, "org.pileus.overlap_exchange", {{"rate", "2"}}, {"passive_tracer"},
                   [](std::string_view, std::size_t) { return 0.25; });
    run.store.resize(2);
    for (int c = 0; c < run.store.column_count(); ++c) std::fill_n(run.store.column(c), 2, 0.0);
    for (std::size_t p = 0; p < 2; ++p) {
      run.store.uid()[p] = p + 1;
      run.store.volume()[p] = p == 0 ? 0.2 : 0.6;
      for (int d = 0; d < 3; ++d) run.store.position(d)[p] = 3.2;
      for (const int c : {0, 3, 5}) run.store.shape(c)[p] = 0.1;
    }
    run.bind();
    run.values("passive_tracer")[0] = 1.0;
    run.step(dt);
    const double part = -std::expm1(-2 * 0.25 * dt);
    EXPECT_NEAR(run.values("passive_tracer")[0], 1 - part * 0.6 / 0.8, 1e-15);
    EXPECT_NEAR(run.values("passive_tracer")[1], part * 0.2 / 0.8, 1e-15);
  }
}

/// Σ V φ to 1e-13, extrema to the last bit, for k dt up to 50 and many partners.
template <int D>
void expect_conserved_and_bounded(const mesh::Grid<D>& grid, double dt) {
  MeshRun<D> run(grid, "org.pileus.overlap_exchange", {{"margin", "0.2"}},
                 {"passive_tracer", "buoyancy"}, [](std::string_view, std::size_t node) {
                   return node % 11 == 0 ? 0.0 : 1.0 / static_cast<double>(1 + node % 3);
                 });
  run.fill(3000, 3, 43);
  run.bind();
  for (const char* name : {"passive_tracer", "buoyancy"}) {
    double* x = run.values(name);
    const auto before = amount(run.store, x);
    const double low = *std::min_element(x, x + 3000), high = *std::max_element(x, x + 3000);
    long double squares = 0, after_squares = 0;
    for (std::size_t p = 0; p < 3000; ++p) squares += run.store.volume()[p] * x[p] * x[p];
    if (std::string_view(name) == "passive_tracer") run.step(dt);
    if (std::string_view(name) == "buoyancy") {
      run.step(dt, 1);
    }
    const auto after = amount(run.store, x);
    EXPECT_LE(std::abs(static_cast<double>(after.first - before.first)),
              1e-13 * static_cast<double>(before.second));
    EXPECT_GE(*std::min_element(x, x + 3000), low);
    EXPECT_LE(*std::max_element(x, x + 3000), high);
    for (std::size_t p = 0; p < 3000; ++p) after_squares += run.store.volume()[p] * x[p] * x[p];
    EXPECT_LT(after_squares, squares);
  }
}
TEST(Exchange, ConservesAndKeepsExtrema) {
  for (const double dt : {0.1, 1.0, 50.0}) {
    expect_conserved_and_bounded<3>(mesh::Grid<3>({8, 7, 6}, {-1, 2, 0.5}, {0.8, 0.7, 0.6}), dt);
    expect_conserved_and_bounded<2>(mesh::Grid<2>({16, 20}, {-1, 2}, {1.6, 2}), dt);
    expect_conserved_and_bounded<3>(mesh::Grid<3>({2, 1, 2}, {0, 0, 0}, {2, 1, 2}), dt);
  }
}

TEST(Exchange, SameBitsForAnyNumberOfThreads) {
  const int before = omp_get_max_threads();
  std::vector<double> first;
  for (const int threads : {1, 2, 3}) {
    omp_set_num_threads(threads);
    MeshRun<3> run(
        mesh::Grid<3>({10, 10, 8}, {0, 0, 0}, {10, 10, 8}), "org.pileus.overlap_exchange", {},
        {"passive_tracer"},
        [](std::string_view, std::size_t node) { return 0.1 * static_cast<double>(node % 5); });
    run.fill(6000, 3, 44);
    run.bind();
    for (std::uint64_t n = 0; n < 2; ++n) run.step(1.0, n);
    const double* q = run.values("passive_tracer");
    const std::vector<double> now(q, q + run.store.size());
    if (first.empty()) first = now;
    EXPECT_EQ(first, now) << threads << " threads";
  }
  omp_set_num_threads(before);
}

}  // namespace
}  // namespace pileus::testing
