// Small dense matrices of plugins that deform parcels: products, determinants, the exponential.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

namespace pileus {

/// A d×d matrix, row by row.
template <int D>
using Matrix = std::array<double, D * D>;

template <int D>
Matrix<D> product(const Matrix<D>& a, const Matrix<D>& b) {
  Matrix<D> c{};
  for (int i = 0; i < D; ++i)
    for (int k = 0; k < D; ++k)
      for (int j = 0; j < D; ++j) c[i * D + j] += a[i * D + k] * b[k * D + j];
  return c;
}
template <int D>
Matrix<D> transposed(const Matrix<D>& a) {
  Matrix<D> t{};
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j) t[j * D + i] = a[i * D + j];
  return t;
}

inline double determinant(const Matrix<2>& a) {
  return a[0] * a[3] - a[1] * a[2];
}
inline double determinant(const Matrix<3>& a) {
  return a[0] * (a[4] * a[8] - a[5] * a[7]) - a[1] * (a[3] * a[8] - a[5] * a[6]) +
         a[2] * (a[3] * a[7] - a[4] * a[6]);
}

/// exp(a) by scaling to a norm below 1/4, the Taylor polynomial of degree 10 (truncation error
/// below 1e-14) and repeated squaring.
template <int D>
Matrix<D> exponential(const Matrix<D>& a) {
  double norm = 0;
  for (int i = 0; i < D; ++i) {
    double row = 0;
    for (int j = 0; j < D; ++j) row += std::abs(a[i * D + j]);
    norm = std::max(norm, row);
  }
  int halvings = 0;
  double scale = 1;
  for (; norm * scale > 0.25 && halvings < 60; ++halvings) scale *= 0.5;
  Matrix<D> scaled = a;
  for (double& x : scaled) x *= scale;
  // Horner: I + a (I + a/2 (I + a/3 (…)))
  Matrix<D> e{};
  for (int i = 0; i < D; ++i) e[i * D + i] = 1;
  for (int order = 10; order >= 1; --order) {
    e = product<D>(scaled, e);
    for (double& x : e) x /= order;
    for (int i = 0; i < D; ++i) e[i * D + i] += 1;
  }
  for (int k = 0; k < halvings; ++k) e = product<D>(e, e);
  return e;
}

}  // namespace pileus
