// The hydrostatic state whose pressure the thermodynamics use: a function of height alone.
#pragma once
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "thermo.hpp"

namespace pileus::thermo {

/// Air at rest with a virtual potential temperature that is piecewise linear in height and constant
/// beyond its ends; its Exner function solves dΠ/dz = −g/(c_p θ_v) exactly on every segment.
class ReferenceState {
 public:
  /// `heights` (m) ascending and `theta_v` (K, positive) of the same length, at least one; the
  /// pressure is `surface_pressure` (Pa) at `base_height` (m).
  ReferenceState(std::span<const double> heights, std::span<const double> theta_v,
                 double base_height, double surface_pressure, const Constants& constants)
      : height_(heights.begin(), heights.end()),
        theta_v_(theta_v.begin(), theta_v.end()),
        gradient_(constants.gravity / constants.heat_capacity) {
    exner_.assign(height_.size(), 0.0);
    for (std::size_t i = 1; i < height_.size(); ++i) {
      exner_[i] = exner_[i - 1] - drop(i - 1, height_[i]);
    }
    const double shift = thermo::exner(surface_pressure, constants.kappa()) - at(base_height).exner;
    for (double& value : exner_) value += shift;
  }

  struct Point {
    double exner;    // 1
    double theta_v;  // K
  };
  /// The state at a height; the Exner function is not positive above the top of the atmosphere.
  Point at(double height) const {
    if (!(height > height_.front())) {
      return {exner_.front() + gradient_ * (height_.front() - height) / theta_v_.front(),
              theta_v_.front()};
    }
    std::size_t i = height_.size() - 1;
    while (height < height_[i]) --i;
    if (i + 1 == height_.size()) {
      return {exner_[i] - gradient_ * (height - height_[i]) / theta_v_[i], theta_v_[i]};
    }
    return {exner_[i] - drop(i, height), theta_v_[i] + slope(i) * (height - height_[i])};
  }

 private:
  double slope(std::size_t i) const {
    return (theta_v_[i + 1] - theta_v_[i]) / (height_[i + 1] - height_[i]);
  }
  /// Fall of the Exner function from node i to a height within its segment:
  /// (g/c_p) ∫dz/θ_v = (g/c_p)(Δz/θ_i) ln(1 + r)/r with r = (θ_v − θ_i)/θ_i.
  double drop(std::size_t i, double height) const {
    const double rise = height - height_[i];
    const double r = slope(i) * rise / theta_v_[i];
    const double mean = r == 0.0 ? 1.0 : std::log1p(r) / r;
    return gradient_ * rise / theta_v_[i] * mean;
  }

  std::vector<double> height_, theta_v_, exner_;
  double gradient_;  // g/c_p, K m-1
};

}  // namespace pileus::thermo
