// Sampled superdroplets stand for their spectrum: totals, moments, and what is drawn.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "../../../plugins/superdroplets/aerosol_sampling.hpp"

namespace pileus::superdroplets {
namespace {

constexpr Humidity humid{0.99, 1.1e-9, 0.95};
constexpr Sampling methods[] = {Sampling::constant_multiplicity, Sampling::log_uniform,
                                Sampling::alpha};

struct Uniform {
  std::mt19937_64 random{1};
  double operator()(std::size_t) { return std::uniform_real_distribution<double>(0, 1)(random); }
};

template <class Spectrum, class Draw>
std::vector<Superdroplet> draw(const Spectrum& spectrum, std::size_t count, Sampling method,
                               double mass, Draw&& uniform) {
  const AerosolSampler sampler(spectrum, count, {method});
  std::vector<Superdroplet> sample(sampler.count());
  sample.resize(sampler.sample(mass, humid, uniform, sample));
  return sample;
}

std::int64_t total(const std::vector<Superdroplet>& sample) {
  std::int64_t sum = 0;
  for (const Superdroplet& s : sample) sum += s.multiplicity;
  return sum;
}

/// Σ ξ r_d^k.
double moment(const std::vector<Superdroplet>& sample, double k) {
  double sum = 0;
  for (const Superdroplet& s : sample)
    sum += static_cast<double>(s.multiplicity) * std::pow(radius_of_volume(s.dry_volume), k);
  return sum;
}

TEST(NormalQuantile, inverts_the_distribution) {
  // Abramowitz & Stegun (1964), table 26.5: 1.95996398 and 3.09023231.
  EXPECT_NEAR(normal_quantile(0.975), 1.95996398454, 1e-11);
  EXPECT_NEAR(normal_quantile(0.001), -3.09023230617, 1e-11);
  EXPECT_NEAR(normal_quantile(0.5), 0.0, 1e-16);
  for (double p = 1e-12; p < 1; p = p < 0.9 ? p * 1.7 : p + 0.03)
    EXPECT_NEAR(normal_distribution(normal_quantile(p)) / p, 1, 1e-12) << p;
}

TEST(AerosolSampling, total_is_within_one_particle_for_every_amount_of_air) {
  const std::vector<AerosolMode> modes = {{9e8, 5e-8, 2.0, 0.61}, {3e5, 1e-6, 1.6, 1.2}};
  Uniform uniform;
  for (const Sampling method : methods) {
    for (double mass = 1e-9; mass < 1e9; mass *= 7.3) {
      const auto sample = draw(modes, 24, method, mass, uniform);
      EXPECT_LE(sample.size(), 24u);
      // Two modes, each rounded once.
      EXPECT_NEAR(static_cast<double>(total(sample)), 9.003e8 * mass, 2 + 1e-15 * 9e8 * mass);
      for (const Superdroplet& s : sample) EXPECT_GE(s.multiplicity, 1);
    }
  }
}

TEST(AerosolSampling, of_less_than_a_particle_makes_it_as_often_as_it_is_there) {
  const std::vector<AerosolMode> modes = {{1000.0, 5e-8, 2.0, 0.61}};
  Uniform uniform;
  const AerosolSampler sampler(modes, 16, {});
  std::vector<Superdroplet> sample(16);
  std::int64_t sum = 0;
  constexpr int parcels = 20000;
  for (int i = 0; i < parcels; ++i) {
    const std::size_t made = sampler.sample(3e-4, humid, uniform, sample);
    sum += total({sample.begin(), sample.begin() + static_cast<std::ptrdiff_t>(made)});
  }
  // 0.3 each; the standard deviation of the mean is 0.0032.
  EXPECT_NEAR(static_cast<double>(sum) / parcels, 0.3, 0.013);
}

TEST(AerosolSampling, moments_converge_to_those_of_the_lognormal) {
  // <r^k> = r_g^k exp(k² ln² σ/2).
  const std::vector<AerosolMode> modes = {{1e9, 5e-8, 1.8, 0.61}};
  const double width = std::log(1.8);
  for (const Sampling method : methods) {
    const auto sample = draw(modes, 4096, method, 1.0, [](std::size_t) { return 0.5; });
    for (const double k : {1.0, 2.0, 3.0}) {
      const double exact = 1e9 * std::pow(5e-8, k) * std::exp(0.5 * k * k * width * width);
      // Equal numbers leave the tail to few: 1/4096 of the number holds 2 % of the third moment.
      const double tolerance = method == Sampling::constant_multiplicity ? 2e-2 : 1e-4;
      EXPECT_NEAR(moment(sample, k) / exact, 1, tolerance) << k;
    }
  }
}

TEST(AerosolSampling, of_few_superdroplets_is_unbiased) {
  const std::vector<AerosolMode> modes = {{1e9, 5e-8, 1.8, 0.61}};
  const double width = std::log(1.8), exact = 1e9 * 5e-8 * std::exp(0.5 * width * width);
  for (const Sampling method : methods) {
    Uniform uniform;
    const AerosolSampler sampler(modes, 16, {method});
    std::vector<Superdroplet> sample(16);
    double sum = 0;
    constexpr int parcels = 20000;
    for (int i = 0; i < parcels; ++i) {
      const std::size_t made = sampler.sample(1.0, humid, uniform, sample);
      sum += moment({sample.begin(), sample.begin() + static_cast<std::ptrdiff_t>(made)}, 1);
    }
    // Four standard deviations of the mean, 3.7e-4 at most.
    EXPECT_NEAR(sum / parcels / exact, 1, 1.5e-3);
  }
}

TEST(AerosolSampling, constant_multiplicity_is_constant) {
  const auto sample = draw(std::vector<AerosolMode>{{1e9, 5e-8, 2.0, 0.61}}, 64,
                           Sampling::constant_multiplicity, 1.0, Uniform{});
  ASSERT_EQ(sample.size(), 64u);
  for (const Superdroplet& s : sample)
    EXPECT_NEAR(static_cast<double>(s.multiplicity), 1e9 / 64, 1.0);
}

TEST(AerosolSampling, log_uniform_reaches_into_the_tails) {
  const auto equal = draw(std::vector<AerosolMode>{{1e9, 5e-8, 2.0, 0.61}}, 64,
                          Sampling::constant_multiplicity, 1.0, Uniform{});
  const auto uniform = draw(std::vector<AerosolMode>{{1e9, 5e-8, 2.0, 0.61}}, 64,
                            Sampling::log_uniform, 1.0, Uniform{});
  const auto largest = [](const std::vector<Superdroplet>& sample) {
    return radius_of_volume(sample.back().dry_volume);
  };
  EXPECT_LT(largest(equal), 5e-7);
  EXPECT_GT(largest(uniform), 2e-6);  // 5.3 standard deviations
}

TEST(AerosolSampling, particles_of_one_size_are_alike_and_in_equilibrium) {
  for (const Sampling method : methods) {
    const auto sample =
        draw(std::vector<AerosolMode>{{1e8, 5e-8, 1.0, 0.61}}, 7, method, 2.0, Uniform{});
    ASSERT_EQ(sample.size(), 7u);
    EXPECT_EQ(total(sample), 200000000);
    for (const Superdroplet& s : sample) {
      EXPECT_NEAR(radius_of_volume(s.dry_volume), 5e-8, 1e-22);
      EXPECT_NEAR(s.hygroscopic_volume / s.dry_volume, 0.61, 1e-15);
      // 99 % counts as 95 %.
      const Particle p{s.dry_volume, s.hygroscopic_volume};
      EXPECT_NEAR(equilibrium_saturation(wet_radius(s.water_mass, s.dry_volume), p, 1.1e-9).value,
                  0.95, 1e-12);
    }
  }
}

TEST(AerosolSampling, modes_share_superdroplets_by_number_evenly_or_between) {
  const std::vector<AerosolMode> modes = {{9e8, 5e-8, 1.5, 0.5}, {1e8, 2e-7, 1.5, 1.0}};
  const auto of_second = [&](Sampling method) {
    int count = 0;
    for (const Superdroplet& s : draw(modes, 40, method, 1e6, Uniform{}))
      count += s.hygroscopic_volume > 0.9 * s.dry_volume;
    return count;
  };
  EXPECT_EQ(of_second(Sampling::constant_multiplicity), 4);
  EXPECT_EQ(of_second(Sampling::log_uniform), 20);
  EXPECT_EQ(of_second(Sampling::alpha), 14);  // 40/(1 + 9^0.3) = 13.6
  // The rarest has one in any case.
  const std::vector<AerosolMode> rare = {{9e8, 5e-8, 1.5, 0.5}, {1.0, 2e-6, 1.5, 1.0}};
  int count = 0;
  for (const Superdroplet& s : draw(rare, 8, Sampling::constant_multiplicity, 1e6, Uniform{}))
    count += s.hygroscopic_volume > 0.9 * s.dry_volume;
  EXPECT_EQ(count, 1);
}

TEST(DropSampling, has_the_moments_of_the_exponential_spectrum) {
  // Shima et al. (2009): N_0 = 2^23 m-3, mean volume 1.192e-13 m3; M_2 = 2 N_0 X_0².
  const DropSpectrum drops{8388608.0, 1.1920972799e-13};
  for (const Sampling method : methods) {
    const auto sample = draw(drops, 8192, method, 1e6, [](std::size_t) { return 0.5; });
    double mass = 0, square = 0;
    for (const Superdroplet& s : sample) {
      const double volume = s.water_mass / drops::water_density;
      EXPECT_EQ(s.dry_volume, 0.0);
      mass += static_cast<double>(s.multiplicity) * volume;
      square += static_cast<double>(s.multiplicity) * volume * volume;
    }
    EXPECT_EQ(total(sample), 8388608000000);
    EXPECT_NEAR(mass / (8388608e6 * drops.mean_volume), 1, 1e-4);
    EXPECT_NEAR(square / (2 * 8388608e6 * drops.mean_volume * drops.mean_volume), 1, 2e-3);
  }
}

}  // namespace
}  // namespace pileus::superdroplets
