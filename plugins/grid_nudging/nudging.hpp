// Relaxation towards the gridded value, as functions of values at a node or a parcel.
#pragma once
#include <algorithm>

namespace pileus::nudging {

/// φ_p + Σ_g w_pg f_g (φ_g − φ_p) from G = Σ_g w_pg f_g φ_g and F = Σ_g w_pg f_g. As a convex
/// combination it never leaves the range of φ_p and φ_g by more than rounding; sums of rounded
/// weights above one do not count, so that what is not negative stays so.
inline double nudged(double value, double gathered, double share) {
  return (1.0 - std::min(share, 1.0)) * value + gathered;
}

/// The change alone, Σ_g w_pg f_g (φ_g − φ_p): for what is much smaller than the profile that φ is
/// measured from. The digits that the difference to the profile has lost count by the share.
inline double nudging_increment(double value, double gathered, double share) {
  return gathered - std::min(share, 1.0) * value;
}

}  // namespace pileus::nudging
