// How many particles of a population are of what size, over x = ln r.
#pragma once
#include <cmath>
#include <limits>

#include "normal_quantile.hpp"

namespace pileus::superdroplets {

/// A population's share by size: lognormal, exponential in volume, or all alike.
class SizeDistribution {
 public:
  /// Geometric mean radius (m) and geometric standard deviation; 1: all alike.
  static SizeDistribution lognormal(double radius, double deviation) {
    return {std::log(radius), std::log(deviation), false};
  }
  /// Radius of the mean volume, m.
  static SizeDistribution exponential(double radius) { return {std::log(radius), 1.0, true}; }

  bool uniform_size() const { return !(width_ > 0); }
  double centre() const { return centre_; }

  /// x below which a share p of the number lies, 0 < p < 1.
  double quantile(double p) const {
    return exponential_ ? centre_ + std::log(-std::log1p(-p)) / 3.0
                        : centre_ + width_ * normal_quantile(p);
  }
  /// The same from above, accurate where p is close to 0.
  double upper_quantile(double p) const {
    return exponential_ ? centre_ + std::log(-std::log(p)) / 3.0
                        : centre_ - width_ * normal_quantile(p);
  }
  /// Density of the number over x, up to a factor.
  double density(double x) const {
    if (exponential_) {
      const double v = std::exp(3.0 * (x - centre_));
      return v * std::exp(1.0 - v);
    }
    const double z = (x - centre_) / width_;
    return std::exp(-0.5 * z * z);
  }
  /// Share of the number between two x; infinite ones are meant literally.
  double between(double a, double b) const {
    if (!exponential_) return normal_between((a - centre_) / width_, (b - centre_) / width_);
    const double u = std::exp(3.0 * (a - centre_)), v = std::exp(3.0 * (b - centre_));
    return std::isinf(v) ? std::exp(-u) : -std::exp(-u) * std::expm1(u - v);
  }

 private:
  SizeDistribution(double centre, double width, bool exponential)
      : centre_(centre), width_(width), exponential_(exponential) {}
  double centre_, width_;
  bool exponential_;
};

}  // namespace pileus::superdroplets
