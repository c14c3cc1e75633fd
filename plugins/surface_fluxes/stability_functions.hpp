// How stratification changes the profiles next to the ground: the functions of Monin and Obukhov.
#pragma once
#include <algorithm>
#include <cmath>

namespace pileus::surface {

enum class StabilityFunctions { businger_dyer, wilson };

namespace businger_dyer {

/// Dyer 1974 (doi:10.1007/BF00240838): φ_m = (1 − 16ζ)^{-1/4}, φ_h = φ_m² for ζ < 0 and φ = 1 + 5ζ
/// up to ζ = 1. Beyond, both stay at 6 (Webb 1970, doi:10.1002/qj.49709640708): the profiles keep
/// their slope in ln z, ψ = −5 − 5 ln ζ, which falls for ever and leaves a small flux at any
/// stability.
inline double psi_stable(double zeta) {
  return zeta <= 1 ? -5.0 * zeta : -5.0 - 5.0 * std::log(zeta);
}
inline double psi_m(double zeta) {
  if (zeta >= 0) return psi_stable(zeta);
  const double x = std::sqrt(std::sqrt(1.0 - 16.0 * zeta));
  // π/2 − 2 atan x = 2 atan(1/x) − π/2, and log1p keeps the digits near neutral.
  constexpr double half_pi = 1.57079632679489661923;
  return 2.0 * std::log1p(0.5 * (x - 1.0)) + std::log1p(0.5 * (x * x - 1.0)) - 2.0 * std::atan(x) +
         half_pi;
}
inline double psi_h(double zeta) {
  if (zeta >= 0) return psi_stable(zeta);
  return 2.0 * std::log1p(0.5 * (std::sqrt(1.0 - 16.0 * zeta) - 1.0));
}
inline double stable_phi_m(double zeta) {
  return 1.0 + 5.0 * std::min(zeta, 1.0);
}

}  // namespace businger_dyer

namespace wilson {

/// Unstable: Wilson 2001 (doi:10.1023/A:1018718707419), φ = (1 + γ|ζ|^{2/3})^{-1/2} with γ = 3.6
/// for momentum and 7.9 for heat, ψ = 3 ln((1 + 1/φ)/2); right also in free convection. Stable:
/// Beljaars & Holtslag 1991 as in the IFS.
inline double psi_unstable(double zeta, double gamma) {
  const double root = std::cbrt(-zeta);
  return 3.0 * std::log1p(0.5 * (std::sqrt(1.0 + gamma * root * root) - 1.0));
}
/// ⅔ [5/0.35 − (5/0.35 − ζ) e^{−0.35 ζ}], the part that both stable functions have.
inline double stable_part(double zeta) {
  const double decay = std::expm1(-0.35 * zeta);
  return 2.0 / 3.0 * (zeta * (1.0 + decay) - 5.0 / 0.35 * decay);
}
inline double psi_m(double zeta) {
  return zeta < 0 ? psi_unstable(zeta, 3.6) : -stable_part(zeta) - zeta;
}
inline double psi_h(double zeta) {
  if (zeta < 0) return psi_unstable(zeta, 7.9);
  return -stable_part(zeta) - std::expm1(1.5 * std::log1p(2.0 / 3.0 * zeta));
}
/// 1 − ζ dψ_m/dζ.
inline double stable_phi_m(double zeta) {
  return 1.0 + zeta * (1.0 + 2.0 / 3.0 * std::exp(-0.35 * zeta) * (6.0 - 0.35 * zeta));
}

}  // namespace wilson

/// Correction of the logarithmic profile of the wind at ζ = z/L.
inline double psi_m(StabilityFunctions functions, double zeta) {
  return functions == StabilityFunctions::wilson ? wilson::psi_m(zeta) : businger_dyer::psi_m(zeta);
}
/// The same of temperature and humidity.
inline double psi_h(StabilityFunctions functions, double zeta) {
  return functions == StabilityFunctions::wilson ? wilson::psi_h(zeta) : businger_dyer::psi_h(zeta);
}
/// Normalised gradient of the wind for ζ ≥ 0.
inline double stable_phi_m(StabilityFunctions functions, double zeta) {
  return functions == StabilityFunctions::wilson ? wilson::stable_phi_m(zeta)
                                                 : businger_dyer::stable_phi_m(zeta);
}

}  // namespace pileus::surface
