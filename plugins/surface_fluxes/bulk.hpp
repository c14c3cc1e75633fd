// Fluxes by fixed exchange coefficients.
#pragma once
#include <cmath>

namespace pileus::surface {

struct BulkCoefficients {
  double momentum, heat, moisture;  // C_m, C_h, C_q at the reference height
  double reference_height;          // m

  /// Whether the reference height is in the air, where the adjustment has a meaning.
  bool is_above(double roughness) const { return reference_height > roughness; }
  /// What the coefficients are multiplied by at another height: the square of the ratio of the
  /// logarithms, as of a neutral layer (van Zanten et al. 2011, doi:10.1029/2011MS000056).
  /// Both heights have to be above the roughness: squares hide a negative logarithm.
  double adjustment(double height, double roughness) const {
    const double ratio = std::log(reference_height / roughness) / std::log(height / roughness);
    return ratio * ratio;
  }
};

}  // namespace pileus::surface
