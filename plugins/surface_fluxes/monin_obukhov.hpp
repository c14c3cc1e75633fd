// The turbulent fluxes of the surface layer by the similarity theory of Monin & Obukhov.
//
//   U = (u*/κ) F_m,  θ_1 − θ_s = (θ*/κ) F_h   with   F = ln(z_1/z_0) − ψ(z_1/L) + ψ(z_0/L)
//   L = −u*³ θ_00/(κ g <w'θ_v'>),  <w'θ'> = −u* θ*
//
// One equation remains for ζ = z_1/L. It is solved for ln|ζ| in a bracket, see
// numerics::bracketed_root.
#pragma once
#include <pileus/numerics.hpp>

#include <algorithm>
#include <cmath>

#include "stability_functions.hpp"

namespace pileus::surface {

struct SimilaritySettings {
  StabilityFunctions functions = StabilityFunctions::businger_dyer;
  double von_karman = 0.4;
  double gravity = 9.81;                 // m s-2
  double reference_temperature = 300.0;  // θ_00, K
  double gust_factor = 1.2;              // β of Beljaars 1995
  double gust_depth = 1000.0;            // of the convective layer, m; 0: no gusts
  double least_wind = 0.1;               // m s-1
};

/// The surface and the height of the first level above it.
struct SurfaceLayer {
  double height;          // z_1, m
  double roughness;       // z_0, m, below z_1/2
  double heat_roughness;  // z_0h, m, below z_1/2
};

/// What the ground and the air at z_1 exchange.
struct Exchange {
  double friction_velocity = 0;  // u*, m s-1
  double wind = 0;               // U, gusts included, m s-1
  double stability = 0;          // ζ = z_1/L
  double transfer = 0;  // m s-1; <w'φ'> = transfer (φ_s − φ_1) for temperature and humidity
  bool coupled = true;  // false: beyond the largest downward flux, nothing is exchanged
  int evaluations = 0;  // of the profile functions
  /// Stress over wind, m s-1: τ = drag u.
  double drag() const { return wind > 0 ? friction_velocity * friction_velocity / wind : 0.0; }
};

/// ζ is looked for between these, and between their negatives; below is neutral.
inline constexpr double least_stability = 1e-30, greatest_stability = 1e20;
/// Tolerance of ln|ζ|: ζ is right to this part, u* and the fluxes to a smaller one.
inline constexpr double stability_tolerance = 1e-12;
/// ln(1e50)/1e-12 is less than 2^47: no search evaluates the profiles more often.
inline constexpr int most_similarity_evaluations = 5 + 3 * 47;

class Similarity {
 public:
  Similarity(const SimilaritySettings& settings, const SurfaceLayer& layer)
      : s_(settings),
        layer_(layer),
        log_m_(std::log(layer.height / layer.roughness)),
        log_h_(std::log(layer.height / layer.heat_roughness)) {}

  /// Of a given flux <w'θ_v'> (K m s-1).
  ///
  /// Where it is downward, the layer has to carry it. If the flux that a wind can carry has a
  /// maximum over ζ, the branch of solutions from neutral ends there, and beyond it the air is
  /// decoupled from the ground, u* = 0. With Dyer's functions, capped at ζ = 1, a smooth ground,
  /// ln(z_1/z_0) > 10 (1 − z_0/z_1), has no maximum: u* falls on towards κU/(6 ln(z_1/z_0)).
  Exchange of_flux(double speed, double flux) const {
    const double gust = gust_speed(std::max(flux, 0.0));
    const double wind = effective_wind(speed, gust);
    // s = |ζ| solves s = c F_m³.
    const double c =
        layer_.height * s_.gravity * std::abs(flux) /
        (s_.reference_temperature * s_.von_karman * s_.von_karman * wind * wind * wind);
    if (!(c > 0)) return at(0.0, wind, 0);
    const double sign = flux > 0 ? -1.0 : 1.0;
    const auto excess = [&](double log_s) {
      return log_s - std::log(c) - 3.0 * std::log(profile_m(sign * std::exp(log_s)));
    };
    const double high = flux > 0 ? std::log(greatest_stability) : std::log(end_of_branch());
    // Rounding of the end itself is no reason to decouple.
    if (flux < 0 && excess(high) < -1e-12) return decoupled(wind);
    const numerics::Root root =
        numerics::bracketed_root(excess, std::log(least_stability), high, stability_tolerance);
    return at(sign * std::exp(root.x), wind, root.iterations);
  }

  /// Of a given difference θ_v(z_1) − θ_v(surface), K: |ζ| F_h U²/F_m² = z_1 g |Δθ_v|/θ_00. Gusts
  /// grow with the flux and are part of the equation. Has a solution for any difference.
  Exchange of_difference(double speed, double difference) const {
    const double target =
        layer_.height * s_.gravity * std::abs(difference) / s_.reference_temperature;
    const double calm = effective_wind(speed, 0);
    if (!(target > 0)) return at(0.0, calm, 0);
    const double sign = difference < 0 ? -1.0 : 1.0;
    const auto excess = [&](double log_s) {
      const double zeta = sign * std::exp(log_s);
      const double wind = wind_with_gusts(speed, zeta, difference);
      return log_s + std::log(profile_h(zeta) / target) + 2.0 * std::log(wind / profile_m(zeta));
    };
    const numerics::Root root = numerics::bracketed_root(
        excess, std::log(least_stability), std::log(greatest_stability), stability_tolerance);
    const double zeta = sign * std::exp(root.x);
    return at(zeta, wind_with_gusts(speed, zeta, difference), root.iterations);
  }

