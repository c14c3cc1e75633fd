// Exchange between pairs of overlapping parcels: symmetric, so that it conserves; limited, so that
// it creates no new extrema.
#pragma once
#include <algorithm>
#include <cmath>

namespace pileus::overlap {

/// How strongly a pair exchanges: one for coinciding centres, falling linearly with the common
/// growth factor √F to zero where it reaches 1 + `margin`.
inline double nearness(double contact, double margin) {
  return std::max(0.0, 1.0 - std::sqrt(contact) / (1.0 + margin));
}

/// Volume that two parcels exchange within dt at rate k: (1 − exp(−k dt)) V₁V₂/(V₁ + V₂). Alone,
/// their difference decays as exp(−k t) and each tends to the mixture.
inline double exchanged_volume(double rate, double dt, double v1, double v2) {
  return -std::expm1(-rate * dt) * v1 * v2 / (v1 + v2);
}

/// Factor on a parcel's exchanges that keeps their sum within its volume. A pair uses the smaller
/// of its two factors: then each new value is a mean of old ones with positive weights.
inline double exchange_limit(double total, double volume) {
  return total > volume ? volume / total : 1.0;
}

}  // namespace pileus::overlap
