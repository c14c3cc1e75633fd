// How fast a drop exchanges vapour with the air: diffusion of vapour to it, of heat from it.
#pragma once
#include <pileus/drops.hpp>

#include <cmath>

namespace pileus::two_moment {

using namespace drops;  // NOLINT: the vocabulary of this folder

/// G in r dr/dt = G s, m2 s-1: 1/G = F_d + F_k, F_d = ρ_w R_v T/(D e_s) and
/// F_k = ρ_w L/(K T)·(L/(R_v T) − 1) (Rogers & Yau 1989, eq. 7.17, without curvature and solute).
///
/// `vapour_pressure` is the saturation pressure e_s (Pa), `gas_constant` that of vapour.
inline double growth_coefficient(double temperature, double pressure, double vapour_pressure,
                                 double latent_heat, double gas_constant) {
  const double diffusion = water_density * gas_constant * temperature /
                           (vapour_diffusivity(temperature, pressure) * vapour_pressure);
  const double conduction = water_density * latent_heat /
                            (heat_conductivity(temperature) * temperature) *
                            (latent_heat / (gas_constant * temperature) - 1.0);
  return 1.0 / (diffusion + conduction);
}

/// How the sizes of cloud droplets are distributed about their mean mass.
enum class Spectrum {
  monodisperse,  // all alike
  gamma          // gamma in diameter, its width rising with the number: Morrison & Grabowski 2007
};

/// Mean radius over the radius of mean volume, c_μ: 1 for equal droplets; for a gamma distribution
/// of diameters with exponent μ (μ + 1)/((μ+1)(μ+2)(μ+3))^{1/3}, with μ = 1/η² − 1 and
/// η = 5.714e-4 N + 0.2714, N in cm-3 (Morrison & Grabowski 2007, doi:10.1175/JAS3980).
inline double radius_ratio(Spectrum spectrum, double number_per_volume) {
  if (spectrum == Spectrum::monodisperse) return 1.0;
  const double eta = 5.714e-4 * 1e-6 * number_per_volume + 0.2714;
  const double one = 1.0 / (eta * eta);  // μ + 1
  return one / std::cbrt(one * (one + 1.0) * (one + 2.0));
}

}  // namespace pileus::two_moment
