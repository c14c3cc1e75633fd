// Relaxation towards the gridded value, as functions of values at a node or a parcel.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

namespace pileus::nudging {

/// Part of the distance to the gridded value that is gone after `dt`: the solution
/// φ′(t) = φ′(0) exp(−β|S|t), for any β|S|dt.
inline double relaxed_part(double beta, double strain, double dt) {
  return -std::expm1(-beta * strain * dt);
}

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

/// Piecewise linear in height, constant beyond both ends. `heights` ascend; one value stands for
/// all heights.
class Profile {
 public:
  Profile() = default;
  Profile(std::span<const double> heights, std::span<const double> values)
      : heights_(heights), values_(values) {}

  bool is_zero() const {
    return std::all_of(values_.begin(), values_.end(), [](double v) { return v == 0; });
  }
  double operator()(double z) const {
    // A height that is not a number is at the lower end: it must not lead outside the list.
    if (values_.size() == 1 || !(z > heights_.front())) return values_.front();
    if (z >= heights_.back()) return values_.back();
    const auto above = std::upper_bound(heights_.begin(), heights_.end(), z) - heights_.begin();
    const auto k = static_cast<std::size_t>(above);
    const double part = (z - heights_[k - 1]) / (heights_[k] - heights_[k - 1]);
    return values_[k - 1] + part * (values_[k] - values_[k - 1]);
  }

 private:
  std::span<const double> heights_, values_;
};

}  // namespace pileus::nudging
