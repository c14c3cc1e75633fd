// Growth and dilution: the four-thirds law in the form of volumes, and what a grown parcel keeps
// when it splits and merges. The relations are those of the plugin's README.
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <numbers>

#include "../../../plugins/dilution/growth.hpp"
#include "../../unit/coupling/sampled_mesh.hpp"
#include "parcels/upkeep.hpp"

namespace pileus::testing {
namespace {

constexpr const char* dilution = "org.pileus.dilution";

// ---- the law ---------------------------------------------------------------------------------

/// dV_t/dt = c|S| V_c^{2/9} V_t^{7/9} in space, (2/3) c|S| A_c^{1/3} A_t^{2/3} in the plane, by the
/// classical Runge–Kutta scheme. Its error is far below 1e-10 in 200 steps.
template <int D>
double integrated(double size, double cell, double rate, double strain, double end) {
  const auto growth = [&](double v) {
    return D == 3 ? rate * strain * std::pow(cell, 2.0 / 9) * std::pow(v, 7.0 / 9)
                  : 2.0 / 3 * rate * strain * std::cbrt(cell) * std::pow(v, 2.0 / 3);
  };
  const double dt = end / 200;
  for (int step = 0; step < 200; ++step) {
    const double k1 = growth(size), k2 = growth(size + 0.5 * dt * k1),
                 k3 = growth(size + 0.5 * dt * k2), k4 = growth(size + dt * k3);
    size += dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  return size;
}

template <int D>
void expect_law() {
  constexpr double cell = 7, rate = 2, strain = 0.05;
  for (const double start : {0.05 * cell, 0.125 * cell, 0.5 * cell})
    for (const double end : {0.1, 1.0, 5.0}) {
      const double grown = dilution::grown_volume<D>(start, cell, rate, strain, end);
      const double expected = integrated<D>(start, cell, rate, strain, end);
      EXPECT_NEAR(grown / expected, 1, 1e-10) << start << " " << end;
      // Exact: two steps are one of their length, to the rounding of two powers.
      const double half = dilution::grown_volume<D>(start, cell, rate, strain, 0.5 * end);
      EXPECT_NEAR(dilution::grown_volume<D>(half, cell, rate, strain, 0.5 * end) / grown, 1, 1e-14);
    }
}
TEST(Dilution, GrowsByTheFourThirdsLaw) {
  expect_law<3>();
  expect_law<2>();
}

/// Richardson's law: the radius grows at (c|S|/3) R^{2/3} r^{1/3}, whatever the dimension, so that
/// r^{2/3} gains (2/9) c|S|t of R^{2/3}. An eighth of a cell fills it after
/// c|S|t = (9/2) (1 − 8^{−2/9}) = 1.6652 in space.
TEST(Dilution, FillsACellInAKnownTime) {
  const double time = 4.5 * (1 - std::pow(8.0, -2.0 / 9));
  EXPECT_NEAR(time, 1.6652, 1e-4);
  EXPECT_NEAR(dilution::grown_volume<3>(0.125, 1, 2, 0.1, 0.999999 * time / 0.2), 1, 1e-5);
  EXPECT_EQ(dilution::grown_volume<3>(0.125, 1, 2, 0.1, 1.000001 * time / 0.2), 1);
}

TEST(Dilution, EndsAtTheCellForAnyStepAndShrinksNothing) {
  for (const double dt : {1e-12, 1.0, 1e6, 1e300}) {
    const double grown = dilution::grown_volume<3>(0.3, 1, 100, 50, dt);
    EXPECT_GE(grown, 0.3);
    EXPECT_LE(grown, 1);
    EXPECT_EQ(dilution::grown_volume<3>(1.7, 1, 100, 50, dt), 1.7) << "larger than the cell";
    EXPECT_EQ(dilution::grown_volume<3>(0.3, 1, 2, 0, dt), 0.3) << "no strain";
    EXPECT_EQ(dilution::grown_volume<3>(0.3, 1, 0, 1, dt), 0.3) << "no rate";
  }
}

// ---- the plugin ------------------------------------------------------------------------------

template <int D>
long double largest_shape_error(const parcels::Store& store) {
  long double largest = 0;
  for (std::size_t p = 0; p < store.size(); ++p) {
    const double expected = squared_axes_product<D>(store.size_volume()[p]);
    largest = std::max(
        largest,
        std::abs(static_cast<long double>(get_shape<D>(store, p).determinant()) / expected - 1));
  }
  return largest;
}

/// Sizes start as the volumes and grow with the strain at the parcel; shapes keep their form and
/// what the parcel holds stays as it is, to the bit.
template <int D>
void expect_growth(const mesh::Grid<D>& grid) {
  MeshRun<D> run(grid, dilution, {{"rate", "2"}}, {"passive_tracer"},
                 [](std::string_view, std::size_t) { return 0.25; });
  run.fill(1000, 2, 51);
  run.bind();
  const parcels::Store& store = run.store;
  ASSERT_TRUE(store.carries_size());
  const std::size_t n = store.size();
  const std::vector<double> volume(store.volume(), store.volume() + n);
  const std::vector<double> tracer(run.values("passive_tracer"), run.values("passive_tracer") + n);
  EXPECT_EQ(volume, std::vector<double>(store.size_volume(), store.size_volume() + n));
  std::vector<Eigen::Matrix<double, D, D>> shape;
  for (std::size_t p = 0; p < n; ++p) shape.push_back(get_shape<D>(store, p));
  run.step(0.5);
  EXPECT_EQ(volume, std::vector<double>(store.volume(), store.volume() + n));
  EXPECT_EQ(tracer,
            std::vector<double>(run.values("passive_tracer"), run.values("passive_tracer") + n));
  for (std::size_t p = 0; p < n; ++p) {
    // The strain is interpolated with weights that sum to one to rounding.
    const double expected = integrated<D>(volume[p], grid.cell_volume(), 2, 0.25, 0.5);
    const double size = store.size_volume()[p];
    EXPECT_NEAR(size / std::min(expected, grid.cell_volume()), 1, 1e-10);
    const double factor = std::pow(size / volume[p], 2.0 / D);
    EXPECT_LT((get_shape<D>(store, p) - factor * shape[p]).norm(), 1e-13 * shape[p].norm());
  }
  // A determinant of axes up to 2 : 1/2 keeps its digits but for a few.
  EXPECT_LT(largest_shape_error<D>(store), 1e-12);
}
TEST(Dilution, EnlargesShapesAndNothingElse) {
  expect_growth<3>(mesh::Grid<3>({8, 8, 8}, {0, 0, 0}, {8, 6, 4}));
  expect_growth<2>(mesh::Grid<2>({20, 20}, {0, 0}, {20, 16}));
}

/// Σ V.
long double total_volume(const parcels::Store& store) {
  long double sum = 0;
  for (std::size_t p = 0; p < store.size(); ++p) sum += store.volume()[p];
  return sum;
}

/// Growing, splitting and merging many times over: volume and amounts stay to 1e-13, extrema are
/// never exceeded, no shape is smaller than what its parcel holds, and each has its size's volume.
/// Parcels lie over the walls throughout.
template <int D>
void expect_laws_of_a_long_life(const mesh::Grid<D>& grid, std::size_t count) {
  MeshRun<D> run(grid, dilution, {{"rate", "2"}}, {"passive_tracer"},
                 [](std::string_view, std::size_t node) { return 0.1 * double(node % 4); });
  run.fill(count, 2, 52);
  run.bind();
  const parcels::Tiling<D> tiling(grid);
  parcels::Upkeep<D> upkeep(grid, tiling, grid.cell_volume() / 20,
                            parcels::SplitCriterion<D>::make(grid, 4, 2.89));
  parcels::SupportOffsets<D> offsets;
  PhaseTimes times;
  const auto before = amount(run.store, run.values("passive_tracer"));
  const long double volume = total_volume(run.store);
  std::uint64_t splits = 0, merged = 0;
  for (std::uint64_t n = 0; n < 40; ++n) {
    run.step(1.0, n);
    const auto counts = upkeep.run(run.store, offsets, n, times);
    run.mesh.reorder();
    run.sequence->population_changed();
    splits += counts.splits;
    merged += counts.merges.merged;
    const double *size = run.store.size_volume(), *held = run.store.volume();
    for (std::size_t p = 0; p < run.store.size(); ++p) EXPECT_GE(size[p], held[p] * (1 - 1e-13));
    EXPECT_LT(largest_shape_error<D>(run.store), 1e-10);
  }
  const auto after = amount(run.store, run.values("passive_tracer"));
  EXPECT_LE(std::abs(static_cast<double>(after.first - before.first)),
            1e-13 * static_cast<double>(before.second));
  EXPECT_LE(std::abs(static_cast<double>(total_volume(run.store) / volume - 1)), 1e-13);
  const double* q = run.values("passive_tracer");
  EXPECT_GE(*std::min_element(q, q + run.store.size()), -1);
  EXPECT_LE(*std::max_element(q, q + run.store.size()), 1);
  EXPECT_GT(splits, count) << "growth makes parcels split";
  EXPECT_GT(merged, count / 2) << "and what has been split becomes small and merges";
}
TEST(Dilution, KeepsItsLawsThroughManySplitsAndMergers) {
  expect_laws_of_a_long_life<3>(mesh::Grid<3>({6, 6, 6}, {0, 0, 0}, {6, 6, 6}), 1700);
  expect_laws_of_a_long_life<2>(mesh::Grid<2>({12, 12}, {0, 0}, {12, 12}), 1200);
}

TEST(Dilution, SameBitsForAnyNumberOfThreads) {
  const int before = omp_get_max_threads();
  std::vector<double> first;
  for (const int threads : {1, 2, 3}) {
    omp_set_num_threads(threads);
    MeshRun<3> run(mesh::Grid<3>({8, 8, 8}, {0, 0, 0}, {8, 8, 8}), dilution, {}, {},
                   [](std::string_view, std::size_t node) { return 0.1 * double(node % 5); });
    run.fill(5000, 2, 53);
    run.bind();
    for (std::uint64_t n = 0; n < 3; ++n) run.step(0.3, n);
    std::vector<double> now(run.store.size_volume(), run.store.size_volume() + run.store.size());
    for (int c = 0; c < 6; ++c)
      now.insert(now.end(), run.store.shape(c), run.store.shape(c) + run.store.size());
    if (first.empty()) first = now;
    EXPECT_EQ(first, now) << threads << " threads";
  }
  omp_set_num_threads(before);
}

}  // namespace
}  // namespace pileus::testing
