// Grid nudging: the theorems on conservation, extrema and variance, the equivalent diffusivity, and
// the limit in which parcels take the gridded value. The relations and their numbers are derived in
// the plugin's README.
#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "../../../plugins/grid_nudging/nudging.hpp"
#include "../../unit/coupling/sampled_mesh.hpp"
#include "pileus/numerics.hpp"

namespace pileus::testing {
namespace {

constexpr const char* nudging = "org.pileus.grid_nudging";

/// β|S|dt between 0 and 50 with dt = 1 s and β = 1: pseudo-random over the nodes, many of them 0.
double random_strain(std::string_view, std::size_t node) {
  Random random(static_cast<unsigned>(node) * 7919u + 17u);
  const double u = uniform(random, 0, 1);
  return u < 0.1 ? 0.0 : std::pow(50.0, uniform(random, -1, 1));
}

template <int D>
mesh::Grid<D> test_grid() {
  if constexpr (D == 3)
    return mesh::Grid<3>({12, 10, 8}, {-1, 2, 0.5}, {1.2, 1, 0.8});
  else
    return mesh::Grid<2>({24, 16}, {-1, 0.5}, {1.2, 0.8});
}

struct Extrema {
  double low, high;
};
Extrema extrema(const double* x, std::size_t n) {
  return {*std::min_element(x, x + n), *std::max_element(x, x + n)};
}

template <int D>
long double variance(const parcels::Store& store, const double* x) {
  long double sum = 0;
  for (std::size_t p = 0; p < store.size(); ++p)
    sum += static_cast<long double>(store.volume()[p]) * x[p] * x[p];
  return sum;
}

/// Tests 1 and 2 of the scheme, on clouds that overhang the walls: each sum is a sum of n rounded
/// products, so its relative error is far below 1e-13; extrema hold to the last bit.
template <int D>
void expect_conserved_and_bounded(double spread, unsigned seed) {
  MeshRun<D> run(test_grid<D>(), nudging,
                 {{"beta", "1"}, {"mix_vorticity", "true"}, {"beta_vorticity", "1"}},
                 {"buoyancy", "passive_tracer", "total_water_mass_fraction"}, random_strain);
  run.fill(4000, spread, seed);
  double* water = run.values("total_water_mass_fraction");
  for (std::size_t p = 0; p < run.store.size(); ++p) water[p] = p % 5 == 0 ? 1e-3 : 0.0;
  run.bind();
  const int first = D + 1;  // volume is followed by the vorticity
  std::vector<int> columns;
  for (int c = 0; c < run.store.vorticity_components(); ++c) columns.push_back(first + c);
  for (int c = run.store.first_scalar(); c < run.store.column_count(); ++c) columns.push_back(c);
  for (std::uint64_t n = 0; n < 3; ++n) {
    std::vector<std::pair<long double, long double>> before;
    std::vector<Extrema> bounds;
    std::vector<long double> energy;
    for (const int c : columns) {
      before.push_back(amount(run.store, run.store.column(c)));
      bounds.push_back(extrema(run.store.column(c), run.store.size()));
      energy.push_back(variance<D>(run.store, run.store.column(c)));
    }
    run.step(1.0, n);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const double* x = run.store.column(columns[i]);
      const auto after = amount(run.store, x);
      EXPECT_LE(std::abs(static_cast<double>(after.first - before[i].first)),
                1e-13 * static_cast<double>(before[i].second))
          << run.store.column_name(columns[i]);
      const Extrema now = extrema(x, run.store.size());
      EXPECT_GE(now.low, bounds[i].low);
      EXPECT_LE(now.high, bounds[i].high);
      EXPECT_LT(now.high - now.low, bounds[i].high - bounds[i].low);  // it does mix
      EXPECT_LT(variance<D>(run.store, x), energy[i]);
    }
  }
}

TEST(GridNudging, ConservesAndKeepsExtremaForAnyStrainAndOverTheWalls) {
  for (const double spread : {1.5, 6.0}) {
    expect_conserved_and_bounded<3>(spread, 11);
    expect_conserved_and_bounded<2>(spread, 12);
  }
}

TEST(GridNudging, ConservesOnASingleLayerOfCells) {
  MeshRun<3> run(mesh::Grid<3>({4, 4, 1}, {0, 0, 0}, {4, 4, 1}), nudging, {{"beta", "1"}},
                 {"passive_tracer"}, random_strain);
  run.fill(300, 3, 13);
  run.bind();
  const auto before = amount(run.store, run.values("passive_tracer"));
  run.step(1.0);
  const auto after = amount(run.store, run.values("passive_tracer"));
  EXPECT_LE(std::abs(static_cast<double>(after.first - before.first)),
            1e-13 * static_cast<double>(before.second));
}

/// Test 3. A mean is a quotient of two sums of up to a few hundred terms with equal weights.
TEST(GridNudging, LeavesAConstantField) {
  MeshRun<3> run(test_grid<3>(), nudging, {{"beta", "1"}}, {"passive_tracer"}, random_strain);
  run.fill(4000, 4, 14);
  run.bind();
  double* q = run.values("passive_tracer");
  std::fill_n(q, run.store.size(), 287.3);
  run.step(1.0);
  for (std::size_t p = 0; p < run.store.size(); ++p) EXPECT_NEAR(q[p], 287.3, 287.3 * 1e-14);
}

/// Test 4. Point parcels, dense along x, sin(kx), uniform β|S|dt: a mode is multiplied by
/// 1 − f(1 − sinc⁴(kΔ/2)), to leading order 1 − f k²Δ²/6, that is K = β|S|Δ²/6 per direction. The
/// leading order is off by 0.3 %, 1.1 % and 4.5 % for 32, 16 and 8 points per wavelength.
TEST(GridNudging, ActsAsADiffusivityOnResolvedScales) {
  constexpr int dense = 64;  // parcels per cell along x
  const struct {
    int per_wavelength;
    double off;
  } cases[] = {{32, 0.003}, {16, 0.011}, {8, 0.045}};
  for (const auto& c : cases) {
    const mesh::Grid<2> grid({c.per_wavelength, 4}, {0, 0}, {double(c.per_wavelength), 4});
    const double dt = 0.05;
    MeshRun<2> run(grid, nudging, {{"beta", "1"}}, {"passive_tracer"},
                   [](std::string_view, std::size_t) { return 1.0; });
    const auto along = static_cast<std::size_t>(c.per_wavelength * dense);
    run.store.resize(along * 8);
    for (int col = 0; col < run.store.column_count(); ++col)  // new parcels are uninitialised
      std::fill_n(run.store.column(col), run.store.size(), 0.0);
    const double k = 2 * std::numbers::pi / c.per_wavelength;
    for (std::size_t p = 0; p < run.store.size(); ++p) {
      const double x = (static_cast<double>(p % along) + 0.5) / dense;
      run.store.uid()[p] = p + 1;
      run.store.position(0)[p] = x;
      run.store.position(1)[p] = 0.25 + 0.5 * static_cast<double>(p / along);
      run.store.volume()[p] = 1.0 / (2 * dense);
      for (const int s : {0, 2}) run.store.shape(s)[p] = 1e-10;
    }
    for (std::size_t p = 0; p < run.store.size(); ++p)
      run.values("passive_tracer")[p] = std::sin(k * run.store.position(0)[p]);
    run.bind();
    run.step(dt);
    double projection = 0, norm = 0;
    for (std::size_t p = 0; p < run.store.size(); ++p) {
      const double mode = std::sin(k * run.store.position(0)[p]);
      projection += mode * run.values("passive_tracer")[p];
      norm += mode * mode;
    }
    const double f = numerics::relaxed_part(dt);
    const double damped = (1 - projection / norm) / f;
    const double sinc = std::sin(0.5 * k) / (0.5 * k);
    // A row of 64 points stands for a continuum up to 1/64² of the tent's variance.
    EXPECT_NEAR(damped, 1 - std::pow(sinc, 4), 1e-3 * damped) << c.per_wavelength;
    EXPECT_NEAR(damped / (k * k / 6), 1 - c.off, 1.5e-3) << c.per_wavelength;
  }
}

/// Test 5. 1 − exp(−50) is 1 in double precision: parcels take the gridded mean at their support
/// points, against a deposit and an interpolation written as plain loops.
TEST(GridNudging, TakesTheGriddedValueInTheLimit) {
  const mesh::Grid<3> grid = test_grid<3>();
  MeshRun<3> run(grid, nudging, {{"beta", "1"}}, {"passive_tracer"},
                 [](std::string_view, std::size_t) { return 50.0; });
  run.fill(4000, 3, 15);
  run.bind();
  double* q = run.values("passive_tracer");
  const auto field = plain_deposit<3>(grid, run.store, {q});
  std::vector<double> expected(run.store.size(), 0.0);
  for (std::size_t p = 0; p < run.store.size(); ++p) {
    const auto points = support_points<3>(run.store, p);
    for (const auto& x : points)
      for (const auto& [node, w] : weights_around<3>(grid, x)) {
        const std::size_t column = node / static_cast<std::size_t>(grid.levels());
        const int k = static_cast<int>(node % static_cast<std::size_t>(grid.levels())) - 1;
        const int inside = k < 0 ? -k : k > grid.nz() ? 2 * grid.nz() - k : k;
        expected[p] +=
            w / static_cast<double>(points.size()) * field[grid.node(column, inside) * 8 + 1];
      }
  }
  run.step(1.0);
  // Rounding of the support points in units of a cell, times differences of order one.
  for (std::size_t p = 0; p < run.store.size(); ++p) EXPECT_NEAR(q[p], expected[p], 1e-10);
}

/// A profile that is linear between the reference's knots stays as it is, walls and uneven parcels
/// included, when perturbations from it are relaxed; otherwise it is diffused.
TEST(GridNudging, LeavesAStratifiedLayerWhenPerturbationsAreRelaxed) {
  const auto largest_change = [](const Settings& settings) {
    MeshRun<3> run(test_grid<3>(), nudging, settings, {"buoyancy"}, random_strain);
    run.fill(4000, 3, 16);
    run.bind();
    double* b = run.values("buoyancy");
    const double* z = run.store.position(2);
    for (std::size_t p = 0; p < run.store.size(); ++p) b[p] = z[p] < 0.9 ? 0 : 2 * (z[p] - 0.9);
    const std::vector<double> before(b, b + run.store.size());
    run.step(1.0);
    double change = 0;
    for (std::size_t p = 0; p < run.store.size(); ++p)
      change = std::max(change, std::abs(b[p] - before[p]));
    return change;
  };
  EXPECT_GT(largest_change({}), 1e-2);
  EXPECT_LT(largest_change({{"reference_height", "[0.5 m, 0.9 m, 1.3 m]"},
                            {"reference_buoyancy", "[0 m/s2, 0 m/s2, 0.8 m/s2]"}}),
            1e-15);
}

/// Two scalars on a mixing line stay on it: they are moved with the same weights.
TEST(GridNudging, KeepsLinearRelations) {
  MeshRun<2> run(test_grid<2>(), nudging, {},
                 {"liquid_water_potential_temperature", "total_water_mass_fraction"},
                 random_strain);
  run.fill(2000, 3, 17);
  run.bind();
  double* theta = run.values("liquid_water_potential_temperature");
  double* q = run.values("total_water_mass_fraction");
  for (std::size_t p = 0; p < run.store.size(); ++p) {
    q[p] = 0.01 * (1 + q[p]);
    theta[p] = 310 - 500 * q[p];
  }
  run.sequence->population_changed();
  run.step(1.0);
  for (std::size_t p = 0; p < run.store.size(); ++p)
    EXPECT_NEAR(theta[p], 310 - 500 * q[p], 310 * 1e-14);
}

TEST(GridNudging, SameBitsForAnyNumberOfThreads) {
  const int before = omp_get_max_threads();
  std::vector<double> first;
  for (const int threads : {1, 2, 3}) {
    omp_set_num_threads(threads);
    MeshRun<3> run(mesh::Grid<3>({24, 24, 8}, {0, 0, 0}, {24, 24, 8}), nudging, {},
                   {"passive_tracer"}, random_strain);
    run.fill(20000, 3, 18);
    run.bind();
    for (std::uint64_t n = 0; n < 2; ++n) run.step(0.1, n);
    const double* q = run.values("passive_tracer");
    const std::vector<double> now(q, q + run.store.size());
    if (first.empty()) first = now;
    EXPECT_EQ(first, now) << threads << " threads";
  }
  omp_set_num_threads(before);
}

TEST(GridNudging, WithoutStrainChangesNothing) {
  MeshRun<3> run(test_grid<3>(), nudging, {{"mix_vorticity", "true"}}, {"passive_tracer"},
                 [](std::string_view, std::size_t) { return 0.0; });
  run.fill(1000, 3, 19);
  run.bind();
  std::vector<std::vector<double>> before;
  for (int c = 0; c < run.store.column_count(); ++c)
    before.emplace_back(run.store.column(c), run.store.column(c) + run.store.size());
  run.step(1.0);
  for (int c = 0; c < run.store.column_count(); ++c)
    EXPECT_EQ(before[static_cast<std::size_t>(c)],
              std::vector<double>(run.store.column(c), run.store.column(c) + run.store.size()));
}

TEST(GridNudging, RefusesARunWithoutAMesh) {
  auto sequence = plugin_sequence(nudging, {{"beta", "1"}}, {"passive_tracer"});
  parcels::Store store(3, sequence->required_scalars());
  store.resize(1);
  EXPECT_THROW(sequence->bind(store, {}), Error);
}

}  // namespace
}  // namespace pileus::testing
