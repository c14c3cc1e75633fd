// Saturation adjustment of vapour, cloud and heat at a point.
#pragma once
#include <pileus/moist_air.hpp>
#include <pileus/numerics.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace kessler {

/// Cloud that forms (positive) or evaporates until the air is saturated or the cloud is gone.
///
/// Solves  q_v − c = q_s(T + (L/c_p) c)  for c. The left side falls with c and q_s rises: one root,
/// bracketed by −q_c and q_v. Soong & Ogura (1973,
/// doi:10.1175/1520-0469(1973)030<0879:ACBAAS>2.0.CO;2) and KW take its first Newton step; here
/// steps go on to the root, so that a second call does nothing beyond rounding.
inline double condensation(const pileus::MoistAir& air, double temperature, double pressure,
                           double vapour, double cloud) {
  const pileus::Saturation at = air.saturation(temperature, pressure);
  const double excess = vapour - at.humidity;
  // Of q_s itself and of T: 20 times as much in warm air, 70 times at 110 K.
  constexpr double rounding = 4 * std::numeric_limits<double>::epsilon();
  const bool is_saturated = std::abs(excess) <= rounding * (at.humidity + temperature * at.slope);
  if (is_saturated || (excess < 0 && !(cloud > 0))) return 0.0;
  const double warming = air.warming();
  const auto residual = [&](double condensed) -> pileus::numerics::ValueAndSlope {
    const pileus::Saturation s = air.saturation(temperature + warming * condensed, pressure);
    return {s.humidity + condensed - vapour, 1.0 + warming * s.slope};
  };
  const double low = excess < 0 ? -cloud : 0.0, high = excess < 0 ? 0.0 : vapour;
  if (residual(low).value >= 0) return low;  // all cloud evaporates and air stays below saturation
  constexpr double tolerance = 1e-12;        // relative, of the last step, which is still taken
  return pileus::numerics::bracketed_newton(residual, low, high, 0.0, tolerance).x;
}

}  // namespace kessler
