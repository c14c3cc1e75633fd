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

/// √x for x ≥ 0, by way of the inverse root; zero below 1e-280.
template <class T>
static inline T root(const T& x) {
  const T floor = x * 0.0 + 1e-280;
  return select(x > floor, x * inverse_square_root(maximum(x, floor)), x * 0.0);
}

/// The deviator of a matrix relative to its mean eigenvalue, and its best separated eigenvalue.
template <class T>
struct SeparatedEigenvalue {
  Symmetric3<T> deviator;
  T value;  // relative to the mean
  T sign;   // +1: it is the largest of the three, −1: the smallest
};

/// From the depressed cubic of the deviator: x = 2 cos(arccos(r)/3) in [√3, 2] solves x³ − 3x = 2r.
/// The quadratic start is within 0.003; Newton steps with a rough inverse of f' ≥ 6 reduce the
/// error to 7e-6, 4e-10, 3e-14 and below rounding.
template <class T>
static inline SeparatedEigenvalue<T> separate(const Symmetric3<T>& b, const T& mean) {
  const T scale = 1.0 / mean;  // so that squares and cubes neither over- nor underflow
  const Symmetric3<T> d{(b.xx - mean) * scale, b.xy * scale, b.xz * scale,
                        (b.yy - mean) * scale, b.yz * scale, (b.zz - mean) * scale};
  const T j2 =
      0.5 * (d.xx * d.xx + d.yy * d.yy + d.zz * d.zz) + d.xy * d.xy + d.xz * d.xz + d.yz * d.yz;
  const T j3 = d.xx * (d.yy * d.zz - d.yz * d.yz) - d.xy * (d.xy * d.zz - d.yz * d.xz) +
               d.xz * (d.xy * d.yz - d.yy * d.xz);
  // Below this the shape is a sphere to rounding; the floor keeps the divisions finite.
  const T p2 = maximum(j2 * (1.0 / 3.0), j2 * 0.0 + 1e-32);
  const T inverse_p = inverse_square_root(p2);
  const T r_signed = 0.5 * j3 * (inverse_p * inverse_p) * inverse_p;
  const T r = minimum(absolute(r_signed), j2 * 0.0 + 1.0);
  T x = 1.7320508075688772 + r * (1.0 / 3.0 - 0.0653841409022105 * r);
  for (int newton = 0; newton < 4; ++newton)
    x = x - (x * (x * x - 3.0) - 2.0 * r) * rough_inverse(3.0 * (x * x - 1.0));
  const T sign = select(r_signed >= 0.0, j2 * 0.0 + 1.0, j2 * 0.0 - 1.0);
  return {d, sign * (p2 * inverse_p) * x, sign};
}

/// Unit vector in the null space of d − value·I: the longest of the three cross products of its
/// rows; any unit vector for a sphere.
template <class T>
static inline Vector3<T> null_vector(const Symmetric3<T>& d, const T& value) {
  const Vector3<T> row0{d.xx - value, d.xy, d.xz}, row1{d.xy, d.yy - value, d.yz},
      row2{d.xz, d.yz, d.zz - value};
  const Vector3<T> c01 = cross(row0, row1), c02 = cross(row0, row2), c12 = cross(row1, row2);
  const T n01 = dot(c01, c01), n02 = dot(c02, c02), n12 = dot(c12, c12);
  Vector3<T> longest = select(n02 > n01, c02, c01);
  T norm2 = maximum(n01, n02);
  longest = select(n12 > norm2, c12, longest);
  norm2 = maximum(norm2, n12);
  const auto sphere = norm2 <= 1e-60;
  const T one = norm2 * 0.0 + 1.0, zero = norm2 * 0.0;
  return select(sphere, Vector3<T>{one, zero, zero},
                scaled(inverse_square_root(select(sphere, one, norm2)), longest));
}

/// The 2×2 problem that is left in the plane perpendicular to a known eigenvector.
template <class T>
struct PlaneAxes {
  T upper, lower;        // eigenvalues
  Vector3<T> high, low;  // their unit vectors
};

/// Upper eigenvector at the angle φ from u, cos 2φ = half_difference/radius: the numerically safe
/// half-angle first, the other from the product sin φ cos φ = uv/(2 radius).
template <class T>
static inline PlaneAxes<T> plane_axes(const Symmetric3<T>& d, const Vector3<T>& normal) {
  const T zero = normal.x * 0.0, one = zero + 1.0;
  Vector3<T> u =
      select(absolute(normal.x) <= absolute(normal.z), Vector3<T>{zero, normal.z, -normal.y},
             Vector3<T>{normal.y, -normal.x, zero});
  u = scaled(inverse_square_root(dot(u, u)), u);
  const Vector3<T> v = cross(normal, u);
  const Vector3<T> du = times(d, u), dv = times(d, v);
  const T uu = dot(u, du), uv = dot(u, dv), vv = dot(v, dv);
  const T half_difference = 0.5 * (uu - vv), half_sum = 0.5 * (uu + vv);
  const T radius2 = half_difference * half_difference + uv * uv;
  const auto round = radius2 <= 1e-60;
  const T inverse_radius = inverse_square_root(select(round, one, radius2));
  const T radius = select(round, zero, radius2 * inverse_radius);
  const T cos2 = select(round, one, half_difference * inverse_radius);
  const T sin2 = select(round, zero, uv * inverse_radius);
  const T large2 = 0.5 * (1.0 + absolute(cos2));
  const T inverse_large = inverse_square_root(large2);
  const T large = large2 * inverse_large, small = 0.5 * sin2 * inverse_large;
  const auto near_u = cos2 >= 0.0;
  const T c = select(near_u, large, small), s = select(near_u, small, large);
  return {half_sum + radius,
          half_sum - radius,
          {c * u.x + s * v.x, c * u.y + s * v.y, c * u.z + s * v.z},
          {c * v.x - s * u.x, c * v.y - s * u.y, c * v.z - s * u.z}};
}

/// Eigen-decomposition by deflation: the best separated eigenvalue of the deviator first, then the
/// remaining 2×2 problem (method of Scherzinger and Dohrmann 2008, doi:10.1016/j.cma.2008.03.031,
/// with the cubic's root by Newton steps instead of arccosines). Every threshold is relative to the
/// matrix, so units of length do not matter. For a sphere the axes are arbitrary orthonormal
/// vectors.
template <class T>
static inline PrincipalAxes3<T> principal_axes(const Symmetric3<T>& b) {
  const T mean = (b.xx + b.yy + b.zz) * (1.0 / 3.0);
  const SeparatedEigenvalue<T> separated = separate(b, mean);
  const Vector3<T> first = null_vector(separated.deviator, separated.value);
  const PlaneAxes<T> plane = plane_axes(separated.deviator, first);
  const auto prolate = separated.sign > 0.0;
  return {mean * (1.0 + select(prolate, separated.value, plane.upper)),
          mean * (1.0 + select(prolate, plane.upper, plane.lower)),
          mean * (1.0 + select(prolate, plane.lower, separated.value)),
          select(prolate, first, plane.high), select(prolate, plane.high, plane.low)};
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
  const T along_major = root(T(0.2 * (axes.a2 - axes.c2)));
  const T along_middle = root(T(0.2 * (axes.b2 - axes.c2)));
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
