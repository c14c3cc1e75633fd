// Flows whose vorticity, velocity, gradient and tendency are known.
#pragma once
#include <array>
#include <cmath>
#include <numbers>

#include "mesh/grid.hpp"

namespace pileus::mesh::test {

using Vector = std::array<double, 3>;
inline constexpr double pi = std::numbers::pi;

/// Beltrami flow ω = αu with k = l = 2, m = 1, α = 3 on [−π/2, π/2]³ (Frey, Dritschel & Böing
/// 2023, J. Comput. Phys. X 17, 100136); ζ = w = 0 on the walls.
struct Beltrami {
  static Grid<3> grid(int nx, int ny, int nz) {
    return {{nx, ny, nz}, {-pi / 2, -pi / 2, -pi / 2}, {pi, pi, pi}};
  }
  static Vector velocity(const Vector& x) {
    const double s = std::sin(2 * x[0] + 2 * x[1]), c = std::cos(2 * x[0] + 2 * x[1]);
    const double sz = std::sin(x[2]), cz = std::cos(x[2]);
    return {0.25 * (sz - 3 * cz) * s, 0.25 * (sz + 3 * cz) * s, cz * c};
  }
  static Vector vorticity(const Vector& x) {
    Vector omega = velocity(x);
    for (double& component : omega) component *= 3;
    return omega;
  }
  /// ω·∇u = α u·∇u = α ∇|u|²/2, worked out.
  static Vector tendency(const Vector& x) {
    const double phase = 2 * x[0] + 2 * x[1], sc = std::sin(phase) * std::cos(phase);
    return {0.75 * sc, 0.75 * sc, -3 * std::sin(x[2]) * std::cos(x[2])};
  }
};

/// Taylor–Green flow u = A cos ax sin by sin cz, v = B sin ax cos by sin cz,
/// w = C sin ax sin by cos cz with aA + bB + cC = 0 on [−π, π]²×[−π/2, 3π/2].
struct TaylorGreen {
  double A, B, C, a, b, c;

  static Grid<3> grid(int nx, int ny, int nz) {
    return {{nx, ny, nz}, {-pi, -pi, -pi / 2}, {2 * pi, 2 * pi, 2 * pi}};
  }
  Vector velocity(const Vector& x) const {
    return {A * std::cos(a * x[0]) * std::sin(b * x[1]) * std::sin(c * x[2]),
            B * std::sin(a * x[0]) * std::cos(b * x[1]) * std::sin(c * x[2]),
            C * std::sin(a * x[0]) * std::sin(b * x[1]) * std::cos(c * x[2])};
  }
  Vector vorticity(const Vector& x) const {
    return {(b * C - c * B) * std::sin(a * x[0]) * std::cos(b * x[1]) * std::cos(c * x[2]),
            (c * A - a * C) * std::cos(a * x[0]) * std::sin(b * x[1]) * std::cos(c * x[2]),
            (a * B - b * A) * std::cos(a * x[0]) * std::cos(b * x[1]) * std::sin(c * x[2])};
  }
  /// Row-major velocity gradient ∂u_i/∂x_j.
  std::array<double, 9> gradient(const Vector& x) const {
    const double sx = std::sin(a * x[0]), cx = std::cos(a * x[0]);
    const double sy = std::sin(b * x[1]), cy = std::cos(b * x[1]);
    const double sz = std::sin(c * x[2]), cz = std::cos(c * x[2]);
    return {-a * A * sx * sy * sz, b * A * cx * cy * sz,  c * A * cx * sy * cz,
            a * B * cx * cy * sz,  -b * B * sx * sy * sz, c * B * sx * cy * cz,
            a * C * cx * sy * cz,  b * C * sx * cy * cz,  -c * C * sx * sy * sz};
  }
};

/// u = k f′ cos kx sin ly, v = −l f′ sin kx cos ly, w = (k² − l²) f sin kx sin ly with
/// f = 2z − z² − z³, which vanishes with w at z = 0 and 1 (the flow of PS3D's own test).
struct PolynomialFlow {
  double k, l;

  static double f(double z) { return z * (2 - z * (1 + z)); }
  static double f1(double z) { return 2 - z * (2 + 3 * z); }
  static double f2(double z) { return -2 - 6 * z; }
  Vector velocity(const Vector& x) const {
    const double sx = std::sin(k * x[0]), cx = std::cos(k * x[0]);
    const double sy = std::sin(l * x[1]), cy = std::cos(l * x[1]);
    return {k * f1(x[2]) * cx * sy, -l * f1(x[2]) * sx * cy, (k * k - l * l) * f(x[2]) * sx * sy};
  }
  Vector vorticity(const Vector& x) const {
    const double sx = std::sin(k * x[0]), cx = std::cos(k * x[0]);
    const double sy = std::sin(l * x[1]), cy = std::cos(l * x[1]);
    const double d = k * k - l * l;
    return {(l * d * f(x[2]) + l * f2(x[2])) * sx * cy, (k * f2(x[2]) - k * d * f(x[2])) * cx * sy,
            -2 * k * l * f1(x[2]) * cx * cy};
  }
};

}  // namespace pileus::mesh::test
