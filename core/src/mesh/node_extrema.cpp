#include "mesh/node_extrema.hpp"

#include <algorithm>
#include <cmath>

#include "mesh/vector_clones.hpp"

namespace pileus::mesh {

namespace {

inline double larger(double a, double b) {
  return a > b ? a : b;
}

/// Largest |eigenvalue| of a symmetric traceless matrix. With p = tr S²/6 and
/// r = |det S|/(2 p^{3/2}) ≤ 1 it is 2√p c, where c = cos(acos(r)/3) is the root of 4c³ − 3c = r in
/// [√3/2, 1]. Newton's method from the chord (error below 0.01) squares the error three times, to
/// below rounding.
[[gnu::always_inline]] inline double spectral_radius(double a, double b, double d, double e,
                                                     double f) {
  // S = [[a, d, e], [d, b, f], [e, f, −a−b]]
  const double c = -a - b;
  const double p = (a * a + b * b + c * c + 2 * (d * d + e * e + f * f)) / 6;
  const double det = a * (b * c - f * f) - d * (d * c - f * e) + e * (d * f - b * e);
  const double root = std::sqrt(p), smallest = 1e-300;
  const double cube = root * p;
  double r = std::abs(det) / (2 * (cube > smallest ? cube : smallest));
  r = r < 1 ? r : 1;
  double x = 0.8660254037844386 + 0.1339745962155614 * r;
  for (int newton = 0; newton < 3; ++newton) x = (8 * x * x * x + r) / (12 * x * x - 3);
  return 2 * root * x;
}

}  // namespace

namespace {

constexpr int lanes = 8;

/// Running maxima of as many levels as a vector has lanes; `poison` keeps a NaN once there was one,
/// which a comparison would drop.
struct StrainMaxima {
  double largest[lanes] = {};
  double poison[lanes] = {};
};

[[gnu::always_inline]] inline void take_levels(const GradientColumns& g, int begin, int count,
                                               StrainMaxima& m) {
  for (int n = 0; n < count; ++n) {
    const int k = begin + n;
    const double u_z = g.w_x[k] + g.eta[k], v_z = g.w_y[k] - g.xi[k];
    const double radius = spectral_radius(g.u_x[k], g.v_y[k], 0.5 * (g.u_y[k] + g.v_x[k]),
                                          0.5 * (u_z + g.w_x[k]), 0.5 * (v_z + g.w_y[k]));
    m.largest[n] = larger(radius, m.largest[n]);
    m.poison[n] += 0 * radius;
  }
}

}  // namespace

PILEUS_VECTOR_CLONES
double largest_strain(const GradientColumns& g) {
  StrainMaxima m;
  int begin = 0;
  for (; begin + lanes <= g.levels; begin += lanes) take_levels(g, begin, lanes, m);
  // A maximum does not mind levels taken twice.
  if (begin < g.levels && g.levels >= lanes)
    take_levels(g, g.levels - lanes, lanes, m);
  else
    take_levels(g, begin, g.levels - begin, m);
  double result = 0, poison = 0;
  for (int n = 0; n < lanes; ++n) {
    result = larger(m.largest[n], result);
    poison += m.poison[n];
  }
  return result + poison;
}

PILEUS_VECTOR_CLONES
double largest_squared_vorticity(const GradientColumns& g) {
  double largest = 0;
  for (int k = 0; k < g.levels; ++k) {
    const double zeta = g.v_x[k] - g.u_y[k];
    largest = larger(g.xi[k] * g.xi[k] + g.eta[k] * g.eta[k] + zeta * zeta, largest);
  }
  return largest;
}

PILEUS_VECTOR_CLONES
double largest_magnitude(const double* f, int count) {
  double largest = 0;
  for (int k = 0; k < count; ++k) largest = larger(std::abs(f[k]), largest);
  return largest;
}

void merge_extrema(FlowSummary& into, const FlowSummary& from) {
  if (!(from.strain <= into.strain) && !std::isnan(into.strain)) into.strain = from.strain;
  into.buoyancy_gradient = larger(from.buoyancy_gradient, into.buoyancy_gradient);
  into.vorticity = larger(from.vorticity, into.vorticity);
  for (std::size_t d = 0; d < into.speed.size(); ++d)
    into.speed[d] = larger(from.speed[d], into.speed[d]);
}

}  // namespace pileus::mesh
