// Growth of a parcel by entrainment from eddies of its own size.
#pragma once
#include <algorithm>
#include <cmath>

namespace pileus::dilution {

/// Size volume V_t after `dt`, of a parcel in D dimensions that entrains at the rate |S| of strain:
/// Richardson's four-thirds law, in which the radius r grows at a speed in proportion to r^{1/3},
///
///   dV_t/dt = (D/3) c |S| V_c^{2/3D} V_t^{1−2/3D}        (3D: c |S| V_c^{2/9} V_t^{7/9})
///
/// with the cell's volume V_c. Its solution is V_t^{2/3D} = V_0^{2/3D} + (2/9) c |S| V_c^{2/3D} t,
/// exact for any step. Growth ends at the cell's volume: larger eddies are on the mesh. A parcel
/// that is larger stays so.
template <int D>
double grown_volume(double size, double cell, double rate, double strain, double dt) {
  constexpr double exponent = 2.0 / (3.0 * D);
  if (!(rate * strain * dt > 0) || !(size < cell)) return size;
  const double part = std::pow(size / cell, exponent) + 2.0 / 9.0 * rate * strain * dt;
  return std::clamp(cell * std::pow(part, 1.0 / exponent), size, cell);
}

/// Factor on the shape matrix of a parcel whose size volume grows by `growth`.
template <int D>
double shape_factor(double growth) {
  return std::pow(growth, 2.0 / D);
}

}  // namespace pileus::dilution
