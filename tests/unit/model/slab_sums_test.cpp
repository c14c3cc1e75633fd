// Moments of slabs: analytic fields on lattices, cloud of a known share, the same bits for any
// number of threads.
#include "model/slab_sums.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "base/parallel.hpp"

namespace pileus::model {
namespace {

constexpr double pi = std::numbers::pi;
constexpr std::size_t across = 64, per_level = 64, levels = 9;  // of parcels, of parcels, of nodes
constexpr double height = 2.0, spacing = height / (levels - 1);

/// Parcels on a lattice in the plane over one period (2π) in x and the given fields of x and z: w,
/// buoyancy, liquid water and one more.
class Lattice {
 public:
  using Field = std::function<double(double x, double z)>;

  Lattice(const Field& w, const Field& buoyancy, const Field& liquid, const Field& other) {
    const std::size_t up = per_level * (levels - 1);
    for (std::size_t k = 0; k < up; ++k)
      for (std::size_t i = 0; i < across; ++i) {
        const double x = 2 * pi * (static_cast<double>(i) + 0.5) / across;
        const double z = height * (static_cast<double>(k) + 0.5) / static_cast<double>(up);
        z_.push_back(z);
        volume_.push_back(2 * pi * height / static_cast<double>(up * across));
        w_.push_back(w(x, z));
        buoyancy_.push_back(buoyancy(x, z));
        liquid_.push_back(liquid(x, z));
        other_.push_back(other(x, z));
      }
  }

  SlabSums measured() const {
    SlabLayout layout;
    layout.variables = 4;
    layout.vertical = 0;
    layout.buoyancy = 1;
    layout.of_sets = {0, 2};
    layout.has_sets = true;
    SlabSums sums(layout, levels);
    SlabState state;
    state.parcels = z_.size();
    state.bottom = 0;
    state.spacing = spacing;
    state.height = z_.data();
    state.volume = volume_.data();
    state.variables = {w_.data(), buoyancy_.data(), liquid_.data(), other_.data()};
    state.liquid = liquid_.data();
    state.cloud_threshold = 0.5;
    sums.measure(state);
    return sums;
  }