  /// F_m and F_h. They are integrals of φ/z from z_0 to z_1, positive for every ζ.
  double profile_m(double zeta) const {
    return std::max(log_m_ - psi_m(s_.functions, zeta) +
                        psi_m(s_.functions, zeta * layer_.roughness / layer_.height),
                    least_profile);
  }
  double profile_h(double zeta) const {
    return std::max(log_h_ - psi_h(s_.functions, zeta) +
                        psi_h(s_.functions, zeta * layer_.heat_roughness / layer_.height),
                    least_profile);
  }

 private:
  static constexpr double least_profile = 1e-12;  // where rounding has eaten the difference

  Exchange at(double zeta, double wind, int evaluations) const {
    Exchange e;
    e.wind = wind;
    e.stability = zeta;
    e.friction_velocity = s_.von_karman * wind / profile_m(zeta);
    e.transfer = e.friction_velocity * s_.von_karman / profile_h(zeta);
    e.evaluations = evaluations;
    return e;
  }
  static Exchange decoupled(double wind) {
    Exchange e;
    e.wind = wind;
    e.stability = greatest_stability;
    e.coupled = false;
    return e;
  }
  double effective_wind(double speed, double gust) const {
    return std::hypot(std::max(speed, s_.least_wind), gust);
  }
  /// β w* with w*³ = g <w'θ_v'> z_i/θ_00 (Beljaars 1995, doi:10.1002/qj.49712152203).
  double gust_speed(double flux) const {
    return s_.gust_factor * std::cbrt(s_.gravity * flux * s_.gust_depth / s_.reference_temperature);
  }
  /// U of U² = speed² + β² w*², where w*³ is in proportion to the flux u* κ |Δθ_v|/F_h and so to U.
  double wind_with_gusts(double speed, double zeta, double difference) const {
    const double least = effective_wind(speed, 0);
    if (!(difference < 0) || s_.gust_factor == 0 || s_.gust_depth == 0) return least;
    const double flux = s_.von_karman * s_.von_karman * -difference /
                        (profile_m(zeta) * profile_h(zeta));  // per wind
    const double gust = gust_speed(flux);
    // t = U^{2/3} solves t³ − gust² t = speed²: one positive root.
    return std::max(std::pow(positive_root(gust * gust, least * least), 1.5), least);
  }
  /// The positive root of t³ = p t + q, p, q ≥ 0, by Cardano's formulas.
  static double positive_root(double p, double q) {
    const double half = 0.5 * q, third = p / 3.0;
    const double discriminant = half * half - third * third * third;
    if (discriminant < 0) {
      const double r = std::sqrt(third);
      return 2.0 * r * std::cos(std::acos(half / (r * r * r)) / 3.0);
    }
    const double u = std::cbrt(half + std::sqrt(discriminant));
    return u + third / u;
  }

  /// The first ζ > 0 at which s/F_m³, the downward flux carried, grows no more:
  /// F_m = 3 (φ_m(ζ) − φ_m(ζ z_0/z_1)); greatest_stability if it always grows.
  double end_of_branch() const {
    const auto falls = [&](double log_zeta) {
      const double zeta = std::exp(log_zeta);
      return 3.0 * (stable_phi_m(s_.functions, zeta) -
                    stable_phi_m(s_.functions, zeta * layer_.roughness / layer_.height)) -
             profile_m(zeta);
    };
    if (s_.functions == StabilityFunctions::businger_dyer) {
      // Up to ζ = 1 it is F_m = 15 ζ (1 − z_0/z_1); beyond, φ grows no more and F_m does, so that
      // what has not ended by then never ends.
      const double end = log_m_ / (10.0 * (1.0 - layer_.roughness / layer_.height));
      return end <= 1 ? end : greatest_stability;
    }
    return std::exp(numerics::bracketed_root(falls, std::log(least_stability), std::log(1e6),
                                             stability_tolerance)
                        .x);
  }

  SimilaritySettings s_;
  SurfaceLayer layer_;
  double log_m_, log_h_;
};

/// Roughness of the sea by its waves: Charnock's α u*²/g and what smooth flow has, 0.11 ν/u*; for
/// heat and vapour COARE 3.0 (Fairall et al. 2003): min(1.1e-4 m, 5.5e-5 Rr^{-0.6}), Rr = z_0 u*/ν.
struct Charnock {
  double parameter = 0.011;   // α
  double viscosity = 1.5e-5;  // ν of air, m2 s-1
  double gravity = 9.81;      // m s-2

  SurfaceLayer layer(double height, double friction_velocity) const {
    const double u = friction_velocity;
    const double z = parameter * u * u / gravity + 0.11 * viscosity / u;
    const double reynolds = z * u / viscosity;
    // No wave is as high as the air that is looked at; the bound makes every u* a valid argument.
    const double most = 0.25 * height;
    return {height, std::min(z, most), std::min({1.1e-4, 5.5e-5 * std::pow(reynolds, -0.6), most})};
  }
};

/// u* is looked for between these, m s-1.
inline constexpr double least_friction = 1e-5, greatest_friction = 1e3;

/// The exchange over a sea whose roughness belongs to u*. `solve(layer)` is one of the searches
/// above. The bracket is that of ln u*: what a rougher or smoother sea would make of its own u*.
template <class Solve>
Exchange over_waves(const Charnock& sea, double height, Solve&& solve) {
  int evaluations = 0;
  const auto excess = [&](double log_u) {
    const Exchange e = solve(sea.layer(height, std::exp(log_u)));
    evaluations += e.evaluations;
    return log_u - std::log(std::max(e.friction_velocity, 0.1 * least_friction));
  };
  const numerics::Root root = numerics::bracketed_root(
      excess, std::log(least_friction), std::log(greatest_friction), stability_tolerance);
  Exchange result = solve(sea.layer(height, std::exp(root.x)));
  result.evaluations += evaluations;
  return result;
}

}  // namespace pileus::surface
