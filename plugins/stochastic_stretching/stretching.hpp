// Random incompressible deformation of an ellipsoid: B ← E B Eᵀ, E = exp(√dt G).
#pragma once
#include <pileus/matrix.hpp>

#include <algorithm>
#include <cmath>

namespace pileus::stretching {

/// Variance that N(0,1) keeps when it is held within ±3: ∫ min(|x|, 3)² φ(x) dx
/// = 1 − 2Q(3) − 6φ(3) + 18Q(3) with the density φ and the tail Q.
inline double variance_within_three() {
  const double density = std::exp(-4.5) / std::sqrt(2 * 3.14159265358979323846);
  const double tail = 0.5 * std::erfc(3 / std::sqrt(2.0));
  return (1 - 2 * tail) - 2 * 3 * density + 2 * 9 * tail;
}

/// The velocity gradient of an isotropic, incompressible random flow that is white in time
/// (Batchelor 1959, Kraichnan 1974):  ⟨G_ij G_kl⟩ = D[(d+1) δ_ik δ_jl − δ_ij δ_kl − δ_il δ_jk]
/// from a matrix N of independent draws from N(0, 1):  G = √D(√d S_N + √(d+2) A_N) with the
/// traceless symmetric part S_N and the antisymmetric part A_N. Its trace is zero to rounding.
template <int D>
Matrix<D> random_gradient(double intensity, const double* normal) {
  double trace = 0;
  for (int i = 0; i < D; ++i) trace += normal[i * D + i];
  const double symmetric = std::sqrt(double(D)), antisymmetric = std::sqrt(D + 2.0);
  Matrix<D> g{};
  for (int i = 0; i < D; ++i)
    for (int j = 0; j < D; ++j) {
      const double n = normal[i * D + j], t = normal[j * D + i];
      const double s = 0.5 * (n + t) - (i == j ? trace / D : 0.0);
      g[i * D + j] = std::sqrt(intensity) * (symmetric * s + antisymmetric * 0.5 * (n - t));
    }
  return g;
}

/// One step of length dt of dB = Σ(G_k B + B G_kᵀ) ∘ dW_k: weak order one, symmetric, positive
/// definite, and of the same determinant to rounding. Draws beyond ±3 are held there, so that no
/// single step deforms without bound; the rest is scaled up to unit variance.
template <int D>
Matrix<D> stretched(const Matrix<D>& shape, double intensity, double dt, const double* normal) {
  static const double unit = 1.0 / std::sqrt(variance_within_three());
  double held[D * D];
  for (int i = 0; i < D * D; ++i) held[i] = unit * std::clamp(normal[i], -3.0, 3.0);
  Matrix<D> increment = random_gradient<D>(intensity, held);
  for (double& g : increment) g *= std::sqrt(dt);
  const Matrix<D> e = exponential<D>(increment);
  Matrix<D> b = product<D>(product<D>(e, shape), transposed<D>(e));
  // exp of a traceless matrix has determinant one: what rounding has changed is taken back.
  const double factor = std::pow(determinant(shape) / determinant(b), 1.0 / D);
  for (int i = 0; i < D; ++i)
    for (int j = i; j < D; ++j)
      b[i * D + j] = b[j * D + i] = 0.5 * factor * (b[i * D + j] + b[j * D + i]);
  return b;
}

/// Intensity D of a random gradient with mean square c|S|² and correlation time 1/|S|:
/// ⟨G:G⟩ = D d(d+2)(d−1).
template <int D>
double intensity_of_strain(double coefficient, double strain) {
  return coefficient * strain / (D * (D + 2.0) * (D - 1.0));
}

}  // namespace pileus::stretching
