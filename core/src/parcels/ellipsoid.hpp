// Geometry of one parcel: principal axes of its shape matrix B and its support points.
//
// Written over the number type T, a double or a Pack of eight, without branches.
// An ellipsoid is { x : xᵀ B⁻¹ x ≤ 1 }; the eigenvalues of B are its squared semi-axes a² ≥ b² ≥
// c².
#pragma once
#include "parcels/simd.hpp"

namespace pileus::PILEUS_ISA {

/// Symmetric 3×3 matrix, upper triangle row by row.
template <class T>
struct Symmetric3 {
  T xx, xy, xz, yy, yz, zz;
};
/// Symmetric 2×2 matrix in the x–z plane.
template <class T>
struct Symmetric2 {
  T xx, xz, zz;
};
template <class T>
struct Vector3 {
  T x, y, z;
};

template <class T>
static inline Vector3<T> cross(const Vector3<T>& a, const Vector3<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
static inline T dot(const Vector3<T>& a, const Vector3<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T, class M>
static inline Vector3<T> select(const M& m, const Vector3<T>& a, const Vector3<T>& b) {
  return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
}
template <class T>
static inline Vector3<T> scaled(const T& s, const Vector3<T>& a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class T>
static inline Vector3<T> times(const Symmetric3<T>& m, const Vector3<T>& a) {
  return {m.xx * a.x + m.xy * a.y + m.xz * a.z, m.xy * a.x + m.yy * a.y + m.yz * a.z,
          m.xz * a.x + m.yz * a.y + m.zz * a.z};
}

template <class T>
struct PrincipalAxes3 {
  T a2, b2, c2;              // squared semi-axes, descending
  Vector3<T> major, middle;  // unit vectors of a and b
};

/// Eigen-decomposition by deflation: the best separated eigenvalue of the deviator first, from the
/// depressed cubic, then the remaining 2×2 problem (method of Scherzinger and Dohrmann 2008,
/// doi:10.1016/j.cma.2008.03.031, with the cubic's root by Newton steps instead of arccosines).
/// Every threshold is relative to the matrix, so units of length do not matter. For a sphere the
/// axes are arbitrary orthonormal vectors.
template <class T>
static inline PrincipalAxes3<T> principal_axes(const Symmetric3<T>& b) {
  const T mean = (b.xx + b.yy + b.zz) * (1.0 / 3.0);
  // Work on the deviator scaled to order one, so that squares and cubes neither over- nor
  // underflow.
  const T inverse_mean = 1.0 / mean;
  Symmetric3<T> d{(b.xx - mean) * inverse_mean, b.xy * inverse_mean, b.xz * inverse_mean,
                  (b.yy - mean) * inverse_mean, b.yz * inverse_mean, (b.zz - mean) * inverse_mean};
  const T j2 =
      0.5 * (d.xx * d.xx + d.yy * d.yy + d.zz * d.zz) + d.xy * d.xy + d.xz * d.xz + d.yz * d.yz;
  const T j3 = d.xx * (d.yy * d.zz - d.yz * d.yz) - d.xy * (d.xy * d.zz - d.yz * d.xz) +
               d.xz * (d.xy * d.yz - d.yy * d.xz);
  // Below this the shape is a sphere to rounding; the floor keeps the divisions finite.
  const T p2 = maximum(j2 * (1.0 / 3.0), j2 * 0.0 + 1e-32);
  const T p = square_root(p2);
  const T r_signed = 0.5 * j3 / (p2 * p);
  const auto prolate = r_signed >= 0.0;  // the separated eigenvalue is the largest
  const T r = minimum(absolute(r_signed), r_signed * 0.0 + 1.0);
  // Root x = 2 cos(arccos(r)/3) in [√3, 2] of x³ − 3x = 2r. The quadratic start is within 0.003;
  // three Newton steps (x'' bounded, f' ≥ 6) leave less than 1e-18.
  T x = 1.7320508075688772 + r * (1.0 / 3.0 - 0.0653841409022105 * r);
  for (int newton = 0; newton < 3; ++newton)
    x = x - (x * (x * x - 3.0) - 2.0 * r) / (3.0 * (x * x - 1.0));
  const T sign = select(prolate, j2 * 0.0 + 1.0, j2 * 0.0 - 1.0);
  const T separated = sign * p * x;

  // Null vector of d − separated·I: the longest of the three cross products of its rows.
  const Vector3<T> row0{d.xx - separated, d.xy, d.xz}, row1{d.xy, d.yy - separated, d.yz},
      row2{d.xz, d.yz, d.zz - separated};
  const Vector3<T> c01 = cross(row0, row1), c02 = cross(row0, row2), c12 = cross(row1, row2);
  const T n01 = dot(c01, c01), n02 = dot(c02, c02), n12 = dot(c12, c12);
  Vector3<T> first = select(n02 > n01, c02, c01);
  T norm2 = maximum(n01, n02);
  first = select(n12 > norm2, c12, first);
  norm2 = maximum(norm2, n12);
  const auto sphere = norm2 <= 1e-60;
  const T unit = 1.0 / square_root(select(sphere, j2 * 0.0 + 1.0, norm2));
  first = select(sphere, Vector3<T>{j2 * 0.0 + 1.0, j2 * 0.0, j2 * 0.0}, scaled(unit, first));

  // Orthonormal basis (u, v) of the plane perpendicular to `first`.
  const auto x_small = absolute(first.x) <= absolute(first.z);
  Vector3<T> u = select(x_small, Vector3<T>{j2 * 0.0, first.z, -first.y},
                        Vector3<T>{first.y, -first.x, j2 * 0.0});
  u = scaled(T(1.0 / square_root(dot(u, u))), u);
  const Vector3<T> v = cross(first, u);
  const Vector3<T> du = times(d, u), dv = times(d, v);
  const T uu = dot(u, du), uv = dot(u, dv), vv = dot(v, dv);
  const T half_difference = 0.5 * (uu - vv), half_sum = 0.5 * (uu + vv);
  const T radius = square_root(half_difference * half_difference + uv * uv);
  const T upper = half_sum + radius, lower = half_sum - radius;
  // Upper eigenvector of the 2×2 block at angle φ: cos 2φ = half_difference/radius. Take the
  // numerically safe half-angle first, the other from the product sin φ cos φ = uv/(2 radius).
  const auto round = radius <= 1e-30;
  const T inverse_radius = 1.0 / select(round, j2 * 0.0 + 1.0, radius);
  const T cos2 = select(round, j2 * 0.0 + 1.0, half_difference * inverse_radius);
  const T sin2 = select(round, j2 * 0.0, uv * inverse_radius);
  const auto near_u = cos2 >= 0.0;
  const T large = square_root(0.5 * (1.0 + absolute(cos2)));
  const T small = 0.5 * sin2 / large;
  const T cos1 = select(near_u, large, small);
  const T sin1 = select(near_u, small, large);
  const Vector3<T> high{cos1 * u.x + sin1 * v.x, cos1 * u.y + sin1 * v.y, cos1 * u.z + sin1 * v.z};
  const Vector3<T> low{cos1 * v.x - sin1 * u.x, cos1 * v.y - sin1 * u.y, cos1 * v.z - sin1 * u.z};

  PrincipalAxes3<T> axes;
  axes.a2 = mean * (1.0 + select(prolate, separated, upper));
  axes.b2 = mean * (1.0 + select(prolate, upper, lower));
  axes.c2 = mean * (1.0 + select(prolate, lower, separated));
  axes.major = select(prolate, first, high);
  axes.middle = select(prolate, high, low);
  return axes;
}

template <class T>
struct PrincipalAxes2 {
  T a2, b2;
  T major_x, major_z;
};

/// Closed form in the plane; a circle gets the x axis.
template <class T>
static inline PrincipalAxes2<T> principal_axes(const Symmetric2<T>& b) {
  const T mean = 0.5 * (b.xx + b.zz);
  const T half_difference = 0.5 * (b.xx - b.zz);
  const T radius = square_root(half_difference * half_difference + b.xz * b.xz);
  const auto round = radius <= 1e-16 * mean;
  const T inverse_radius = 1.0 / select(round, mean * 0.0 + 1.0, radius);
  const T cos2 = select(round, mean * 0.0 + 1.0, half_difference * inverse_radius);
  const T sin2 = select(round, mean * 0.0, b.xz * inverse_radius);
  const auto near_x = cos2 >= 0.0;
  const T large = square_root(0.5 * (1.0 + absolute(cos2)));
  const T small = 0.5 * sin2 / large;
  return {mean + radius, mean - radius, select(near_x, large, small), select(near_x, small, large)};
}

/// Offsets of the support points from the centre: points at ±first and ±second (3D, weight ¼ each)
/// or ±first (2D, weight ½ each). They reproduce the second moment B/5 (2D: B/4) of the uniform
/// ellipsoid less its isotropic part c²/5 (b²/4); a sphere collapses to its centre.
/// 3D: corners of a rectangle in the plane of the two longer axes, √(2/5)·(cos θ, sin θ) at
/// θ = π/4, 3π/4, … scaled by √(a²−c²), √(b²−c²) (Frey, Dritschel and Böing 2023,
/// doi:10.1016/j.jcpx.2023.100136); 2D: ½√(a²−b²) along the major axis (2022, 100109).
template <class T>
struct SupportOffsets3 {
  Vector3<T> first, second;
};
template <class T>
static inline SupportOffsets3<T> support_offsets(const Symmetric3<T>& b) {
  const PrincipalAxes3<T> axes = principal_axes(b);
  // √(2/5)/√2 = √(1/5): each point combines both axes with cos π/4.
  const T along_major = square_root(0.2 * maximum(axes.a2 - axes.c2, axes.a2 * 0.0));
  const T along_middle = square_root(0.2 * maximum(axes.b2 - axes.c2, axes.a2 * 0.0));
  const Vector3<T> eta = scaled(along_major, axes.major), tau = scaled(along_middle, axes.middle);
  return {{eta.x + tau.x, eta.y + tau.y, eta.z + tau.z},
          {eta.x - tau.x, eta.y - tau.y, eta.z - tau.z}};
}
template <class T>
struct SupportOffsets2 {
  T x, z;
};
template <class T>
static inline SupportOffsets2<T> support_offsets(const Symmetric2<T>& b) {
  const PrincipalAxes2<T> axes = principal_axes(b);
  const T half_focal = 0.5 * square_root(maximum(axes.a2 - axes.b2, axes.a2 * 0.0));
  return {half_focal * axes.major_x, half_focal * axes.major_z};
}

template <class T>
static inline T determinant(const Symmetric3<T>& b) {
  return b.xx * (b.yy * b.zz - b.yz * b.yz) - b.xy * (b.xy * b.zz - b.yz * b.xz) +
         b.xz * (b.xy * b.yz - b.yy * b.xz);
}
template <class T>
static inline T determinant(const Symmetric2<T>& b) {
  return b.xx * b.zz - b.xz * b.xz;
}

}  // namespace pileus::PILEUS_ISA
