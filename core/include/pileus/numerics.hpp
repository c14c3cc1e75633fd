// Numerical building blocks that cannot fail: bracketed roots, exact relaxation, a vector exp.
#pragma once
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace pileus::numerics {

/// Value and derivative of a function at one point.
struct ValueAndSlope {
  double value, slope;
};

/// What a root search found.
struct Root {
  double x = 0;
  int iterations = 0;      // evaluations of the function
  bool converged = false;  // false only for a NaN or for a root that is not bracketed
};

/// Steps within which `bracketed_newton` ends for every bracket of doubles: two per bisection
/// level, at most 2098 levels between the largest and the smallest double, far fewer in practice.
inline constexpr int bracketed_newton_limit = 4200;

/// The root of an increasing function inside [low, high], by Newton steps safeguarded by bisection.
///
/// A Newton step is taken only when it stays inside the bracket and is at most half as long as the
/// step before the last; otherwise the bracket is halved. Every evaluation moves one end of the
/// bracket to the point evaluated, so the search ends: steps shrink at least by two every second
/// evaluation. For convex functions Newton from the left lands right of the root after one step
/// and then descends monotonically and quadratically, and the safeguard never acts.
///
/// Requires   f(low) ≤ 0 ≤ f(high), f increasing; `start` inside the bracket (else its middle)
/// Ensures    low ≤ x ≤ high; the last Newton step was at most relative·|x| and was taken, or x is
///            within one unit in the last place of where f changes sign
/// Errors     converged == false when f returns NaN
template <class F>
Root bracketed_newton(F&& f, double low, double high, double start, double relative) {
  Root root;
  double x = start >= low && start <= high ? start : low + 0.5 * (high - low);
  double step_before = 2.0 * (high - low), step = step_before;  // any first step may be taken
  for (root.iterations = 1; root.iterations <= bracketed_newton_limit; ++root.iterations) {
    const ValueAndSlope at = f(x);
    if (std::isnan(at.value)) break;
    root.x = x;
    root.converged = at.value == 0;
    if (root.converged) break;
    (at.value < 0 ? low : high) = x;
    const double newton = -at.value / at.slope;
    double next = x + newton;
    if (std::abs(newton) <= relative * std::abs(x)) {
      root.x = next < low ? low : next > high ? high : next;
      root.converged = true;
      break;
    }
    const bool safe = next > low && next < high && std::abs(newton) <= 0.5 * std::abs(step_before);
    if (!safe) next = low + 0.5 * (high - low);
    root.converged = !(next > low && next < high);  // nothing lies between the bracket's ends
    if (root.converged) break;
    step_before = step;
    step = next - x;
    x = next;
  }
  return root;
}

/// Most evaluations of `bracketed_root` in a bracket of `width` down to `tolerance`: every third
/// halves the bracket, so that three for each binary digit suffice, and two for the ends.
inline int most_evaluations(double width, double tolerance) {
  return 5 + 3 * static_cast<int>(std::ceil(std::log2(width / tolerance)));
}

/// Where an increasing function changes its sign in [low, high], without its derivative and in a
/// number of evaluations that is known before: false position with the weights of Illinois, every
/// third step a bisection. Small steps alone are no end, since next to a steep side they creep: the
/// bracket is closed from its other side.
///
/// Ensures    low ≤ x ≤ high, within `tolerance` of where f changes its sign; the end next to the
///            root where it does not. A NaN between the ends counts as above the root
/// Errors     converged == false where the function does not change its sign
template <class F>
Root bracketed_root(F&& f, double low, double high, double tolerance) {
  const int most = most_evaluations(high - low, tolerance);
  double at_low = f(low), at_high = f(high);
  if (!(at_low < 0)) return {low, 2, at_low == 0};
  if (!(at_high > 0)) return {high, 2, at_high == 0};
  double x = low, before = high;
  for (int n = 3; n <= most; ++n) {
    const bool creeps = std::abs(x - before) < tolerance;
    double next = high - at_high * (high - low) / (at_high - at_low);
    if (creeps) next = x == low ? low + 0.5 * tolerance : high - 0.5 * tolerance;
    before = x;
    x = n % 3 != 2 && next > low && next < high ? next : low + 0.5 * (high - low);
    const double at = f(x);
    // An end that stays for a second time counts half, so that the next step passes the root.
    if (at < 0) {
      if (low == before) at_high *= 0.5;
      low = x, at_low = at;
    } else {
      if (high == before) at_low *= 0.5;
      high = x, at_high = at;
    }
    if (at == 0 || high - low <= tolerance) return {x, n, true};
  }
  return {x, most, true};
}

/// The part of its distance to a target that a decay of ratio = dt/time_scale ≥ 0 covers.
inline double relaxed_part(double ratio) {
  return -std::expm1(-ratio);
}

/// Exact solution after dt of dx/dt = (target − x)/time_scale, with ratio = dt/time_scale ≥ 0:
/// stable for every ratio, between x and target, and x itself bit for bit for ratio = 0.
inline double relaxed(double x, double target, double ratio) {
  return x + (target - x) * relaxed_part(ratio);
}

/// (1 − exp(−r))/r: the factor by which a constant source acts over a step during a decay of
/// r = dt/time_scale; 1 for r = 0.
inline double decay_mean(double r) {
  return r == 0 ? 1.0 : relaxed_part(r) / r;
}

/// exp(x) without branches or calls, so that loops over it become vector code.
///
/// Cody–Waite reduction x = n ln 2 + r, |r| ≤ ln(2)/2, and the Taylor polynomial of degree 13 (its
/// truncation error, |r|^14/14! < 4.2e-18, is far below rounding). Arguments are cut to
/// [−708, 709], so that neither 2^n nor the result leaves the normal numbers; NaN stays NaN.
/// Accuracy   2 units in the last place (tests/unit/host)
inline double vector_exp(double x) {
  constexpr double log2_e = 1.4426950408889634074;
  constexpr double ln2_high = 0x1.62e42fefa3800p-1;  // 41 bits: n·ln2_high is exact
  constexpr double ln2_low = 0x1.ef35793c76730p-45;
  constexpr double rounder = 0x1.8p52;  // adding it rounds to an integer held in the low bits
  x = x < -708.0 ? -708.0 : x;
  x = x > 709.0 ? 709.0 : x;
  const double shifted = x * log2_e + rounder;
  const double n = shifted - rounder;
  const double r = (x - n * ln2_high) - n * ln2_low;
  double p = 1.0 / 6227020800.0;
  p = p * r + 1.0 / 479001600.0;
  p = p * r + 1.0 / 39916800.0;
  p = p * r + 1.0 / 3628800.0;
  p = p * r + 1.0 / 362880.0;
  p = p * r + 1.0 / 40320.0;
  p = p * r + 1.0 / 5040.0;
  p = p * r + 1.0 / 720.0;
  p = p * r + 1.0 / 120.0;
  p = p * r + 1.0 / 24.0;
  p = p * r + 1.0 / 6.0;
  p = p * r + 0.5;
  p = (p * r) * r + r + 1.0;
  const std::uint64_t biased = (std::bit_cast<std::uint64_t>(shifted) + 1023u) << 52;
  return p * std::bit_cast<double>(biased);
}

}  // namespace pileus::numerics
