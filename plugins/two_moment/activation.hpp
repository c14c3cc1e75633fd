// How many aerosol particles a supersaturation turns into droplets.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "droplet_growth.hpp"

namespace pileus::two_moment {

enum class ActivationScheme { kappa_lognormal, twomey, arg2000 };

/// One lognormal mode of aerosol.
struct AerosolMode {
  double number;     // kg-1
  double radius;     // geometric mean dry radius, m
  double deviation;  // geometric standard deviation, > 1
  double kappa;      // hygroscopicity (Petters & Kreidenweis 2007)
};

/// The spectrum of cloud condensation nuclei: N(s), the number per kg of air whose critical
/// supersaturation is at most s.
class Aerosol {
 public:
  /// Lognormal modes; `gas_constant` is that of vapour, `surface_tension` in N m-1.
  Aerosol(ActivationScheme scheme, std::vector<AerosolMode> modes, double surface_tension,
          double gas_constant)
      : scheme_(scheme),
        modes_(std::move(modes)),
        kelvin_(2.0 * surface_tension / (water_density * gas_constant)) {
    for (const AerosolMode& mode : modes_) total_ += mode.number;
  }
  /// Twomey (1959): N = C (100 s)^k, at most `most`; C and `most` in kg-1.
  Aerosol(double coefficient, double exponent, double most)
      : scheme_(ActivationScheme::twomey),
        total_(most),
        coefficient_(coefficient),
        exponent_(exponent) {}

  ActivationScheme scheme() const { return scheme_; }
  double total() const { return total_; }

  /// Number activated at supersaturation s > 0 and a temperature.
  ///
  /// Lognormal: Σ ½ N_i erfc(u_i), u_i = 2 ln(s_i/s)/(3√2 ln σ_i)
  /// (Abdul-Razzak & Ghan 2000, doi:10.1029/1999JD901161).
  double activated(double s, double temperature) const {
    if (!(s > 0)) return 0;
    if (scheme_ == ActivationScheme::twomey)
      return std::min(total_, coefficient_ * std::pow(100.0 * s, exponent_));
    double sum = 0;
    for (const AerosolMode& mode : modes_)
      sum += share(mode, s, critical_supersaturation(mode, temperature));
    return sum;
  }

  /// Critical supersaturation of a mode's mean radius: (2/√κ)(A/(3 r))^{3/2} with the Kelvin length
  /// A = 2σ/(ρ_w R_v T) (Petters & Kreidenweis 2007, doi:10.5194/acp-7-1961-2007).
  double critical_supersaturation(const AerosolMode& mode, double temperature) const {
    const double ratio = kelvin_ / (3.0 * temperature * mode.radius);
    return 2.0 / std::sqrt(mode.kappa) * ratio * std::sqrt(ratio);
  }

  struct Peak {
    double supersaturation;  // 1
    double activated;        // kg-1
  };
  /// Largest supersaturation in air whose supersaturation would rise by `forcing` (s-1) if nothing
  /// condensed, and the number it activates (Abdul-Razzak & Ghan 2000).
  ///
  /// `growth` is G, `sink` γ of `condensation_sink`, `density` that of air, kg m-3.
  Peak peak(double temperature, double forcing, double growth, double sink, double density) const {
    if (!(forcing > 0) || modes_.empty()) return {0, 0};
    const double ratio = forcing / growth;
    const double zeta = 2.0 / 3.0 * kelvin_ / temperature * std::sqrt(ratio);
    double sum = 0;
    for (const AerosolMode& mode : modes_) {
      if (!(mode.number > 0)) continue;
      const double s = critical_supersaturation(mode, temperature);
      const double width = std::log(mode.deviation);
      const double eta =
          ratio * std::sqrt(ratio) / (2.0 * pi * water_density * sink * mode.number * density);
      const double f = 0.5 * std::exp(2.5 * width * width), g = 1.0 + 0.25 * width;
      sum += (f * std::pow(zeta / eta, 1.5) + g * std::pow(s * s / (eta + 3.0 * zeta), 0.75)) /
             (s * s);
    }
    if (!(sum > 0)) return {0, 0};
    const double s = 1.0 / std::sqrt(sum);
    return {s, activated(s, temperature)};
  }

 private:
  static double share(const AerosolMode& mode, double s, double critical) {
    constexpr double three_root_two = 4.24264068711928514641;
    const double u = 2.0 * std::log(critical / s) / (three_root_two * std::log(mode.deviation));
    return 0.5 * mode.number * std::erfc(u);
  }

  ActivationScheme scheme_;
  std::vector<AerosolMode> modes_;
  double kelvin_ = 0;  // A·T, m K
  double total_ = 0;
  double coefficient_ = 0, exponent_ = 0;
};

/// γ: condensing one kg per m3 lowers the supersaturation by γ,
/// R_v T/e_s + (R_d/R_v) L²/(c_p T p) (Abdul-Razzak & Ghan 2000), m3 kg-1.
inline double condensation_sink(double temperature, double pressure, double vapour_pressure,
                                double latent_heat, double heat_capacity, double gas_constant,
                                double epsilon) {
  return gas_constant * temperature / vapour_pressure +
         epsilon * latent_heat * latent_heat / (heat_capacity * temperature * pressure);
}

}  // namespace pileus::two_moment