 private:
  std::vector<double> z_, volume_, w_, buoyancy_, liquid_, other_;
};

double nothing(double, double) {
  return 0;
}

/// Mean of cos(mz) over the tent of an inner level: cos(m z_k) (sin(mh/2)/(mh/2))².
double tent_of_cosine(double m, double z) {
  const double half = 0.5 * m * spacing;
  return std::cos(m * z) * std::pow(std::sin(half) / half, 2);
}

/// w = sin x cos mz and φ = sin x: ⟨w′φ′⟩ = ½ cos mz, ⟨φ′²⟩ = ½, ⟨w′²⟩ = ½ cos² mz.
TEST(SlabSums, FluxesAndVariancesOfAWave) {
  const double m = pi / height;
  const SlabSums sums = Lattice([&](double x, double z) { return std::sin(x) * std::cos(m * z); },
                                nothing, nothing, [](double x, double) { return std::sin(x); })
                            .measured();
  const SlabLayout& at = sums.layout();
  for (std::size_t k = 1; k + 1 < levels; ++k) {
    const double z = static_cast<double>(k) * spacing;
    EXPECT_NEAR(sums.moment(at.flux(3))[k], 0.5 * tent_of_cosine(m, z), 1e-4);
    EXPECT_NEAR(sums.moment(at.variance(3))[k], 0.5, 1e-12);
    EXPECT_NEAR(sums.moment(at.variance(0))[k], 0.25 * (1 + tent_of_cosine(2 * m, z)), 1e-4);
    EXPECT_NEAR(sums.moment(at.mean(0))[k], 0, 1e-14);
    EXPECT_NEAR(sums.moment(at.third())[k], 0, 1e-14);
    EXPECT_EQ(sums.moment(at.fraction(SlabLayout::cloud))[k], 0);
  }
}

/// A stratified layer at rest varies over a slab's depth, but not across: no variance at any level
/// but the walls, where the mean is over half a tent; there ⟨(z′)²⟩ is 1/162 of the spacing
/// squared.
TEST(SlabSums, StratificationIsNoVariance) {
  const SlabSums sums = Lattice([](double x, double) { return std::sin(x); }, nothing, nothing,
                                [](double, double z) { return 300 + 5 * z; })
                            .measured();
  const SlabLayout& at = sums.layout();
  for (std::size_t k = 0; k < levels; ++k) {
    const bool inner = k > 1 && k + 2 < levels;
    const double z = static_cast<double>(k) * spacing;
    if (k > 0 && k + 1 < levels) {
      EXPECT_NEAR(sums.moment(at.mean(3))[k], 300 + 5 * z, 1e-10);
    }
    EXPECT_NEAR(sums.moment(at.variance(3))[k], 0, inner ? 1e-20 : 25 * spacing * spacing / 100);
    EXPECT_NEAR(sums.moment(at.flux(3))[k], 0, 1e-12);
  }
  EXPECT_NEAR(sums.moment(at.variance(3))[0], 25 * spacing * spacing / 162,
              0.01 * 25 * spacing * spacing / 162);
}

/// A quarter of every level rises at 3, the rest sinks at 1: ⟨w⟩ = 0, ⟨w²⟩ = 3, ⟨w³⟩ = 6 and a
/// skewness of 6/3^1.5 = 2/√3, as for any p with w = (1 − p)/p and −1.
TEST(SlabSums, ThirdMomentOfNarrowUpdraughts) {
  const SlabSums sums =
      Lattice([](double x, double) { return x < pi / 2 ? 3.0 : -1.0; }, nothing, nothing, nothing)
          .measured();
  const SlabLayout& at = sums.layout();
  for (std::size_t k = 0; k < levels; ++k) {
    const double w2 = sums.moment(at.variance(0))[k], w3 = sums.moment(at.third())[k];
    EXPECT_NEAR(w2, 3, 1e-12);
    EXPECT_NEAR(w3 / std::pow(w2, 1.5), 2 / std::sqrt(3.0), 1e-12);
  }
}

/// Half of the air is cloudy and rises at 2 + 1, the rest sinks at 2 − 1 = 1 with the mean 2; half
/// of the cloud is buoyant. σ = ½, M = ½ (3 − 2); core: σ = ¼, M = ¼.
TEST(SlabSums, CloudAndCoreOfKnownShare) {
  const auto cloudy = [](double x, double) { return x < pi ? 1.0 : 0.0; };
  const SlabSums sums =
      Lattice([&](double x, double z) { return 1 + 2 * cloudy(x, z); },
              [](double x, double z) { return z + (x < pi / 2 ? 0.3 : -0.1); },
              [&](double x, double z) { return cloudy(x, z) * (2 + (x < pi / 2 ? 1 : 0)); },
              nothing)
          .measured();
  const SlabLayout& at = sums.layout();
  for (std::size_t k = 2; k + 2 < levels; ++k) {
    EXPECT_NEAR(sums.moment(at.fraction(SlabLayout::cloud))[k], 0.5, 1e-12);
    EXPECT_NEAR(sums.moment(at.mass_flux(SlabLayout::cloud))[k], 0.5 * (3 - 2), 1e-12);
    EXPECT_NEAR(sums.moment(at.sum(SlabLayout::cloud, 0))[k] /
                    sums.moment(at.fraction(SlabLayout::cloud))[k],
                3, 1e-12);
    EXPECT_NEAR(sums.moment(at.sum(SlabLayout::cloud, 1))[k], 0.5 * 2.5, 1e-12);
    EXPECT_NEAR(sums.moment(at.fraction(SlabLayout::core))[k], 0.25, 1e-12);
    EXPECT_NEAR(sums.moment(at.mass_flux(SlabLayout::core))[k], 0.25, 1e-12);
    EXPECT_NEAR(sums.moment(at.sum(SlabLayout::core, 1))[k], 0.25 * 3, 1e-12);
    // The slab mean is z + (0.3 − 3·0.1)/4 = z.
    EXPECT_NEAR(sums.moment(at.excess(SlabLayout::core))[k], 0.25 * 0.3, 1e-12);
  }
}

TEST(SlabSums, SameBitsForAnyNumberOfThreads) {
  const auto rough = [](double x, double z) { return std::sin(917 * x + 31 * z); };
  const Lattice lattice(
      rough, rough, [](double x, double z) { return std::cos(37 * x * z); }, rough);
  const int before = omp_get_max_threads();
  omp_set_num_threads(1);
  const SlabSums one = lattice.measured();
  omp_set_num_threads(3);
  const SlabSums three = lattice.measured();
  omp_set_num_threads(before);
  const std::vector<double> a(one.values().begin(), one.values().end()),
      b(three.values().begin(), three.values().end());
  EXPECT_EQ(a, b);
}

TEST(SlabSums, ALevelWithoutAirHasNoNumbers) {
  SlabLayout layout;
  layout.variables = 2;
  layout.buoyancy = 1;
  SlabSums sums(layout, 4);
  const double z = 0.5, volume = 1, value = 7;
  SlabState state{1, 0, 1, &z, &volume, {&value, &value}};
  sums.measure(state);
  EXPECT_EQ(sums.moment(layout.mean(0))[0], 7);
  EXPECT_TRUE(std::isnan(sums.moment(layout.mean(0))[3]));
}

}  // namespace
}  // namespace pileus::model
