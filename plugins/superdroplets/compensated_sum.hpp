// Sums whose rounding does not grow with the number of terms.
#pragma once
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>

namespace pileus::superdroplets {

/// Σ multiplicity·mass to a unit in the last place or two, in a fixed order: four lanes, each
/// compensated (Neumaier 1974, doi:10.1002/zamm.19740540106), joined the same way.
inline double total_water(std::span<const std::int64_t> multiplicity,
                          std::span<const double> mass) {
  constexpr std::size_t lanes = 4;
  double sum[lanes] = {}, lost[lanes] = {};
  const auto add = [](double& s, double& c, double x) {
    const double t = s + x;
    c += std::abs(s) >= std::abs(x) ? (s - t) + x : (x - t) + s;
    s = t;
  };
  std::size_t i = 0;
  for (; i + lanes <= mass.size(); i += lanes)
    for (std::size_t k = 0; k < lanes; ++k)
      add(sum[k], lost[k], static_cast<double>(multiplicity[i + k]) * mass[i + k]);
  for (std::size_t k = 0; i < mass.size(); ++i, ++k)
    add(sum[k], lost[k], static_cast<double>(multiplicity[i]) * mass[i]);
  double all = 0, rest = 0;
  for (std::size_t k = 0; k < lanes; ++k) {
    add(all, rest, sum[k]);
    rest += lost[k];
  }
  return all + rest;
}

}  // namespace pileus::superdroplets
