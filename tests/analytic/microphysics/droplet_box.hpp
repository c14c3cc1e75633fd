// A well-mixed box of colliding superdroplets: that of Shima et al. (2009, doi:10.1002/qj.441),
// section 5.1.
#pragma once
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "../../../plugins/superdroplets/coalescence.hpp"

namespace pileus::superdroplets {

/// 2^23 m-3 drops in 1e6 m3, exponential in volume about that of 30.531 µm: 1 g m-3.
struct ShimaBox {
  static constexpr double number_density = 8388608.0;    // m-3
  static constexpr double volume = 1e6;                  // m3
  static constexpr double mean_mass = 1.1920972799e-10;  // kg
  /// b N_0 X_0 of Golovin's kernel, s-1.
  static constexpr double golovin_rate = 1500.0 * number_density * mean_mass / 1000.0;

  std::vector<std::int64_t> multiplicity;
  std::vector<double> water_mass;
  std::vector<std::uint32_t> items;
  std::uint64_t seed;
  std::uint64_t step = 0;
  CoalescenceOptions options;
  CoalescenceScratch scratch;
  CoalescenceOutcome did;  // sums over all steps; the largest γ

  /// Equal multiplicities, one drop in each of n equal parts of the distribution: its quantile at
  /// (j + u)/n. Drawn freely instead, the liquid water itself would vary by n^{−1/2}.
  ShimaBox(std::size_t n, std::uint64_t member)
      : multiplicity(n,
                     static_cast<std::int64_t>(number_density * volume / static_cast<double>(n))),
        water_mass(n),
        items(n),
        seed(member) {
    std::vector<double> u(n);
    draw_uniform({seed, 9, 0, 0, 0, 0}, static_cast<std::uint32_t>(n), u.data());
    for (std::size_t j = 0; j < n; ++j) {
      const double part = (static_cast<double>(j) + u[j]) / static_cast<double>(n);
      water_mass[j] = -mean_mass * std::log1p(-part);
      items[j] = static_cast<std::uint32_t>(j);
    }
  }

  template <class Kernel>
  void run(const Kernel& kernel, double time, double dt) {
    const DropColumns columns{multiplicity.data(), water_mass.data()};
    for (const auto end = step + static_cast<std::uint64_t>(std::lround(time / dt)); step < end;) {
      const auto once = coalesce(kernel, columns, std::span<const std::uint32_t>(items), volume, dt,
                                 DrawKey{seed, 1, 1, step++}, options, scratch);
      did.coalescences += once.coalescences;
      did.events += once.events;
      did.emptied += once.emptied;
      did.deficit += once.deficit;
      did.substeps += once.substeps;
      did.largest_repetition = std::max(did.largest_repetition, once.largest_repetition);
    }
  }

  /// Σ ξ m^k.
  double moment(int k) const {
    double sum = 0;
    for (std::size_t i = 0; i < multiplicity.size(); ++i)
      sum += static_cast<double>(multiplicity[i]) * std::pow(water_mass[i], k);
    return sum;
  }
  /// Drops over those at the start.
  double number() const { return moment(0) / (number_density * volume); }
};

}  // namespace pileus::superdroplets
