// Radius and fall speed of a drop from its mass, without a logarithm or a root.
#pragma once
#include <pileus/drops.hpp>

#include <bit>
#include <cstdint>
#include <vector>

#include "fall_speed.hpp"

namespace pileus::superdroplets {

struct RadiusAndSpeed {
  double radius, speed;  // m, m s-1
};

/// Straight lines in the mass, 32 to each doubling: exponent and five leading mantissa bits of the
/// mass number the segment.
///
/// Both are continuous and monotone wherever the formula is. A chord lies below m^{2/3} and m^{1/3}
/// by at most (1/36)/32² = 2.7e-5 of them; where a formula jumps the table rises within the
/// segment, 0.7 % of the radius. Masses outside [smallest, largest] (radii of 0.6 nm and 1.2 cm)
/// count as the nearest end.
class FallSpeedTable {
 public:
  static constexpr double smallest = 0x1p-80, largest = 0x1p-7;  // kg

  FallSpeedTable() : FallSpeedTable(FallSpeedScheme::none, 293.15, 101325.0) {}

  /// For air of a temperature (K) and a pressure (Pa).
  FallSpeedTable(FallSpeedScheme scheme, double temperature, double pressure)
      : segments_(number_of(largest)) {
    RadiusAndSpeed low = exact(scheme, smallest, temperature, pressure);
    for (std::uint64_t i = 0; i < segments_.size(); ++i) {
      const double m0 = mass_of(i), m1 = mass_of(i + 1);
      const RadiusAndSpeed high = exact(scheme, m1, temperature, pressure);
      Segment& s = segments_[i];
      s.radius_slope = (high.radius - low.radius) / (m1 - m0);
      s.speed_slope = (high.speed - low.speed) / (m1 - m0);
      s.radius = low.radius - s.radius_slope * m0;
      s.speed = low.speed - s.speed_slope * m0;
      low = high;
    }
  }

  /// Of a drop of a mass (kg).
  RadiusAndSpeed operator()(double mass) const {
    constexpr double below_largest = 0x1.fffffffffffffp-8;
    mass = mass > smallest ? mass : smallest;  // NaN counts as the smallest
    mass = mass < below_largest ? mass : below_largest;
    const Segment& s = segments_[number_of(mass)];
    return {s.radius + s.radius_slope * mass, s.speed + s.speed_slope * mass};
  }

 private:
  struct alignas(32) Segment {
    double radius, speed;              // at mass 0 of the line
    double radius_slope, speed_slope;  // per kg
  };
  static constexpr int dropped_bits = 47;  // 52 of the mantissa less five
  static constexpr std::uint64_t first = std::bit_cast<std::uint64_t>(smallest) >> dropped_bits;

  static std::uint64_t number_of(double mass) {
    return (std::bit_cast<std::uint64_t>(mass) >> dropped_bits) - first;
  }
  static double mass_of(std::uint64_t number) {
    return std::bit_cast<double>((number + first) << dropped_bits);
  }
  static RadiusAndSpeed exact(FallSpeedScheme scheme, double mass, double temperature,
                              double pressure) {
    const double radius = drops::radius_of_mass(mass);
    return {radius, fall_speed(scheme, radius, temperature, pressure)};
  }

  std::vector<Segment> segments_;
};

}  // namespace pileus::superdroplets
