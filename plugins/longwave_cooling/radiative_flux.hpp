// The longwave flux of a column with stratocumulus after Stevens et al. 2005, as functions.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

namespace pileus::longwave {

/// Parameters of Stevens et al. (2005, Mon. Wea. Rev. 133, 1443), eq. 3.
struct Flux {
  double above = 70;            // F_0, W m⁻², emitted upwards at the top of a thick cloud
  double below = 22;            // F_1, W m⁻², gained at its base
  double absorption = 85;       // κ, m² kg⁻¹
  double divergence = 0;        // D, s⁻¹, of the large scale; 0: no term of the clear air
  double heat_capacity = 1005;  // J kg⁻¹ K⁻¹

  /// Of the liquid water paths (kg m⁻²) above and below a height.
  double of_cloud(double path_above, double path_below) const {
    return above * std::exp(-absorption * path_above) + below * std::exp(-absorption * path_below);
  }
  /// What balances subsidence over the inversion at `rise` above it, with the density there:
  /// ρ_i c_p D (¼ h^{4/3} + z_i h^{1/3}), in which a prefactor of 1 K m^{-1/3} is left out.
  double of_clear_air(double density, double inversion, double rise) const {
    if (!(rise > 0)) return 0;
    const double root = std::cbrt(rise);
    return density * heat_capacity * divergence * root * (0.25 * rise + inversion);
  }
};

/// One column of levels 0 … n with half cells at its ends: faces are half-way between levels and at
/// the walls, so that level k has the depth Δz, at the walls Δz/2.
struct Column {
  double bottom = 0, spacing = 1;  // m
  std::size_t levels = 0;

  double depth(std::size_t k) const { return k == 0 || k + 1 == levels ? 0.5 * spacing : spacing; }
  double height(std::size_t k) const { return bottom + static_cast<double>(k) * spacing; }
  /// Height of the face below level k; k = levels: the top.
  double face(std::size_t k) const {
    if (k == 0) return bottom;
    if (k == levels) return height(levels - 1);
    return height(k) - 0.5 * spacing;
  }
};

/// Height at which `total_water` falls below `threshold` for the last time on the way up, linear
/// between levels; the bottom where it is nowhere above, the top where it still is there.
inline double inversion_height(const Column& column, std::span<const double> total_water,
                               double threshold) {
  std::size_t k = column.levels;
  while (k > 0 && !(total_water[k - 1] > threshold)) --k;
  if (k == 0) return column.bottom;
  if (k == column.levels) return column.height(k - 1);
  const double low = total_water[k - 1], high = total_water[k];
  return column.height(k - 1) + column.spacing * (low - threshold) / (low - high);
}

/// Convergence of the flux in every level, W m⁻³. `density` (kg m⁻³) and `liquid` (1) by level;
/// `inversion` (m) counts where the flux has a divergence. The sum of convergence times depth is
/// the flux at the bottom less that at the top.
inline void heating(const Column& column, const Flux& flux, std::span<const double> density,
                    std::span<const double> liquid, double inversion, double density_there,
                    std::span<double> convergence) {
  double path_above = 0, path_below = 0;
  for (std::size_t k = 0; k < column.levels; ++k)
    path_above += density[k] * liquid[k] * column.depth(k);
  const auto at_face = [&](std::size_t k) {
    return flux.of_cloud(path_above, path_below) +
           flux.of_clear_air(density_there, inversion, column.face(k) - inversion);
  };
  double lower = at_face(0);
  for (std::size_t k = 0; k < column.levels; ++k) {
    const double path = density[k] * liquid[k] * column.depth(k);
    path_above = std::max(0.0, path_above - path);
    path_below += path;
    const double upper = at_face(k + 1);
    convergence[k] = (lower - upper) / column.depth(k);
    lower = upper;
  }
}

}  // namespace pileus::longwave
