// Advancing shape matrices in a locally linear flow: dB/dt = S B + B Sᵀ
// (McKiver and Dritschel 2003, J. Fluid Mech. 474, 147), written over a double or a Pack.
#pragma once
#include "parcels/ellipsoid.hpp"

namespace pileus::PILEUS_ISA {

/// A 3×3 matrix row by row; for velocity gradients S_ij = ∂u_i/∂x_j.
template <class T>
struct Matrix3 {
  T xx, xy, xz, yx, yy, yz, zx, zy, zz;
};
template <class T>
struct Matrix2 {
  T xx, xz, zx, zz;
};

template <class T>
static inline Matrix3<T> product(const Matrix3<T>& a, const Matrix3<T>& b) {
  return {a.xx * b.xx + a.xy * b.yx + a.xz * b.zx, a.xx * b.xy + a.xy * b.yy + a.xz * b.zy,
          a.xx * b.xz + a.xy * b.yz + a.xz * b.zz, a.yx * b.xx + a.yy * b.yx + a.yz * b.zx,
          a.yx * b.xy + a.yy * b.yy + a.yz * b.zy, a.yx * b.xz + a.yy * b.yz + a.yz * b.zz,
          a.zx * b.xx + a.zy * b.yx + a.zz * b.zx, a.zx * b.xy + a.zy * b.yy + a.zz * b.zy,
          a.zx * b.xz + a.zy * b.yz + a.zz * b.zz};
}
template <class T>
static inline Matrix3<T> combine(double c, const Matrix3<T>& a, double d, const Matrix3<T>& b) {
  return {c * a.xx + d * b.xx, c * a.xy + d * b.xy, c * a.xz + d * b.xz,
          c * a.yx + d * b.yx, c * a.yy + d * b.yy, c * a.yz + d * b.yz,
          c * a.zx + d * b.zx, c * a.zy + d * b.zy, c * a.zz + d * b.zz};
}
template <class T>
static inline Matrix3<T> plus_identity(double c, Matrix3<T> a) {
  a.xx = a.xx + c;
  a.yy = a.yy + c;
  a.zz = a.zz + c;
  return a;
}
template <class T>
static inline Matrix3<T> scaled(const T& s, const Matrix3<T>& a) {
  return {s * a.xx, s * a.xy, s * a.xz, s * a.yx, s * a.yy, s * a.yz, s * a.zx, s * a.zy, s * a.zz};
}
template <class T, class M>
static inline Matrix3<T> select(const M& m, const Matrix3<T>& a, const Matrix3<T>& b) {
  return {select(m, a.xx, b.xx), select(m, a.xy, b.xy), select(m, a.xz, b.xz),
          select(m, a.yx, b.yx), select(m, a.yy, b.yy), select(m, a.yz, b.yz),
          select(m, a.zx, b.zx), select(m, a.zy, b.zy), select(m, a.zz, b.zz)};
}

/// Degree-8 Taylor polynomial of the exponential in three matrix products
/// (Bader, Blanes and Casas 2019, doi:10.3390/math7121174, free parameter x₃ = 2/3).
template <class T>
static inline Matrix3<T> taylor8(const Matrix3<T>& a) {
  constexpr double x1 = 0.10836465678522780852, x2 = 0.02709116419630695213, x3 = 2.0 / 3.0,
                   x4 = 0.54676145797072405251, x5 = 0.16112557339541759283,
                   x6 = 0.01409091715837820773, x7 = 0.03379279701087050414,
                   y2 = 0.13549236135285063166;
  const Matrix3<T> a2 = product(a, a);
  const Matrix3<T> a4 = product(a2, combine(x1, a, x2, a2));
  const Matrix3<T> left = combine(x3, a2, 1.0, a4);
  const Matrix3<T> right = plus_identity(x4, combine(1.0, combine(x5, a, x6, a2), x7, a4));
  const Matrix3<T> a8 = product(left, right);
  return plus_identity(1.0, combine(1.0, combine(1.0, a, y2, a2), 1.0, a8));
}

/// Largest Frobenius norm the polynomial is used for; its error there is below
/// 0.15⁹/9! = 1.1e-13, and larger arguments are halved and the result squared.
inline constexpr double taylor8_radius = 0.15;
inline constexpr int most_squarings = 24;

/// exp(A) by scaling and squaring; the number of squarings is chosen for every lane by itself, so
/// that a parcel's result does not depend on its neighbours in memory.
template <class T>
static inline Matrix3<T> exponential(const Matrix3<T>& a) {
  T norm = square_root(a.xx * a.xx + a.xy * a.xy + a.xz * a.xz + a.yx * a.yx + a.yy * a.yy +
                       a.yz * a.yz + a.zx * a.zx + a.zy * a.zy + a.zz * a.zz);
  T scale = norm * 0.0 + 1.0;
  T squarings = norm * 0.0;
  for (int i = 0; i < most_squarings; ++i) {
    const auto large = norm > taylor8_radius;
    if (!any(large)) break;
    norm = select(large, norm * 0.5, norm);
    scale = select(large, scale * 0.5, scale);
    squarings = select(large, squarings + 1.0, squarings);
  }
  Matrix3<T> e = taylor8(scaled(scale, a));
  for (int i = 0; i < most_squarings; ++i) {
    const auto wanted = squarings > double(i);
    if (!any(wanted)) break;
    e = select(wanted, product(e, e), e);
  }
  return e;
}

/// E B Eᵀ
template <class T>
static inline Symmetric3<T> congruence(const Matrix3<T>& e, const Symmetric3<T>& b) {
  const Matrix3<T> full{b.xx, b.xy, b.xz, b.xy, b.yy, b.yz, b.xz, b.yz, b.zz};
  const Matrix3<T> m = product(e, full);
  return {m.xx * e.xx + m.xy * e.xy + m.xz * e.xz, m.xx * e.yx + m.xy * e.yy + m.xz * e.yz,
          m.xx * e.zx + m.xy * e.zy + m.xz * e.zz, m.yx * e.yx + m.yy * e.yy + m.yz * e.yz,
          m.yx * e.zx + m.yy * e.zy + m.yz * e.zz, m.zx * e.zx + m.zy * e.zy + m.zz * e.zz};
}

/// S B + B Sᵀ
template <class T>
static inline Symmetric3<T> shape_rate(const Matrix3<T>& s, const Symmetric3<T>& b) {
  return {2.0 * (s.xx * b.xx + s.xy * b.xy + s.xz * b.xz),
          s.yx * b.xx + s.yy * b.xy + s.yz * b.xz + s.xx * b.xy + s.xy * b.yy + s.xz * b.yz,
          s.zx * b.xx + s.zy * b.xy + s.zz * b.xz + s.xx * b.xz + s.xy * b.yz + s.xz * b.zz,
          2.0 * (s.yx * b.xy + s.yy * b.yy + s.yz * b.yz),
          s.zx * b.xy + s.zy * b.yy + s.zz * b.yz + s.yx * b.xz + s.yy * b.yz + s.yz * b.zz,
          2.0 * (s.zx * b.xz + s.zy * b.yz + s.zz * b.zz)};
}

/// exp(A) of a traceless 2×2 matrix in closed form: A² = −det A · I, so
/// exp(A) = C I + H A with C = cosh √q, H = sinh √q/√q, q = −det A (cos and sin for q < 0). Both
/// are entire in q: a polynomial for small q, then doubling formulas C₂ = 2C²−1, H₂ = C H.
template <class T>
static inline Matrix2<T> exponential(const Matrix2<T>& a) {
  T q = a.xx * a.xx + a.xz * a.zx;
  T doublings = q * 0.0;
  for (int i = 0; i < most_squarings; ++i) {
    const auto large = absolute(q) > 0.5;
    if (!any(large)) break;
    q = select(large, q * 0.25, q);
    doublings = select(large, doublings + 1.0, doublings);
  }
  // The first terms left out, 0.5⁸/16! and 0.5⁸/17!, are below 2e-16.
  T c = 1.0 +
        q * (1.0 / 2 +
             q * (1.0 / 24 +
                  q * (1.0 / 720 +
                       q * (1.0 / 40320 + q * (1.0 / 3628800 + q * (1.0 / 479001600 +
                                                                    q * (1.0 / 87178291200.0)))))));
  T h = 1.0 +
        q * (1.0 / 6 +
             q * (1.0 / 120 +
                  q * (1.0 / 5040 + q * (1.0 / 362880 + q * (1.0 / 39916800 +
                                                             q * (1.0 / 6227020800.0 +
                                                                  q * (1.0 / 1307674368000.0)))))));
  for (int i = 0; i < most_squarings; ++i) {
    const auto wanted = doublings > double(i);
    if (!any(wanted)) break;
    // sinh(2x)/(2x) = (sinh x/x) cosh x
    h = select(wanted, h * c, h);
    c = select(wanted, 2.0 * c * c - 1.0, c);
  }
  return {c + h * a.xx, h * a.xz, h * a.zx, c - h * a.xx};
}
template <class T>
static inline Symmetric2<T> congruence(const Matrix2<T>& e, const Symmetric2<T>& b) {
  const T mxx = e.xx * b.xx + e.xz * b.xz, mxz = e.xx * b.xz + e.xz * b.zz;
  const T mzx = e.zx * b.xx + e.zz * b.xz, mzz = e.zx * b.xz + e.zz * b.zz;
  return {mxx * e.xx + mxz * e.xz, mxx * e.zx + mxz * e.zz, mzx * e.zx + mzz * e.zz};
}
template <class T>
static inline Symmetric2<T> shape_rate(const Matrix2<T>& s, const Symmetric2<T>& b) {
  return {2.0 * (s.xx * b.xx + s.xz * b.xz), s.zx * b.xx + s.zz * b.xz + s.xx * b.xz + s.xz * b.zz,
          2.0 * (s.zx * b.xz + s.zz * b.zz)};
}

}  // namespace pileus::PILEUS_ISA
