// How fast a droplet grows: diffusion of vapour to it and of heat from it, molecules next to it.
#pragma once
#include <pileus/drops.hpp>
#include <pileus/numerics.hpp>
#include <pileus/thermo.hpp>

#include <cmath>

namespace pileus::superdroplets {

/// Shares of the molecules that stay when they hit a droplet, of (0, 1].
struct Accommodation {
  double mass = 1.0;
  double heat = 1.0;
};

/// λ_D = 2 D/(2 R_v T)^{1/2} and λ_K = 0.8 K T/(p (2 R_d T)^{1/2}): lengths within which vapour and
/// heat move as free molecules, m (as in Arabas et al. 2015,
/// doi:10.5194/gmd-8-1677-2015).
inline double vapour_jump_length(double diffusivity, double temperature, double gas_constant) {
  return 2.0 * diffusivity / std::sqrt(2.0 * gas_constant * temperature);
}
inline double heat_jump_length(double conductivity, double temperature, double pressure,
                               double gas_constant) {
  return 0.8 * conductivity * temperature /
         (pressure * std::sqrt(2.0 * gas_constant * temperature));
}

/// 1/(F_d + F_k) of r dr/dt = (S − S_eq)/(F_d + F_k), m2 s-1, as a function of r:
/// F_d = ρ_w R_v T/(D β_D e_s), F_k = ρ_w L/(K β_K T)·(L/(R_v T) − 1) (Rogers & Yau 1989, eq. 7.17)
/// with β = (1 + Kn)/(1 + (4/(3α) + 0.377) Kn + 4/(3α) Kn²), Kn = λ/r (Fuchs & Sutugin 1971;
/// Laaksonen et al. 2005, doi:10.5194/acp-5-461-2005).
///
/// Brought over one denominator it is one rational function of r, N/Q with polynomials of degree 3:
/// N = r (r + λ_D)(r + λ_K) and Q = F_d (r² + c_D λ_D r + e_D λ_D²)(r + λ_K) + the same of heat.
/// It increases with r to 1/(F_d + F_k) at λ = 0.
struct Conductance {
  double n2 = 0, n1 = 0;                  // N = r³ + n2 r² + n1 r
  double q3 = 1, q2 = 0, q1 = 0, q0 = 0;  // Q

  double largest() const { return 1.0 / q3; }

  /// Value and slope in r.
  numerics::ValueAndSlope at(double r) const {
    const double n = ((r + n2) * r + n1) * r, slope_n = (3.0 * r + 2.0 * n2) * r + n1;
    const double q = ((q3 * r + q2) * r + q1) * r + q0;
    const double slope_q = (3.0 * q3 * r + 2.0 * q2) * r + q1;
    const double value = n / q;
    return {value, (slope_n - value * slope_q) / q};
  }
};

/// The properties of air that growth depends on.
struct GrowthAir {
  double diffusion;      // F_d without its β, s m-2
  double conduction;     // F_k without its β, s m-2
  double vapour_length;  // λ_D, m
  double heat_length;    // λ_K, m
};

/// At a temperature, a pressure and the saturation pressure of vapour.
inline GrowthAir growth_air(double temperature, double pressure, double vapour_pressure,
                            const thermo::Constants& constants) {
  const double gas_constant = constants.gas_constant_dry_air / constants.epsilon;
  const double diffusivity = drops::vapour_diffusivity(temperature, pressure);
  const double conductivity = drops::heat_conductivity(temperature);
  const double latent = constants.latent_heat;
  return {drops::water_density * gas_constant * temperature / (diffusivity * vapour_pressure),
          drops::water_density * latent / (conductivity * temperature) *
              (latent / (gas_constant * temperature) - 1.0),
          vapour_jump_length(diffusivity, temperature, gas_constant),
          heat_jump_length(conductivity, temperature, pressure, constants.gas_constant_dry_air)};
}

/// Without `kinetic` both β are 1.
inline Conductance conductance(const GrowthAir& air, const Accommodation& share, bool kinetic) {
  if (!kinetic) return {0, 0, air.diffusion + air.conduction, 0, 0, 0};
  const double d = air.vapour_length, k = air.heat_length;
  const double ed = 4.0 / (3.0 * share.mass), ek = 4.0 / (3.0 * share.heat);
  const double cd = ed + 0.377, ck = ek + 0.377;
  const double fd = air.diffusion, fk = air.conduction;
  return {d + k,
          d * k,
          fd + fk,
          fd * (cd * d + k) + fk * (ck * k + d),
          fd * d * (ed * d + cd * k) + fk * k * (ek * k + ck * d),
          d * k * (fd * ed * d + fk * ek * k)};
}

/// Factor by which falling speeds up growth: 1 + 0.108 X² for X < 1.4, else 0.78 + 0.308 X, X =
/// Sc^{1/3} Re^{1/2} with Re of the diameter (Pruppacher & Rasmussen 1979,
/// doi:10.1175/1520-0469(1979)036<1255:AWTIOT>2.0.CO;2).
inline double ventilation(double schmidt, double reynolds) {
  const double x = std::cbrt(schmidt) * std::sqrt(reynolds);
  return x < 1.4 ? 1.0 + 0.108 * x * x : 0.78 + 0.308 * x;
}

}  // namespace pileus::superdroplets
