// Supersaturation that is driven at a constant rate and relaxes at a constant rate, exactly.
#pragma once
#include <cmath>

namespace pileus::two_moment {

/// What became of an excess of vapour δ after a step.
struct Relaxed {
  double excess;  // δ at the end of the step
  double taken;   // what phase changes took from it: δ_0 + A h − δ_1 = Γ Δq
};

/// Exact solution of dδ/dt = A − δ/τ over h (Clark 1973; Morrison & Grabowski 2008,
/// doi:10.1175/2007JAS2374.1): δ_1 = A τ + (δ_0 − A τ) exp(−h/τ). Written in
/// m = 1 − exp(−x) and m/x, x = h/τ, so that no digit is lost from τ = 0 to τ = ∞.
///
/// Requires   `inverse_time` = 1/τ in [0, ∞], h > 0
inline Relaxed relax(double excess, double rate, double inverse_time, double h) {
  const double x = h * inverse_time;
  const double m = -std::expm1(-x);
  double lag;  // 1 − m/x: the share of the driving that has been taken
  if (x < 1e-2) {
    lag = x * (0.5 - x * (1.0 / 6 - x * (1.0 / 24 - x * (1.0 / 120 - x * (1.0 / 720)))));
  } else {
    lag = 1.0 - m / x;
  }
  const double driven = rate * h;
  return {excess * (1.0 - m) + driven * (1.0 - lag), excess * m + driven * lag};
}

}  // namespace pileus::two_moment
