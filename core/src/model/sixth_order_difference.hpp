// The central difference of the sixth order: f′ ≈ Σ_m w_m (f(x + m h) − f(x − m h))/h.
#pragma once
#include <array>

namespace pileus::model {

inline constexpr std::array<double, 3> difference_weights = {3.0 / 4.0, -3.0 / 20.0, 1.0 / 60.0};

/// Step h in mesh spacings. The truncation error is h⁶|f⁽⁷⁾|/140: of a wave of wavenumber k it is
/// (k h)⁶/140 of the derivative k f, below 2e-12 for waves of four spacings and more. Rounding adds
/// (11/6) ε |f|/h, 2e-13 of the derivative of a wave of 100 spacings.
inline constexpr double difference_step = 1.0 / 64.0;

}  // namespace pileus::model
