// Stochastic displacement against exact moments and the well-mixed criterion. A histogram of n
// particles in 20 bins is judged by χ²/19, whose mean is 1 and whose standard deviation is
// √(2/19) = 0.32 for a uniform population: four of them are allowed. Means are tested to four
// standard errors.
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <map>
#include <numbers>

#include "../../../plugins/langevin_mixing/displacement.hpp"
#include "../../unit/coupling/sampled_mesh.hpp"
#include "parcels/correction.hpp"
#include "pileus/normal.hpp"

namespace pileus::testing {
namespace {

using langevin::Local;
constexpr double pi = std::numbers::pi;
constexpr double uniform_enough = 1 + 4 * 0.3244428;

void draw(std::uint64_t particle, std::uint64_t step, std::uint32_t n, double* out) {
  pileus_step at{};
  at.seed = 9;
  at.number = step;
  draw_normal(at, particle, 0, n, out);
}

/// Heights in [0, 1] counted in 20 bins.
struct Histogram {
  std::array<double, 20> count{};
  double n = 0;
  void add(double z) {
    count[static_cast<std::size_t>(std::clamp(z * 20, 0.0, 19.0))] += 1;
    n += 1;
  }
  double chi_squared() const {
    double sum = 0;
    for (const double c : count) sum += (c - n / 20) * (c - n / 20) / (n / 20);
    return sum / 19;
  }
};

TEST(Normal, DrawsHaveTheMomentsOfTheDistribution) {
  constexpr int n = 200000;
  double sum = 0, second = 0, fourth = 0, product = 0;
  for (int i = 0; i < n; ++i) {
    double x[3];
    draw(static_cast<std::uint64_t>(i), 0, 3, x);
    sum += x[2], second += x[0] * x[0], fourth += std::pow(x[1], 4), product += x[0] * x[1];
  }
  // Standard errors: 1, √2, √96, 1 over √n.
  const double unit = 4 / std::sqrt(double(n));
  EXPECT_NEAR(sum / n, 0, unit);
  EXPECT_NEAR(second / n, 1, std::sqrt(2.0) * unit);
  EXPECT_NEAR(fourth / n, 3, std::sqrt(96.0) * unit);
  EXPECT_NEAR(product / n, 0, unit);
}

// Test 1: without bounds and with constant K, ⟨ΔX²⟩ = 2Kt with kurtosis 3.
TEST(Brownian, SpreadsAsTwiceTheDiffusivity) {
  constexpr int n = 100000, steps = 5;
  constexpr double k = 0.7, dt = 0.3;
  double second = 0, fourth = 0;
  for (int particle = 0; particle < n; ++particle) {
    double x = 0;
    for (int step = 0; step < steps; ++step) {
      double normal, shift;
      draw(static_cast<std::uint64_t>(particle), static_cast<std::uint64_t>(step), 1, &normal);
      langevin::brownian_displacement<1>({k, {0}}, dt, &normal, &shift);
      x += shift;
    }
    second += x * x / n, fourth += std::pow(x, 4) / n;
  }
  const double expected = 2 * k * dt * steps;
  EXPECT_NEAR(second / expected, 1, 4 * std::sqrt(2.0 / n));
  EXPECT_NEAR(fourth / (expected * expected), 3, 4 * std::sqrt(96.0 / n));
}

/// K(z) = 1 + 0.9 cos πz on [0, 1], reflecting, from a uniform population of 1e5, K₀dt = 5e-4,
/// K₀t = 1.
Histogram spread_in_varying_diffusivity(bool with_drift) {
  constexpr int n = 100000, at_once = 16, steps = 2000;
  constexpr double dt = 5e-4;
  Histogram histogram;
  for (int particle = 0; particle < n; ++particle) {
    double z = (particle + 0.5) / n, normal[at_once];
    for (int step = 0; step < steps; ++step) {
      if (step % at_once == 0)
        draw(static_cast<std::uint64_t>(particle), static_cast<std::uint64_t>(step), at_once,
             normal);
      const Local<1> k{1 + 0.9 * std::cos(pi * z),
                       {with_drift ? -0.9 * pi * std::sin(pi * z) : 0.0}};
      double shift;
      langevin::brownian_displacement<1>(k, dt, &normal[step % at_once], &shift);
      bool turned;
      z = langevin::reflected(z + shift, 0, 1, turned);
    }
    histogram.add(z);
  }
  return histogram;
}

// Test 2: what is uniform stays so. A bin holds 5000 ± 71, so that of twenty the fullest and the
// emptiest differ by 3.7 standard deviations on average, a ratio of 1.054; six are allowed.
TEST(Brownian, KeepsAUniformPopulationInVaryingDiffusivity) {
  const Histogram h = spread_in_varying_diffusivity(true);
  EXPECT_LT(h.chi_squared(), uniform_enough);
  const auto [least, most] = std::minmax_element(h.count.begin(), h.count.end());
  EXPECT_LT(*most / *least, 1 + 6 / std::sqrt(5000.0));
}

// Without the drift the density becomes 1/K, a ratio of 19 from wall to wall. Means of 1/K over the
// bins follow from ∫ dz/(1 + a cos πz) = 2/(π √(1−a²)) atan(√((1−a)/(1+a)) tan(πz/2)): a ratio of
// 18.3 between the outermost and χ²/19 = 6759.
TEST(Brownian, WithoutTheDriftParcelsGatherWhereTheDiffusivityIsSmall) {
  const Histogram h = spread_in_varying_diffusivity(false);
  const auto antiderivative = [](double z) {
    return z < 1 ? std::atan(std::sqrt(0.1 / 1.9) * std::tan(pi * z / 2)) / (pi / 2) : 1.0;
  };
  double chi_squared = 0;
  for (int bin = 0; bin < 20; ++bin) {
    const double part = antiderivative((bin + 1) / 20.0) - antiderivative(bin / 20.0);
    chi_squared += h.n * 20 * std::pow(part - 0.05, 2) / 19;
    // The scheme's error is of the order of π²K₀dt = 0.005.
    EXPECT_NEAR(h.count[static_cast<std::size_t>(bin)] / (h.n * part), 1,
                0.02 + 4 / std::sqrt(h.n * part))
        << bin;
  }
  EXPECT_NEAR(h.chi_squared() / chi_squared, 1, 0.05);
}

// Test 4: the velocity's variance and memory, and the path ⟨ΔX²⟩ = 2σ²T[t − T(1 − e^{−t/T})].
TEST(Langevin, IsTheOrnsteinUhlenbeckProcessInAHomogeneousField) {
  constexpr int n = 40000, steps = 40;
  constexpr double sigma = 1.7, time_scale = 0.5, dt = 0.05;
  double velocity = 0, memory = 0, path = 0;
  for (int particle = 0; particle < n; ++particle) {
    double x = 0, w, normal[2];
    draw(static_cast<std::uint64_t>(particle), 1000, 1, &w);
    const double start = w;
    for (int step = 0; step < steps; ++step) {
      draw(static_cast<std::uint64_t>(particle), static_cast<std::uint64_t>(step), 2, normal);
      langevin::langevin_step<1>(
          &x, &w, dt,
          [&](const double*) {
            return Local<1>{sigma, {0}};
          },
          [&](const double*) { return time_scale; }, normal);
      if (step == 9) memory += start * w / n;  // t = T
    }
    velocity += w * w / n, path += x * x / n;
  }
  EXPECT_NEAR(velocity, 1, 4 * std::sqrt(2.0 / n));
  EXPECT_NEAR(memory, std::exp(-1.0), 4 * std::sqrt((1 + std::exp(-2.0)) / n));
  const double t = dt * steps;
  const double expected =
      2 * sigma * sigma * time_scale * (t - time_scale * (1 - std::exp(-t / time_scale)));
  // The midpoint in the middle of two exact halves errs by (dt/T)²/12 = 0.1 %.
  EXPECT_NEAR(path / expected, 1, 4 * std::sqrt(2.0 / n) + 1e-3);
}

/// σ²(z) = 1 + 0.8 sin πz on [0, 1], reflecting, T = 0.2, to t = 3.
struct Inhomogeneous {
  Histogram histogram;
  std::array<double, 20> energy{};  // Σ U²/σ² per bin
};
Inhomogeneous move_in_varying_variance(bool with_drift, int n) {
  constexpr double dt = 0.01, time_scale = 0.2;
  const auto inside = [&](const double* z) {
    const double sigma = std::sqrt(1 + 0.8 * std::sin(pi * *z));
    const double slope = 0.4 * pi * std::cos(pi * *z) / sigma;
    return Local<1>{sigma, {with_drift ? slope : 0.0}};
  };
  const auto sigma = [&](const double* z) { return langevin::even_at_walls<1>(inside, z, 0, 1); };
  Inhomogeneous result;
  for (int particle = 0; particle < n; ++particle) {
    double z = (particle + 0.5) / n, w;
    draw(static_cast<std::uint64_t>(particle), 100000, 1, &w);
    for (int step = 0; step < 300; ++step) {
      double normal[2];
      draw(static_cast<std::uint64_t>(particle), static_cast<std::uint64_t>(step), 2, normal);
      langevin::langevin_step<1>(
          &z, &w, dt, sigma, [&](const double*) { return time_scale; }, normal);
      bool turned;
      z = langevin::reflected(z, 0, 1, turned);
      if (turned) w = -w;
    }
    result.histogram.add(z);
    result.energy[static_cast<std::size_t>(std::clamp(z * 20, 0.0, 19.0))] += w * w;
  }
  return result;
}

// Test 5: Thomson's well-mixed criterion in an inhomogeneous field, for position and velocity.
TEST(Langevin, KeepsAUniformPopulationInVaryingVariance) {
  const Inhomogeneous run = move_in_varying_variance(true, 40000);
  EXPECT_LT(run.histogram.chi_squared(), uniform_enough);
  for (std::size_t bin = 0; bin < 20; ++bin) {
    const double n = run.histogram.count[bin];
    EXPECT_NEAR(run.energy[bin] / n, 1, 4.5 * std::sqrt(2 / n)) << bin;
  }
}
TEST(Langevin, WithoutTheDriftParcelsGatherWhereTheVarianceIsSmall) {
  const Inhomogeneous run = move_in_varying_variance(false, 40000);
  EXPECT_GT(run.histogram.chi_squared(), 10);
  const auto [least, most] =
      std::minmax_element(run.histogram.count.begin(), run.histogram.count.end());
  EXPECT_LT(*least, 0.92 * 2000) << "the density falls to 0.87 of the uniform one";
  EXPECT_GT(*most, 1.12 * 2000) << "and rises to 1.18";
}

// ---- the plugin -----------------------------------------------------------------------------

std::string list_of(int points, const std::function<std::string(double)>& text) {
  std::string list = "[";
  for (int i = 0; i < points; ++i)
    list += (i > 0 ? ", " : "") + text(static_cast<double>(i) / (points - 1));
  return list + "]";
}
Settings varying_diffusivity() {
  return {{"model", "brownian"},
          {"intensity", "profile"},
          {"profile_height", list_of(65, [](double z) { return std::to_string(z) + " m"; })},
          {"diffusivity", list_of(65, [](double z) {
             return std::to_string(0.01 * (1 + 0.9 * std::cos(pi * z))) + " m2/s";
           })}};
}

struct PluginCloud {
  Histogram histogram;
  double horizontal_spread = 0;  // ⟨ΔX²⟩/(2⟨K⟩t)
};

/// A plane of 16² cells with eight round parcels in each, K(z) = 0.01 (1 + 0.9 cos πz).
PluginCloud run_plugin(bool with_correction) {
  const mesh::Grid<2> grid({16, 16}, {0, 0}, {1, 1});
  MeshRun<2> run(grid, "org.pileus.langevin_mixing", varying_diffusivity(), {},
                 [](std::string_view, std::size_t) { return 0.0; });
  run.fill(2048, 1.0, 31);
  for (std::size_t p = 0; p < 2048; ++p) run.store.volume()[p] = 1.0 / 2048;
  run.bind();
  parcels::Deposit<2> deposit(grid);
  parcels::Upkeep<2> upkeep(grid, deposit.tiling(), 0,
                            parcels::SplitCriterion<2>::make(grid, 4, 2.89));
  parcels::VolumeCorrection<2> correction(grid, {2, 1.8, 0.5});
  parcels::SupportOffsets<2> offsets;
  PhaseTimes times;
  constexpr double dt = 0.02;
  constexpr std::uint64_t steps = 1000;
  std::map<std::uint64_t, double> travelled;
  for (std::uint64_t n = 0; n < steps; ++n) {
    std::map<std::uint64_t, double> before;
    for (std::size_t p = 0; p < run.store.size(); ++p)
      before[run.store.uid()[p]] = run.store.position(0)[p];
    run.step(dt, n);
    upkeep.reorder(run.store, offsets, times);
    if (with_correction) {
      offsets.update(run.store);
      correction.run(run.store, offsets, upkeep.tile_begin(), deposit);
    }
    run.sequence->population_changed();
    for (std::size_t p = 0; p < run.store.size(); ++p) {
      const double moved = run.store.position(0)[p] - before.at(run.store.uid()[p]);
      travelled[run.store.uid()[p]] += moved - std::round(moved);
    }
  }
  PluginCloud result;
  for (std::size_t p = 0; p < run.store.size(); ++p) result.histogram.add(run.store.position(1)[p]);
  for (const auto& [uid, x] : travelled)
    result.horizontal_spread += x * x / (2 * 0.01 * dt * steps) / 2048;
  return result;
}

// Test 3: the volume correction moves parcels back where the noise has crowded them. The population
// stays uniform, more evenly than chance would have it, and spreads at a rate that 2048 parcels do
// not tell from that without the correction.
TEST(Brownian, KeepsAUniformPopulationTogetherWithTheVolumeCorrection) {
  const PluginCloud free = run_plugin(false), corrected = run_plugin(true);
  EXPECT_LT(free.histogram.chi_squared(), uniform_enough);
  EXPECT_LT(corrected.histogram.chi_squared(), 0.5 * free.histogram.chi_squared());
  EXPECT_NEAR(free.horizontal_spread, 1, 4 * std::sqrt(2.0 / 2048));
  EXPECT_NEAR(corrected.horizontal_spread, free.horizontal_spread, 4 * std::sqrt(2.0 / 2048));
  RecordProperty("effective_diffusivity_ratio",
                 std::to_string(corrected.horizontal_spread / free.horizontal_spread));
}

/// With the strain of the mesh: K = (C_s Δ)²|S| and its gradient from the nodes' values.
TEST(Brownian, KeepsAUniformPopulationInADiffusivityFromTheMesh) {
  const mesh::Grid<2> grid({8, 16}, {0, 0}, {0.5, 1});
  MeshRun<2> run(grid, "org.pileus.langevin_mixing", {{"smagorinsky", "1"}}, {},
                 [&](std::string_view, std::size_t node) {
                   const int k = static_cast<int>(node % 19) - 1;
                   return 2.5 * (1 + 0.9 * std::cos(pi * std::clamp(k, 0, 16) / 16.0));
                 });
  run.fill(8000, 1.0, 32);
  for (std::size_t p = 0; p < 8000; ++p)
    run.store.position(1)[p] = (static_cast<double>(p) + 0.5) / 8000;
  run.bind();
  for (std::uint64_t n = 0; n < 500; ++n) run.step(0.1, n);
  Histogram histogram;
  for (std::size_t p = 0; p < 8000; ++p) histogram.add(run.store.position(1)[p]);
  EXPECT_LT(histogram.chi_squared(), uniform_enough);
}

/// A new parcel's velocity has unit variance, a merged one's again after the next call; halves of a
/// split keep theirs.
TEST(Langevin, RestoresTheVarianceThatMergingTakes) {
  const mesh::Grid<3> grid({8, 8, 8}, {0, 0, 0}, {8, 8, 8});
  MeshRun<3> run(grid, "org.pileus.langevin_mixing",
                 {{"model", "langevin"},
                  {"intensity", "profile"},
                  {"velocity_variance", "1e-12 m2/s2"},
                  {"time_scale", "1e9 s"}},
                 {}, [](std::string_view, std::size_t) { return 0.0; });
  run.fill(20000, 1.0, 33);
  run.bind();
  run.step(1.0, 0);
  const auto w = [&] { return run.values("x_normalised_turbulent_velocity"); };
  const auto weight = [&] { return run.values("turbulent_velocity_weight"); };
  const auto variance = [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t p = begin; p < end; ++p) sum += w()[p] * w()[p];
    return sum / static_cast<double>(end - begin);
  };
  EXPECT_NEAR(variance(0, 20000), 1, 4 * std::sqrt(2.0 / 20000));
  // Parcels 0 … 9999 take in one of the others each, in parts μ : 1 − μ, as a merge does it.
  const std::vector<double> kept(w() + 15000, w() + 20000);
  for (std::size_t p = 0; p < 5000; ++p) {
    const double v = run.store.volume()[p], other = run.store.volume()[p + 5000];
    w()[p] = (v * w()[p] + other * w()[p + 5000]) / (v + other);
    weight()[p] += weight()[p + 5000];
    run.store.volume()[p] = v + other;
  }
  for (std::size_t p = 15000; p < 20000; ++p) run.store.volume()[p] *= 0.5, weight()[p] *= 0.5;
  EXPECT_LT(variance(0, 5000), 0.75);
  run.sequence->population_changed();
  run.step(1.0, 1);
  EXPECT_NEAR(variance(0, 5000), 1, 4 * std::sqrt(2.0 / 5000));
  // dt/T = 1e-9: what is not drawn anew has changed by √(2e-9) at most five times over.
  for (std::size_t p = 0; p < 5000; ++p) EXPECT_NEAR(w()[15000 + p], kept[p], 3e-4);
}

TEST(Langevin, SameBitsForAnyNumberOfThreads) {
  const int before = omp_get_max_threads();
  std::vector<double> first;
  for (const int threads : {1, 2, 3}) {
    omp_set_num_threads(threads);
    MeshRun<3> run(mesh::Grid<3>({8, 8, 8}, {0, 0, 0}, {8, 8, 8}), "org.pileus.langevin_mixing",
                   {{"model", "langevin"}}, {}, [](std::string_view, std::size_t node) {
                     return 0.01 * static_cast<double>(node % 7);
                   });
    run.fill(5000, 2, 34);
    run.bind();
    for (std::uint64_t n = 0; n < 3; ++n) run.step(1.0, n);
    std::vector<double> now;
    for (int d = 0; d < 3; ++d)
      now.insert(now.end(), run.store.position(d), run.store.position(d) + run.store.size());
    if (first.empty()) first = now;
    EXPECT_EQ(first, now) << threads << " threads";
  }
  omp_set_num_threads(before);
}

}  // namespace
}  // namespace pileus::testing
