#include "dynamics/reference_profile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pileus::dynamics {

ReferenceProfile::ReferenceProfile(double bottom, double top, int points,
                                   const std::function<double(double)>& b_ref)
    : bottom_(bottom), inverse_spacing_((points - 1) / (top - bottom)) {
  bool zero = true;
  for (int i = 0; i < points; ++i) {
    const double fraction = static_cast<double>(i) / (points - 1);
    value_.push_back(b_ref(bottom + fraction * (top - bottom)));
    zero = zero && value_.back() == 0;
  }
  if (zero) value_.clear();
  if (zero) return;
  slope_ = (value_.back() - value_.front()) / (top - bottom);
  intercept_ = value_.front() - slope_ * bottom;
  // Straight to the rounding of its values: what a formula like N²·z gives.
  double largest = 0, defect = 0;
  for (int i = 0; i < points; ++i) {
    const double z = bottom + static_cast<double>(i) / (points - 1) * (top - bottom);
    const double value = value_[static_cast<std::size_t>(i)];
    largest = std::max(largest, std::abs(value));
    defect = std::max(defect, std::abs(intercept_ + slope_ * z - value));
  }
  linear_ = defect <= 8 * std::numeric_limits<double>::epsilon() * largest;
}

double ReferenceProfile::operator()(double z) const {
  if (is_zero()) return 0;
  const double xi = (z - bottom_) * inverse_spacing_;
  // Linear continuation beyond the walls, where parcels may be for the length of a stage.
  const int last = static_cast<int>(value_.size()) - 2;
  const int i = xi > 0 ? (xi < last ? static_cast<int>(xi) : last) : 0;
  const double low = value_[static_cast<std::size_t>(i)];
  return low + (xi - i) * (value_[static_cast<std::size_t>(i) + 1] - low);
}

double ReferenceProfile::gradient(double z) const {
  if (is_zero()) return 0;
  const double h = 0.5 / inverse_spacing_;
  return ((*this)(z + h) - (*this)(z - h)) * inverse_spacing_;
}

}  // namespace pileus::dynamics
