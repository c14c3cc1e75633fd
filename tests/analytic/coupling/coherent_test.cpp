// Coherent displacement: a random flow that is the curl of splines has no divergence and does not
// cross the walls; what it does to parcels follows from that. Means over n independent samples of
// a squared Gaussian are tested to 4 √(2/n).
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <numbers>

#include "../../../plugins/coherent_displacement/random_flow.hpp"
#include "../../unit/coupling/sampled_mesh.hpp"
#include "base/aligned_array.hpp"

namespace pileus::testing {
namespace {

constexpr const char* coherent_displacement = "org.pileus.coherent_displacement";
constexpr double pi = std::numbers::pi;

/// A flow of random node values, odd (A_z: even) about the walls.
template <int D>
struct AnyFlow {
  static constexpr int components = coherent::RandomFlow<D>::components;
  AnyFlow(const mesh::Grid<D>& grid, double amplitude, unsigned seed)
      : abi(coupling::abi_grid(grid)), potential(grid.nodes() * components) {
    Random random(seed);
    const int nz = grid.nz(), levels = grid.levels();
    for (std::size_t column = 0; column < grid.columns(); ++column)
      for (int c = 0; c < components; ++c) {
        const double sign = D == 2 || c < 2 ? -1 : 1;
        const auto at = [&](int k) -> double& {
          return potential[(column * static_cast<std::size_t>(levels) +
                            static_cast<std::size_t>(k + 1)) *
                               components +
                           static_cast<std::size_t>(c)];
        };
        for (int k = 0; k <= nz; ++k) at(k) = amplitude * uniform(random, -1, 1);
        if (sign < 0) at(0) = at(nz) = 0;
        at(-1) = sign * at(1);
        at(nz + 1) = sign * at(nz - 1);
      }
  }
  coherent::RandomFlow<D> flow() const { return {abi, potential.data()}; }
  pileus_grid abi;
  std::vector<double> potential;
};

template <int D>
mesh::Grid<D> oblong() {
  if constexpr (D == 3)
    return mesh::Grid<3>({5, 4, 6}, {-1, 2, 0.5}, {5, 3, 4.5});
  else
    return mesh::Grid<2>({7, 6}, {-1, 0.5}, {7, 4.5});
}

template <int D>
void expect_no_divergence_and_closed_walls() {
  const mesh::Grid<D> grid = oblong<D>();
  const AnyFlow<D> any(grid, 1, 71);
  const auto flow = any.flow();
  Random random(72);
  double largest = 0;
  for (int sample = 0; sample < 500; ++sample) {
    double x[D], ahead[D], behind[D], xi[D];
    for (int d = 0; d < D; ++d)
      x[d] = uniform(random, grid.lower[d] + 0.01, grid.lower[d] + grid.extent[d] - 0.01);
    flow.velocity(x, xi);
    for (const double v : xi) largest = std::max(largest, std::abs(v));
    const Matrix<D> g = flow.gradient(x);
    double trace = 0, norm = 0;
    for (int i = 0; i < D; ++i) trace += g[i * D + i];
    for (const double v : g) norm = std::max(norm, std::abs(v));
    EXPECT_LT(std::abs(trace), 1e-13 * norm);
    // ξ is piecewise quadratic along each direction: central differences are exact but where a
    // piece ends in between.
    constexpr double h = 1e-6;
    for (int j = 0; j < D; ++j) {
      double low[D], high[D];
      std::copy_n(x, D, low), std::copy_n(x, D, high);
      low[j] -= h, high[j] += h;
      flow.velocity(low, behind), flow.velocity(high, ahead);
      for (int i = 0; i < D; ++i)
        EXPECT_NEAR((ahead[i] - behind[i]) / (2 * h), g[i * D + j], 2e-5 * norm) << i << j;
    }
    for (const double wall : {grid.bottom(), grid.top()}) {
      x[D - 1] = wall;
      flow.velocity(x, xi);
      EXPECT_LT(std::abs(xi[D - 1]), 1e-14 * largest);
    }
  }
}
TEST(Coherent, FlowHasNoDivergenceAndDoesNotCrossTheWalls) {
  expect_no_divergence_and_closed_walls<2>();
  expect_no_divergence_and_closed_walls<3>();
}

/// Points around a centre end where the exponential of the gradient half-way takes them: the two
/// differ in the third order of the gradient, which is about 0.05 here.
template <int D>
void expect_consistent_deformation() {
  const mesh::Grid<D> grid = oblong<D>();
  const AnyFlow<D> any(grid, 0.01, 73);
  const auto flow = any.flow();
  Random random(74);
  int compared = 0;
  for (int sample = 0; sample < 200; ++sample) {
    double x[D], middle[D];
    for (int d = 0; d < D; ++d)
      x[d] = uniform(random, grid.lower[d] + 0.2, grid.lower[d] + grid.extent[d] - 0.2);
    double centre[D];
    std::copy_n(x, D, centre);
    coherent::follow<D>(flow, 1, centre, middle);
    // The gradient is piecewise constant across the middles of cells: paths inside one piece.
    bool inside = true;
    for (int d = 0; d < D; ++d) {
      const auto piece = [&](double at) {
        return std::floor((at - grid.lower[d]) / grid.spacing[d] + 0.5);
      };
      inside = inside && piece(x[d] - 1e-3) == piece(centre[d]) &&
               piece(x[d] + 1e-3) == piece(centre[d]);
    }
    if (!inside) continue;
    ++compared;
    const Matrix<D> e = exponential<D>(flow.gradient(middle));
    EXPECT_NEAR(determinant(e), 1, 1e-14);
    constexpr double h = 1e-4;
    for (int j = 0; j < D; ++j) {
      double low[D], high[D];
      std::copy_n(x, D, low), std::copy_n(x, D, high);
      low[j] -= h, high[j] += h;
      coherent::follow<D>(flow, 1, low, nullptr), coherent::follow<D>(flow, 1, high, nullptr);
      for (int i = 0; i < D; ++i)
        EXPECT_NEAR((high[i] - low[i]) / (2 * h), e[i * D + j], 2e-3) << sample;
    }
  }
  EXPECT_GT(compared, 150);
}
TEST(Coherent, DeformationIsThatOfTheDisplacement) {
  expect_consistent_deformation<2>();
  expect_consistent_deformation<3>();
}

// ---- the plugin ------------------------------------------------------------------------------

/// ⟨ΔX_i²⟩ = 2 K dt (Δ_i/Δ)² per call, ⟨ΔX_i⟩ = 0, with Δ the geometric mean of the spacings. Noise
/// is independent between calls and three cells apart: a mesh of N cells gives N/3^D samples a call
/// at least.
template <int D>
void expect_diffusivity(const mesh::Grid<D>& grid, int calls) {
  const double volume = grid.cell_volume(), width = std::pow(volume, 1.0 / D);
  constexpr double k = 0.02, dt = 0.5;
  MeshRun<D> run(
      grid, coherent_displacement,
      {{"intensity", "constant"}, {"diffusivity", std::to_string(k) + " m2/s"}, {"courant", "2"}},
      {}, [](std::string_view, std::size_t) { return 0.0; });
  const std::size_t count = 2000;
  run.fill(count, 1.0, 75);
  run.bind();
  std::array<double, D> square{}, mean{};
  Random random(76);
  for (int n = 0; n < calls; ++n) {
    // Anywhere, two cells from the walls at least.
    std::vector<double> before[D];
    for (int d = 0; d < D; ++d) {
      const double margin = d == D - 1 ? 2 * grid.spacing[d] : 0;
      for (std::size_t p = 0; p < count; ++p)
        run.store.position(d)[p] =
            uniform(random, grid.lower[d] + margin, grid.lower[d] + grid.extent[d] - margin);
      before[d].assign(run.store.position(d), run.store.position(d) + count);
    }
    run.sequence->population_changed();
    run.step(dt, static_cast<std::uint64_t>(n));
    for (int d = 0; d < D; ++d)
      for (std::size_t p = 0; p < count; ++p) {
        double moved = run.store.position(d)[p] - before[d][p];
        if (d < D - 1) moved -= grid.extent[d] * std::round(moved / grid.extent[d]);
        square[d] += moved * moved / (double(count) * calls);
        mean[d] += moved / (double(count) * calls);
      }
  }
  const double samples = calls * static_cast<double>(grid.cell_count()) / std::pow(3.0, D);
  for (int d = 0; d < D; ++d) {
    const double expected = 2 * k * dt * std::pow(grid.spacing[d] / width, 2);
    // Following the flow for a while shortens the way: by (dt|∇ξ|²) of a per cent here.
    EXPECT_NEAR(square[d] / expected, 1, 4 * std::sqrt(2 / samples) + 0.02) << d;
    EXPECT_NEAR(mean[d] / std::sqrt(expected), 0, 4 / std::sqrt(samples)) << d;
  }
}
TEST(Coherent, SpreadsAtTheGivenDiffusivity) {
  expect_diffusivity<2>(mesh::Grid<2>({24, 24}, {0, 0}, {24, 36}), 200);
  expect_diffusivity<3>(mesh::Grid<3>({10, 10, 12}, {0, 0, 0}, {10, 10, 12}), 100);
}

/// R.m.s. error of the volume fraction on the mesh after one displacement of 0.3 cells, of parcels
/// on a lattice.
double volume_error_after(const char* plugin, const Settings& settings) {
  const mesh::Grid<2> grid({16, 16}, {0, 0}, {16, 16});
  MeshRun<2> run(grid, plugin, settings, {}, [](std::string_view, std::size_t) { return 0.0; });
  run.fill(16 * 16 * 16, 1.0, 77);
  for (std::size_t p = 0; p < run.store.size(); ++p) {
    run.store.position(0)[p] = (static_cast<double>(p % 64) + 0.5) / 4;
    run.store.position(1)[p] = (static_cast<double>(p / 64) + 0.5) / 4;
    run.store.volume()[p] = 1.0 / 16;
    for (int c = 0; c < 3; ++c) run.store.shape(c)[p] = c == 1 ? 0 : 1.0 / (16 * pi);
  }
  run.bind();
  run.step(1);
  run.mesh.reorder();
  AlignedArray<double> field(grid.nodes() * 4);
  run.mesh.deposit({}, field.data());
  double sum = 0;
  for (std::size_t c = 0; c < grid.columns(); ++c)
    for (int k = 0; k <= 16; ++k) {
      const double error = field[grid.node(c, k) * 4] - 1;
      sum += error * error;
    }
  return std::sqrt(sum / static_cast<double>(grid.columns() * 17));
}

/// What crowds parcels is that neighbours are moved independently. A flow without divergence leaves
/// the volume correction next to nothing to undo.
TEST(Coherent, DoesNotCrowdParcels) {
  const double together = volume_error_after(
      coherent_displacement,
      {{"intensity", "constant"}, {"diffusivity", "0.045 m2/s"}, {"courant", "2"}});
  const double apart = volume_error_after(
      "org.pileus.langevin_mixing",
      {{"intensity", "profile"}, {"diffusivity", "0.045 m2/s"}, {"courant", "2"}});
  EXPECT_GT(apart, 0.02) << "0.3 cells apart, 16 parcels per cell";
  EXPECT_LT(together, 0.25 * apart);
}

/// Uniform stays uniform in any diffusivity, here K = K_0 (1 + 0.9 cos πz) up to K_0 t = 1: there
/// is no drift to get wrong. Shapes are left alone: nobody splits them. Twenty bins, χ²/19 of 2000
/// parcels.
TEST(Coherent, KeepsAUniformPopulationInVaryingDiffusivity) {
  const mesh::Grid<2> grid({8, 16}, {0, 0}, {0.5, 1});
  constexpr std::size_t count = 2000;
  MeshRun<2> run(grid, coherent_displacement,
                 {{"smagorinsky", "1"}, {"courant", "1"}, {"deform_shapes", "false"}}, {},
                 [&](std::string_view, std::size_t node) {
                   const int k = static_cast<int>(node % 19) - 1;
                   return 2.56 * (1 + 0.9 * std::cos(pi * std::clamp(k, 0, 16) / 16.0));
                 });
  run.fill(count, 1.0, 78);
  for (std::size_t p = 0; p < count; ++p)
    run.store.position(1)[p] = (static_cast<double>(p) + 0.5) / count;
  run.bind();
  for (std::uint64_t n = 0; n < 1000; ++n) run.step(0.1, n);  // K_0 = 2.56/16² = 0.01
  std::array<double, 20> bins{};
  for (std::size_t p = 0; p < count; ++p)
    bins[static_cast<std::size_t>(std::clamp(run.store.position(1)[p] * 20, 0.0, 19.0))] += 1;
  double chi_squared = 0;
  for (const double n : bins)
    chi_squared += (n - count / 20.0) * (n - count / 20.0) / (count / 20.0);
  EXPECT_LT(chi_squared / 19, 1 + 4 * std::sqrt(2.0 / 19));
}

TEST(Coherent, SameBitsForAnyNumberOfThreads) {
  const int before = omp_get_max_threads();
  std::vector<double> first;
  for (const int threads : {1, 2, 3}) {
    omp_set_num_threads(threads);
    MeshRun<3> run(mesh::Grid<3>({8, 8, 8}, {0, 0, 0}, {8, 8, 8}), coherent_displacement, {}, {},
                   [](std::string_view, std::size_t node) { return 0.1 * double(node % 5); });
    run.fill(5000, 2, 79);
    run.bind();
    for (std::uint64_t n = 0; n < 3; ++n) run.step(1.0, n);
    std::vector<double> now;
    for (int c = 0; c < run.store.first_scalar(); ++c)
      now.insert(now.end(), run.store.column(c), run.store.column(c) + run.store.size());
    if (first.empty()) first = now;
    EXPECT_EQ(first, now) << threads << " threads";
    for (std::size_t p = 0; p < run.store.size(); ++p)
      EXPECT_NEAR(
          get_shape<3>(run.store, p).determinant() / squared_axes_product<3>(run.store.volume()[p]),
          1, 2e-12);
  }
  omp_set_num_threads(before);
}

}  // namespace
}  // namespace pileus::testing
