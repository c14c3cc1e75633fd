// A random flow without divergence, tangential to the walls: the curl of splines on the mesh.
#pragma once
#include <pileus/abi.h>
#include <pileus/matrix.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace pileus::coherent {

/// Quadratic B-splines of the three nodes around a point along one direction, with derivatives by
/// the coordinate in units of the spacing.
struct Spline {
  std::int64_t first = 0;  // node of the first
  double value[3], slope[3], curvature[3] = {1, -2, 1};

  /// `xi`: coordinate in units of the spacing from node 0.
  explicit Spline(double xi) {
    const double nearest = std::floor(xi + 0.5), t = xi - nearest;
    first = static_cast<std::int64_t>(nearest) - 1;
    value[0] = 0.5 * (0.5 - t) * (0.5 - t);
    value[1] = 0.75 - t * t;
    value[2] = 0.5 * (0.5 + t) * (0.5 + t);
    slope[0] = t - 0.5;
    slope[1] = -2 * t;
    slope[2] = t + 0.5;
  }
};

/// ξ = ∇ × A (in the plane ξ_x = −∂ψ/∂z, ξ_z = ∂ψ/∂x), where A is a sum of products of quadratic
/// splines, one at each node, times random vectors. ξ is continuous and its gradient has no trace.
/// Periodic sideways; where A_x and A_y (in the plane ψ) are odd about a wall, ξ_z vanishes there.
template <int D>
class RandomFlow {
 public:
  /// Components of A.
  static constexpr int components = D == 3 ? 3 : 1;

  /// `potential`: `components` numbers for each record of pileus.mesh/1, m².
  RandomFlow(const pileus_grid& grid, const double* potential)
      : grid_(grid), potential_(potential), levels_(grid.cells[2] + 3) {}

  /// ξ at x, m.
  void velocity(const double* x, double* xi) const {
    for (int d = 0; d < D; ++d) xi[d] = 0;
    around(x, [&](const double* a, const Product& w) {
      if constexpr (D == 3) {
        double slope[3];
        for (int d = 0; d < 3; ++d) slope[d] = w.derivative(d, -1);
        xi[0] += a[2] * slope[1] - a[1] * slope[2];
        xi[1] += a[0] * slope[2] - a[2] * slope[0];
        xi[2] += a[1] * slope[0] - a[0] * slope[1];
      } else {
        xi[0] -= a[0] * w.derivative(1, -1);
        xi[1] += a[0] * w.derivative(0, -1);
      }
    });
  }

  /// g_ij = ∂ξ_i/∂x_j at x.
  Matrix<D> gradient(const double* x) const {
    Matrix<D> g{};
    around(x, [&](const double* a, const Product& w) {
      for (int j = 0; j < D; ++j) {
        double second[D];
        for (int i = 0; i < D; ++i) second[i] = w.derivative(i, j);
        if constexpr (D == 3) {
          g[j] += a[2] * second[1] - a[1] * second[2];
          g[3 + j] += a[0] * second[2] - a[2] * second[0];
          g[6 + j] += a[1] * second[0] - a[0] * second[1];
        } else {
          g[j] -= a[0] * second[1];
          g[2 + j] += a[0] * second[0];
        }
      }
    });
    return g;
  }

 private:
  /// The product of the splines of one node.
  struct Product {
    const Spline* along[D];
    int corner[D];
    double inverse[D];
    /// Derivative by direction i and, unless j < 0, by direction j.
    double derivative(int i, int j) const {
      double p = 1;
      for (int d = 0; d < D; ++d) {
        const int order = (d == i) + (d == j);
        const Spline& s = *along[d];
        const double* factor = order == 0 ? s.value : order == 1 ? s.slope : s.curvature;
        p *= factor[corner[d]];
        for (int k = 0; k < order; ++k) p *= inverse[d];
      }
      return p;
    }
  };

  static int axis(int d) { return d == D - 1 ? 2 : d; }

