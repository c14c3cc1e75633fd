// Mixing at a point: how far a parcel goes towards its surroundings. Pure functions, SI units.
#pragma once
#include <cmath>

namespace rates {

/// The share of the difference from its surroundings that a parcel gives up in `dt`: 1 −
/// exp(−dt/τ).
///
/// Solves  dφ/dt = (φ̄ − φ)/τ  over a step in which the mean φ̄ stays.
///
/// Units     dt and time_scale τ in s, τ > 0
/// Ensures   between 0 and 1 for every dt ≥ 0, and 0 for dt = 0: new values are weighted means
/// Source    Dopazo & O'Brien 1974, doi:10.1016/0094-5765(74)90050-2
inline double share_exchanged(double dt, double time_scale) {
  return -std::expm1(-dt / time_scale);
}

}  // namespace rates
