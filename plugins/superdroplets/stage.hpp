// One implicit stage of all droplets of a parcel and the supersaturation they share.
#pragma once
#include <pileus/numerics.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "droplet_equation.hpp"

namespace pileus::superdroplets {

/// Arrays over a parcel's droplets.
struct DropletFields {
  std::size_t count = 0;
  double* weight = nullptr;    // kg of water per kg of air and unit of r³: 4/3 π ρ_w ξ/m
  double* dry = nullptr;       // as in DropletConstants
  double* solute = nullptr;    // as in DropletConstants
  double* floor = nullptr;     // as in DropletConstants
  double* start = nullptr;     // u at the beginning of the sub-step, m2
  double* base = nullptr;      // b of the stage
  double* area = nullptr;      // u of the stage
  double* shift = nullptr;     // Newton's step of u at fixed S
  double* response = nullptr;  // ∂u/∂S of the stage's equation
  double* damping = nullptr;   // 1/(∂g/∂u)
  const double* ventilation = nullptr;  // or none
  static constexpr std::size_t arrays = 10;

  DropletConstants constants(std::size_t i) const {
    return {dry[i], solute[i], floor[i], ventilation ? ventilation[i] : 1.0};
  }
};

/// Sums that add in a fixed order whatever the width of the machine's vectors: four lanes.
class LaneSum {
 public:
  /// Adds x[0 … n), n ≤ the capacity of x rounded up to lanes; what lies beyond n is cleared.
  void add(double* x, std::size_t n) {
    while (n % 4 != 0) x[n++] = 0.0;
    for (std::size_t i = 0; i < n; i += 4) {
      lane_[0] += x[i];
      lane_[1] += x[i + 1];
      lane_[2] += x[i + 2];
      lane_[3] += x[i + 3];
    }
  }
  double total() const { return (lane_[0] + lane_[2]) + (lane_[1] + lane_[3]); }

 private:
  double lane_[4] = {0, 0, 0, 0};
};

/// The system u_i = b_i + H f_i(u_i, S), i = 1 … n, S = S(q_l), q_l = Σ w_i (u_i^{3/2} − V_i).
///
/// Its matrix is an arrow: each droplet knows itself and S. Newton's method evaluates every droplet
/// once, eliminates it and steps S; a droplet that the linear step would lead astray takes the root
/// of its own equation at the present S instead.
class Stage {
 public:
  explicit Stage(const DropletFields& fields) : f_(fields) {}

  static constexpr std::size_t block = 128;  // droplets at a time, whose terms stay in the cache

  DropletEquation equation{};

  struct Sums {
    double water = 0;     // q_l
    double shift = 0;     // Σ ∂q_l/∂u_i shift_i
    double response = 0;  // Σ ∂q_l/∂u_i response_i
    long moved = 0;       // droplets whose u has just changed by more than `settled`
  };

  /// A relative change of u after which Newton's next step, about its square, leaves its fourth
  /// power.
  static constexpr double settled = 3e-3;

  /// u += shift + response·step (nothing for the first evaluation), then all terms at (u, S).
  Sums evaluate(double saturation, double step, bool first) {
    if (f_.ventilation)
      return first ? pass<true, true>(saturation, step) : pass<true, false>(saturation, step);
    return first ? pass<false, true>(saturation, step) : pass<false, false>(saturation, step);
  }

  /// The last update alone. Returns q_l.
  double update(double saturation, double step) {
    LaneSum water;
    double w[block];
    const double ceiling = equation.ceiling(0, saturation, 1.0);
    for (std::size_t from = 0; from < f_.count; from += block) {
      const std::size_t n = std::min(block, f_.count - from);
      double* const u = f_.area + from;
      const double *const shift = f_.shift + from, *const response = f_.response + from;
      const double *const floor = f_.floor + from, *const base = f_.base + from;
      const double *const weight = f_.weight + from, *const dry = f_.dry + from;
      const double* const ventilation = f_.ventilation ? f_.ventilation + from : nullptr;
      for (std::size_t i = 0; i < n; ++i) {
        const double lower = floor[i] + 0.1 * (u[i] - floor[i]);
        const double upper = base[i] + ceiling * (ventilation ? ventilation[i] : 1.0);
        double next = u[i] + (shift[i] + response[i] * step);
        next = next > upper ? upper : next;
        next = next < lower ? lower : next;
        u[i] = next;
        const double wet = next * std::sqrt(next) - dry[i];
        w[i] = weight[i] * (wet > 0 ? wet : 0.0);
      }
      water.add(w, n);
    }
    return water.total();
  }

  /// Puts droplets that have gone past their critical size without a root to go to back on their
  /// branch. Returns how many.
  long keep_branches(double saturation) {
    long strayed = 0;
    const double slope = 3.0 / equation.kelvin;
    for (std::size_t i = 0; i < f_.count; ++i) {
      const double top = f_.solute[i] * slope;
      if ((f_.base[i] < top) == (f_.area[i] < top)) continue;
      const double root = equation.root(f_.base[i], saturation, f_.constants(i));
      if (std::abs(root - f_.area[i]) <= 1e-3 * root) continue;
      f_.area[i] = root;
      ++strayed;
    }
    return strayed;
  }

