// Normal random numbers from the keyed uniform ones.
#pragma once
#include <cmath>
#include <cstdint>
#include <numbers>

#include "abi.h"
#include "philox.hpp"

namespace pileus {

/// n ≤ 16 independent draws from N(0, 1) of `channel` (< 64) for one parcel at this step, by the
/// transform of Box and Muller (1958, doi:10.1214/aoms/1177706645): the same keys, the same bits.
inline void draw_normal(const pileus_step& step, std::uint64_t uid, std::uint32_t channel,
                        std::uint32_t n, double* out) {
  double u[16];
  const std::uint32_t even = n + n % 2;
  draw_uniform({step.seed, step.stream, uid, step.number, step.call, channel}, even, u);
  for (std::uint32_t i = 0; i < even; i += 2) {
    const double radius = std::sqrt(-2.0 * std::log(u[i]));
    const double angle = 2.0 * std::numbers::pi * u[i + 1];
    out[i] = radius * std::cos(angle);
    if (i + 1 < n) out[i + 1] = radius * std::sin(angle);
  }
}

}  // namespace pileus
