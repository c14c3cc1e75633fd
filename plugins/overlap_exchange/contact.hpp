// Whether and how nearly two ellipsoids touch.
#pragma once
#include <array>
#include <cmath>

namespace pileus::overlap {

template <int D>
using Vector = std::array<double, D>;

/// A symmetric matrix: xx xy xz yy yz zz, in the plane xx xz zz.
template <int D>
using Symmetric = std::array<double, D*(D + 1) / 2>;

template <int D>
Vector<D> product(const Symmetric<D>& m, const Vector<D>& x) {
  if constexpr (D == 3)
    return {m[0] * x[0] + m[1] * x[1] + m[2] * x[2], m[1] * x[0] + m[3] * x[1] + m[4] * x[2],
            m[2] * x[0] + m[4] * x[1] + m[5] * x[2]};
  else
    return {m[0] * x[0] + m[1] * x[1], m[1] * x[0] + m[2] * x[1]};
}
template <int D>
double dot(const Vector<D>& a, const Vector<D>& b) {
  double sum = 0;
  for (int i = 0; i < D; ++i) sum += a[i] * b[i];
  return sum;
}

/// Inverse of a positive definite matrix, by cofactors.
template <int D>
Symmetric<D> inverse(const Symmetric<D>& m) {
  if constexpr (D == 3) {
    const double xx = m[3] * m[5] - m[4] * m[4], xy = m[2] * m[4] - m[1] * m[5],
                 xz = m[1] * m[4] - m[2] * m[3];
    const double f = 1.0 / (m[0] * xx + m[1] * xy + m[2] * xz);
    return {f * xx,
            f * xy,
            f * xz,
            f * (m[0] * m[5] - m[2] * m[2]),
            f * (m[1] * m[2] - m[0] * m[4]),
            f * (m[0] * m[3] - m[1] * m[1])};
  } else {
    const double f = 1.0 / (m[0] * m[2] - m[1] * m[1]);
    return {f * m[2], -f * m[1], f * m[0]};
  }
}

struct Contact {
  double value = 0;     // F, or a lower bound of it that is above the limit
  double position = 0;  // s of the maximum
  int iterations = 0;
};

/// The contact function of Perram and Wertheim (1985, doi:10.1016/0021-9991(85)90171-8) of two
/// ellipsoids xᵀB⁻¹x ≤ 1 whose centres are `d` apart:
///
///   F = max over 0 < s < 1 of  g(s) = s(1−s) dᵀ[s B₁ + (1−s) B₂]⁻¹ d
///
/// They overlap exactly when F ≤ 1 (the test of Gilitschenski and Hanebeck 2012), and √F is the
/// factor by which both must grow about their centres to touch. g is concave: with
/// x = [s B₁ + (1−s) B₂]⁻¹ d its slope is (1−s)² xᵀB₂x − s² xᵀB₁x, and Newton's method from s = ½,
/// held inside the bracket, needs four to six steps. The search ends as soon as g exceeds `limit`.
template <int D>
Contact contact_function(const Symmetric<D>& b1, const Symmetric<D>& b2, const Vector<D>& d,
                         double limit) {
  constexpr int most = 60;  // bisection alone would be done by then
  double low = 0, high = 1, s = 0.5;
  Contact best;
  for (best.iterations = 1; best.iterations <= most; ++best.iterations) {
    Symmetric<D> mixed;
    for (std::size_t c = 0; c < mixed.size(); ++c) mixed[c] = s * b1[c] + (1 - s) * b2[c];
    const Symmetric<D> inverted = inverse<D>(mixed);
    const Vector<D> x = product<D>(inverted, d);
    const double g = s * (1 - s) * dot<D>(d, x);
    if (g >= best.value) best.value = g, best.position = s;
    if (g > limit) break;
    const Vector<D> b1x = product<D>(b1, x), b2x = product<D>(b2, x);
    const double slope = (1 - s) * (1 - s) * dot<D>(x, b2x) - s * s * dot<D>(x, b1x);
    const double curvature = -2 * dot<D>(b1x, product<D>(inverted, b2x));
    (slope > 0 ? low : high) = s;
    double next = s - slope / curvature;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    // An error δ of s changes g by ½ g″ δ².
    if (std::abs(next - s) < 1e-8) break;
    s = next;
  }
  return best;
}

}  // namespace pileus::overlap
