// Superdroplets that stand for the particles or drops in an amount of air.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "koehler.hpp"
#include "strata.hpp"

namespace pileus::superdroplets {

/// Particles of one kind, lognormal in the dry radius.
struct AerosolMode {
  double number;     // per kg of air: that per m3 over the density it was measured at
  double radius;     // geometric mean dry radius, m
  double deviation;  // geometric standard deviation; 1: all alike
  double kappa;      // hygroscopicity (Petters & Kreidenweis 2007)
};

/// Drops of pure water, exponential in volume.
struct DropSpectrum {
  double number;       // per kg of air
  double mean_volume;  // m3
};

/// What one superdroplet stands for.
struct Superdroplet {
  std::int64_t multiplicity = 0;
  double water_mass = 0;          // kg
  double dry_volume = 0;          // m3
  double hygroscopic_volume = 0;  // m3
};

/// The air that particles take up water from before they are droplets.
struct Humidity {
  double saturation;   // S
  double kelvin;       // A, m
  double most = 0.95;  // S above this counts as this: nothing is activated by a start
};

/// Samples a spectrum: cut into strata once, drawn for every parcel.
///
/// Superdroplets are shared among modes in proportion to N^{1−α}, at least one to each: by number
/// for strata of equal number, evenly for strata of equal width.
class AerosolSampler {
 public:
  /// Requires   modes of positive number, no more than `count`
  AerosolSampler(const std::vector<AerosolMode>& modes, std::size_t count,
                 const SamplingOptions& options) {
    const std::vector<std::size_t> shares = share_out(modes, count, options.exponent());
    for (std::size_t m = 0; m < modes.size(); ++m)
      populations_.push_back(
          {modes[m].number, modes[m].kappa, false,
           Strata(SizeDistribution::lognormal(modes[m].radius, modes[m].deviation), shares[m],
                  options)});
    count_ = count;
  }
  AerosolSampler(const DropSpectrum& drops, std::size_t count, const SamplingOptions& options)
      : count_(count) {
    populations_.push_back(
        {drops.number, 0.0, true,
         Strata(SizeDistribution::exponential(radius_of_volume(drops.mean_volume)), count,
                options)});
  }

  /// The most superdroplets a parcel gets, and the uniforms a sample draws.
  std::size_t count() const { return count_; }
  std::size_t uniforms() const { return count_ + populations_.size(); }
  /// Particles or drops of all populations, per kg of air.
  double number() const {
    double sum = 0;
    for (const Population& population : populations_) sum += population.number;
    return sum;
  }

  /// The superdroplets of an air mass (kg) into `out` (count() of them); returns how many were
  /// made. `uniform(k)`, k < uniforms(), gives numbers of (0, 1). Fewer than 2^53 particles in all.
  ///
  /// Multiplicities are the differences of the rounded numbers below each stratum's edges, all
  /// shifted by one random fraction: each is unbiased and within 1 of its stratum's number, their
  /// sum within 1 of the population's, also where strata hold less than one particle. Strata that
  /// come out empty make no superdroplet.
  template <class Uniform>
  std::size_t sample(double air_mass, const Humidity& humidity, Uniform&& uniform,
                     std::span<Superdroplet> out) const {
    std::size_t made = 0, draw = 0, shift = count_;
    for (const Population& population : populations_) {
      const double total = population.number * air_mass, phase = uniform(shift++);
      double before = 0;
      for (std::size_t j = 0; j < population.strata.count(); ++j) {
        const double after = std::floor(phase + total * population.strata.share_below(j + 1));
        const double u = uniform(draw++);
        if (after > before)
          out[made++] = superdroplet(population, static_cast<std::int64_t>(after - before),
                                     population.strata.radius(j, u), humidity);
        before = after;
      }
    }
    return made;
  }

 private:
  struct Population {
    double number, kappa;
    bool pure;
    Strata strata;
  };

  static Superdroplet superdroplet(const Population& population, std::int64_t multiplicity,
                                   double radius, const Humidity& humidity) {
    const double volume = volume_of_radius(radius);
    if (population.pure) return {multiplicity, volume * drops::water_density, 0.0, 0.0};
    const Particle particle{volume, population.kappa * volume};
    const double s = std::min(humidity.saturation, humidity.most);
    return {multiplicity, equilibrium_water(s, particle, humidity.kelvin), particle.dry_volume,
            particle.hygroscopic_volume};
  }

  /// One to each mode, the rest by largest remainder.
  static std::vector<std::size_t> share_out(const std::vector<AerosolMode>& modes,
                                            std::size_t count, double exponent) {
    std::vector<double> part(modes.size());
    double all = 0;
    for (std::size_t m = 0; m < modes.size(); ++m)
      all += part[m] = std::pow(modes[m].number, 1.0 - exponent);
    std::vector<std::size_t> shares(modes.size(), 1);
    std::size_t left = count - modes.size();
    for (; left > 0; --left) {  // to the one that lacks most
      std::size_t poorest = 0;
      double most = -1e300;
      for (std::size_t m = 0; m < modes.size(); ++m) {
        const double lack =
            part[m] / all * static_cast<double>(count) - static_cast<double>(shares[m]);
        if (lack > most) most = lack, poorest = m;
      }
      ++shares[poorest];
    }
    return shares;
  }

  std::vector<Population> populations_;
  std::size_t count_ = 0;
};

}  // namespace pileus::superdroplets
