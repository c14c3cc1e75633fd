// The state buoyancy is measured from: a function of height that exerts no torque.
#pragma once
#include <functional>
#include <vector>

namespace pileus::dynamics {

/// Buoyancy of the reference state b_ref(z), tabulated between the walls and linear in between.
/// Subtracting it from every parcel at the parcel's own height, before anything is deposited,
/// removes the error of representing a steep b_ref with scattered parcels; the vorticity equation
/// only uses horizontal gradients, so nothing else changes.
class ReferenceProfile {
 public:
  /// The zero profile.
  ReferenceProfile() = default;
  /// Tabulates `b_ref` (m s⁻²) at `points` ≥ 2 equidistant heights from `bottom` to `top` (m).
  ReferenceProfile(double bottom, double top, int points,
                   const std::function<double(double)>& b_ref);

  bool is_zero() const { return value_.empty(); }
  /// True if the profile is a straight line, then also value(z) = intercept() + slope()·z.
  bool is_linear() const { return linear_; }
  double intercept() const { return intercept_; }
  double slope() const { return slope_; }
  double operator()(double z) const;
  /// db_ref/dz at a height (s⁻²), one-sided at the ends.
  double gradient(double z) const;

 private:
  double bottom_ = 0, inverse_spacing_ = 0;
  std::vector<double> value_;
  bool linear_ = true;  // as the zero profile is
  double intercept_ = 0, slope_ = 0;
};

}  // namespace pileus::dynamics