  /// Every droplet at the root of its equation at S. Returns q_l, and Σ ∂q_l/∂u_i ∂u_i/∂S.
  numerics::ValueAndSlope solve_each(double saturation) {
    double water = 0, response = 0;
    for (std::size_t i = 0; i < f_.count; ++i) {
      const DropletEquation::Terms t = settle(i, saturation);
      water += f_.weight[i] * t.volume;
      response += 1.5 * f_.weight[i] * t.radius * f_.response[i];
    }
    return {water, response};
  }

 private:
  static constexpr double steepest = 0.2;  // ∂g/∂u below which Newton's step is not trusted

  DropletEquation::Terms settle(std::size_t i, double saturation) {
    const DropletConstants c = f_.constants(i);
    const double u = equation.root(f_.base[i], saturation, c);
    const DropletEquation::Terms t = equation.at(u, f_.base[i], saturation, c);
    const bool dry = u <= c.floor && t.residual >= 0;
    const double damping = 1.0 / std::max(steepest, t.slope);
    f_.area[i] = u;
    f_.shift[i] = 0;
    f_.response[i] = dry ? 0.0 : t.drive * damping;
    f_.damping[i] = dry ? 0.0 : damping;
    return t;
  }

  /// The terms of a block of droplets that are summed.
  struct Block {
    double water[block], shift[block], response[block], moved[block], astray[block];
  };

  template <bool ventilated, bool first>
  Sums pass(double saturation, double step) {
    LaneSum water, shift, response, moved;
    Block b;
    for (std::size_t from = 0; from < f_.count; from += block) {
      const std::size_t n = std::min(block, f_.count - from);
      evaluate_block<ventilated, first>(b, from, n, saturation, step);
      double any = 0;
      for (std::size_t i = 0; i < n; ++i) any += b.astray[i];
      if (any > 0) settle_astray(b, from, n, saturation);
      water.add(b.water, n);
      shift.add(b.shift, n);
      response.add(b.response, n);
      moved.add(b.moved, n);
    }
    return {water.total(), shift.total(), response.total(), static_cast<long>(moved.total())};
  }

  template <bool ventilated, bool first>
  void evaluate_block(Block& b, std::size_t from, std::size_t n, double saturation, double step) {
    double* __restrict const u = f_.area + from;
    double* __restrict const shift = f_.shift + from;
    double* __restrict const response = f_.response + from;
    double* __restrict const damping = f_.damping + from;
    const double *const floor = f_.floor + from, *const base = f_.base + from;
    const double *const weight = f_.weight + from, *const dry = f_.dry + from;
    const double* const solute = f_.solute + from;
    const double* const ventilation = ventilated ? f_.ventilation + from : nullptr;
    const DropletEquation e = equation;
    const double ceiling = e.ceiling(0, saturation, 1.0);
#pragma GCC ivdep
    for (std::size_t i = 0; i < n; ++i) {
      const double factor = ventilated ? ventilation[i] : 1.0;
      const double now = u[i];
      const double lower = floor[i] + 0.1 * (now - floor[i]);
      const double upper = base[i] + ceiling * factor;
      const double target = first ? now : now + (shift[i] + response[i] * step);
      const double above = now > floor[i] ? 1.0 : 0.0, low = target < lower ? 1.0 : 0.0;
      double next = target > upper ? upper : target;
      next = next < lower ? lower : next;
      u[i] = next;
      b.moved[i] = std::abs(next - now) > settled * next ? 1.0 : 0.0;
      const DropletEquation::Terms t =
          e.at(next, base[i], saturation, {dry[i], solute[i], floor[i], factor});
      const double off = next > floor[i] ? 1.0 : 0.0, rising = t.residual < 0 ? 1.0 : 0.0;
      const double open = off > rising ? off : rising;
      const double slope = t.slope > steepest ? t.slope : steepest;
      const double steep = t.slope < steepest ? 1.0 : 0.0;
      b.astray[i] = open * steep + above * low;
      const double inverse = open / slope, area = 1.5 * weight[i] * t.radius;
      const double moves = -t.residual * inverse, responds = t.drive * inverse;
      damping[i] = inverse;
      shift[i] = moves;
      response[i] = responds;
      b.water[i] = weight[i] * t.volume;
      b.shift[i] = area * moves;
      b.response[i] = area * responds;
    }
  }

  void settle_astray(Block& b, std::size_t from, std::size_t n, double saturation) {
    for (std::size_t k = 0; k < n; ++k) {
      if (!(b.astray[k] > 0)) continue;
      const std::size_t i = from + k;
      const double before = f_.area[i];
      const DropletEquation::Terms t = settle(i, saturation);
      b.moved[k] = std::abs(f_.area[i] - before) > settled * f_.area[i] ? 1.0 : 0.0;
      b.water[k] = f_.weight[i] * t.volume;
      b.shift[k] = 0;
      b.response[k] = 1.5 * f_.weight[i] * t.radius * f_.response[i];
    }
  }

  DropletFields f_;
};

}  // namespace pileus::superdroplets