  Spline spline(int d, double x) const {
    const int a = axis(d);
    const auto n = static_cast<double>(grid_.cells[a]);
    double xi = (x - grid_.origin[a]) / grid_.spacing[a];
    if (d == D - 1)
      xi = xi > 0 ? std::fmin(xi, n) : 0.0;
    else
      xi -= n * std::floor(xi / n);
    if (!(xi >= 0 && xi <= n)) xi = 0;  // a broken position, which the core is about to notice
    return Spline(xi);
  }

  /// Calls visit(A, product of splines) for the nodes around x.
  template <class Visit>
  void around(const double* x, Visit&& visit) const {
    const auto visit_column = [&](const Spline& sx, const Spline* sy, const Spline& sz, int i,
                                  int j) {
      std::int64_t column = wrapped(sx.first + i, grid_.cells[0]);
      if (sy != nullptr) column += wrapped(sy->first + j, grid_.cells[1]) * grid_.cells[0];
      for (int k = 0; k < 3; ++k) {
        Product product{};
        product.along[0] = &sx;
        product.corner[0] = i;
        if constexpr (D == 3) product.along[1] = sy, product.corner[1] = j;
        product.along[D - 1] = &sz;
        product.corner[D - 1] = k;
        for (int d = 0; d < D; ++d) product.inverse[d] = 1 / grid_.spacing[axis(d)];
        visit(potential_ + (column * levels_ + sz.first + k + 1) * components, product);
      }
    };
    const Spline sx = spline(0, x[0]), sz = spline(D - 1, x[D - 1]);
    if constexpr (D == 3) {
      const Spline sy = spline(1, x[1]);
      for (int j = 0; j < 3; ++j)
        for (int i = 0; i < 3; ++i) visit_column(sx, &sy, sz, i, j);
    } else {
      for (int i = 0; i < 3; ++i) visit_column(sx, nullptr, sz, i, 0);
    }
  }
  static std::int64_t wrapped(std::int64_t node, std::int64_t n) { return (node % n + n) % n; }

  const pileus_grid& grid_;
  const double* potential_;
  std::int64_t levels_;
};

/// Mean of ξ_i² over a cell in units of Δ_i², for components of A of unit variance times the
/// product of the other two spacings: ∫β′² = 1 and ∫β² = 11/20 of the quadratic spline β.
template <int D>
constexpr double mean_square = D == 3 ? 2 * 0.55 * 0.55 : 0.55;

/// Where a point goes that follows ξ for `duration` (of the flow's unit of time), by the classical
/// Runge–Kutta scheme. `middle`, if not null: half-way.
template <int D>
void follow(const RandomFlow<D>& flow, double duration, double* x, double* middle) {
  double k[4][D], at[D];
  constexpr double part[4] = {0, 0.5, 0.5, 1};
  for (int stage = 0; stage < 4; ++stage) {
    for (int d = 0; d < D; ++d)
      at[d] = x[d] + (stage > 0 ? duration * part[stage] * k[stage - 1][d] : 0.0);
    if (stage == 2 && middle != nullptr)
      for (int d = 0; d < D; ++d) middle[d] = at[d];
    flow.velocity(at, k[stage]);
  }
  for (int d = 0; d < D; ++d) x[d] += duration / 6 * (k[0][d] + 2 * (k[1][d] + k[2][d]) + k[3][d]);
}

/// In how many pieces a unit of time is followed where the gradient of ξ is g: its largest sum of a
/// row times the piece is one at most. A scheme of fourth order keeps volumes within a per cent
/// then; longer pieces pile points up at the walls.
template <int D>
int pieces_for(const Matrix<D>& g) {
  double largest = 0;
  for (int i = 0; i < D; ++i) {
    double sum = 0;
    for (int j = 0; j < D; ++j) sum += std::abs(g[i * D + j]);
    largest = std::fmax(largest, sum);
  }
  constexpr double most = 16;
  return 1 + static_cast<int>(std::fmin(largest, most - 1));
}

/// ξ does not cross a wall; what errs beyond it comes back. Left on the wall it would stay for
/// ever.
inline double inside(double z, double bottom, double top) {
  if (z < bottom) z = 2 * bottom - z;
  if (z > top) z = 2 * top - z;
  return std::fmin(std::fmax(z, bottom), top);
}

}  // namespace pileus::coherent
