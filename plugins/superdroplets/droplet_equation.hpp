// One droplet's implicit equation for its squared radius, and its root on the droplet's own branch.
#pragma once
#include <pileus/numerics.hpp>

#include <algorithm>
#include <cmath>

#include "growth.hpp"

namespace pileus::superdroplets {

/// Radius below which no droplet of water is followed, m: less than a molecule.
inline constexpr double smallest_radius = 1e-10;

/// A droplet's constants, in units of r³: volumes over 4π/3.
struct DropletConstants {
  double dry;          // V_d
  double solute;       // κ V_d
  double floor;        // u of the dry particle, m2
  double ventilation;  // factor of its growth
};

/// u = b + H f(u, S), f = du/dt = 2 (S − S_eq(√u))·conductance, of a duration H (s) from a base b.
struct DropletEquation {
  double duration = 0;
  double kelvin = 0;  // A, m
  Conductance conductance{};

  static constexpr double settled = 1e-11;  // last relative change of a root
  static constexpr int most_steps = 60;     // of a search along a branch

  struct Terms {
    double radius, volume;  // r and r³ − V_d
    double residual;        // g = u − b − H f
    double slope;           // ∂g/∂u
    double drive;           // −∂g/∂S
  };

  /// One square root, two divisions, one exponential; no branches, for loops of vector code.
  Terms at(double u, double base, double saturation, const DropletConstants& c) const {
    const double r = std::sqrt(u), inverse = 1.0 / r;
    const double wet = u * r - c.dry;
    const double v = wet > 0 ? wet : 0.0;
    const double sum = v + c.solute;
    const double solution = sum > 1e-200 ? sum : 1e-200;  // a pure or dry one: activity 1
    const Conductance& k = conductance;
    const double n = ((r + k.n2) * r + k.n1) * r, slope_n = (3.0 * r + 2.0 * k.n2) * r + k.n1;
    const double q = ((k.q3 * r + k.q2) * r + k.q1) * r + k.q0;
    const double slope_q = (3.0 * k.q3 * r + 2.0 * k.q2) * r + k.q1;
    const double both = 1.0 / (solution * q);  // two divisions for the price of one
    const double per_q = both * solution, per_solution = both * q;
    const double g = c.ventilation * n * per_q;
    const double slope_g = (c.ventilation * slope_n - g * slope_q) * per_q;
    const double a = kelvin * inverse, curvature = numerics::vector_exp(a);
    const double share = c.solute * per_solution, activity = 1.0 - share;
    const double excess = saturation - activity * curvature;
    // ∂S_eq/∂u
    const double slope_s =
        curvature * (1.5 * r * share * per_solution - 0.5 * activity * a * inverse * inverse);
    const double twice = 2.0 * duration;
    return {r, v, u - base - twice * excess * g,
            1.0 - twice * (0.5 * excess * slope_g * inverse - slope_s * g), twice * g};
  }

  /// S_eq of u.
  double equilibrium(double u, double dry, double solute) const {
    const double r = std::sqrt(u), wet = u * r - dry;
    const double sum = (wet > 0 ? wet : 0.0) + solute;
    const double activity = 1.0 - solute / (sum > 1e-200 ? sum : 1e-200);
    return activity * numerics::vector_exp(kelvin / r);
  }

  /// u where S_eq has about its maximum: 3 κV_d/A (exact for V_d ≪ r³), not below the dry size.
  double critical(const DropletConstants& c) const {
    return std::max(c.floor, 3.0 * c.solute / kelvin);
  }

  /// No root lies above: S_eq ≥ 0, and growth is fastest without jumps.
  double ceiling(double base, double saturation, double factor) const {
    const double s = saturation > 0 ? saturation : 0.0;
    return base + 2.0 * duration * s * factor * conductance.largest();
  }

  /// The root on the branch that starts at the base: a droplet that grows takes the first root
  /// above the base, one that shrinks the first below. Between base and root lies no equilibrium,
  /// as on the way of the differential equation at fixed S.
  ///
  /// Requires   base ≥ floor
  /// Ensures    floor ≤ u; the floor itself: the water has evaporated
  double root(double base, double saturation, const DropletConstants& c) const {
    const auto g = [&](double u) -> numerics::ValueAndSlope {
      const Terms t = at(u, base, saturation, c);
      return {t.residual, t.slope};
    };
    const double start = g(base).value;
    if (start == 0) return base;
    const double top = critical(c);
    if (start < 0) {
      double low = base, high = ceiling(base, saturation, c.ventilation) * (1.0 + 1e-12);
      if (low < top && top < high) (g(top).value > 0 ? high : low) = top;
      return numerics::bracketed_newton(g, low, high, low, settled).x;
    }
    if (!(base > c.floor)) return c.floor;
    double low = c.floor, high = base;
    const bool soluble = c.solute > 0;
    if (base > top || !soluble) {
      // Where S_eq falls with u: Newton's method downhill, each step at most most of the way to the
      // end of the branch, until g has changed sign or the end has come.
      const double end = soluble ? top : c.floor;
      double u = base;
      for (int i = 0; i < most_steps && u > end * (1.0 + 1e-9); ++i) {
        const numerics::ValueAndSlope now = g(u);
        if (now.value <= 0) return numerics::bracketed_newton(g, u, high, u, settled).x;
        high = u;
        const double next = now.slope > 0 ? u - now.value / now.slope : end;
        if (u - next <= settled * u) return next;
        u = std::max(next, end + 0.2 * (u - end));
      }
      if (!soluble) return c.floor;
      (g(top).value < 0 ? low : high) = top;
    }
    if (g(low).value >= 0) return low;
    return numerics::bracketed_newton(g, low, high, high, settled).x;
  }
};

}  // namespace pileus::superdroplets
