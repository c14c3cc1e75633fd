// The root of a function without its derivative, in a number of evaluations that is known before.
#pragma once
#include <cmath>

namespace pileus::surface {

struct BracketedRoot {
  double x;
  int evaluations;
};

/// Most evaluations of a search in an interval of `width` down to `tolerance`: every third halves
/// the bracket, so that three for each binary digit suffice, and two for the ends.
inline int most_evaluations(double width, double tolerance) {
  return 5 + 3 * static_cast<int>(std::ceil(std::log2(width / tolerance)));
}

/// Where an increasing function changes its sign in [low, high]: false position with the weights of
/// Illinois, and every third step a bisection. Ends when a step or the bracket is below
/// `tolerance`. Where the function does not change its sign, the end next to the root.
template <class F>
BracketedRoot bracketed_root(F&& f, double low, double high, double tolerance) {
  const int most = most_evaluations(high - low, tolerance);
  double at_low = f(low), at_high = f(high);
  if (!(at_low < 0)) return {low, 2};
  if (!(at_high > 0)) return {high, 2};
  double x = low, before = high;
  for (int n = 3; n <= most; ++n) {
    const double secant = high - at_high * (high - low) / (at_high - at_low);
    const bool halve = n % 3 == 2 || !(secant > low && secant < high);
    x = halve ? low + 0.5 * (high - low) : secant;
    const double at = f(x);
    if (at == 0 || high - low < tolerance || std::abs(x - before) < tolerance) return {x, n};
    // An end that stays for a second time counts half, so that the next step passes the root.
    if (at < 0) {
      if (low == before) at_high *= 0.5;
      low = x, at_low = at;
    } else {
      if (high == before) at_low *= 0.5;
      high = x, at_high = at;
    }
    before = x;
  }
  return {x, most};
}

}  // namespace pileus::surface
