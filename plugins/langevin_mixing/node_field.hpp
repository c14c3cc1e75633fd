// A field on the nodes of the mesh between them: multilinear, with its gradient.
#pragma once
#include <pileus/plugin.hpp>

#include <cmath>
#include <cstdint>

#include "displacement.hpp"

namespace pileus::langevin {

/// Reads a mesh quantity as the core lays it out (pileus.mesh/1). Continuous; the gradient jumps
/// from cell to cell. Periodic sideways, even at the walls.
template <int D>
class NodeField {
 public:
  NodeField(const pileus_grid& grid, const pileus_view& view)
      : grid_(grid), values_(view), levels_(grid.cells[2] + 3) {}

  Local<D> at(const double* x) const {
    std::int64_t low[D], high[D];
    double fraction[D];
    for (int d = 0; d < D; ++d) locate(d, x[d], low[d], high[d], fraction[d]);
    Local<D> result;
    for (int corner = 0; corner < 1 << D; ++corner) {
      std::int64_t node[D];
      double weight[D], slope[D];
      for (int d = 0; d < D; ++d) {
        const bool upper = (corner >> d & 1) != 0;
        node[d] = upper ? high[d] : low[d];
        weight[d] = upper ? fraction[d] : 1.0 - fraction[d];
        slope[d] = (upper ? 1.0 : -1.0) / grid_.spacing[axis(d)];
      }
      const double value = values_(index(node));
      result.value += product(weight, weight, -1) * value;
      for (int g = 0; g < D; ++g) result.gradient[g] += product(weight, slope, g) * value;
    }
    return result;
  }

 private:
  static int axis(int d) { return d == D - 1 ? 2 : d; }
  /// Product of the weights, that of direction `g` replaced by the slope.
  static double product(const double* weight, const double* slope, int g) {
    double p = 1;
    for (int d = 0; d < D; ++d) p *= d == g ? slope[d] : weight[d];
    return p;
  }
  void locate(int d, double x, std::int64_t& low, std::int64_t& high, double& fraction) const {
    const int a = axis(d);
    const auto n = static_cast<double>(grid_.cells[a]);
    double xi = (x - grid_.origin[a]) / grid_.spacing[a];
    if (d == D - 1) {
      xi = xi > 0 ? std::fmin(xi, n) : 0.0;
    } else {
      xi -= n * std::floor(xi / n);
      if (!(xi > 0)) xi = 0;
    }
    const double cell = std::fmin(std::floor(xi), n - 1);
    fraction = xi - cell;
    low = static_cast<std::int64_t>(cell);
    high = d != D - 1 && low + 1 == grid_.cells[a] ? 0 : low + 1;
  }
  std::int64_t index(const std::int64_t* node) const {
    const std::int64_t column = D == 3 ? node[D - 2] * grid_.cells[0] + node[0] : node[0];
    return column * levels_ + node[D - 1] + 1;
  }

  const pileus_grid& grid_;
  Strided<const double> values_;
  std::int64_t levels_;
};

}  // namespace pileus::langevin
