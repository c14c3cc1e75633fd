// The stress of the ground as a force in the air next to it, in the variables of the parcels.
//
//   F = −(2/d)(1 − z/d) τ for z < d, with ∫F dz = −τ; its curl and its mean are
//   dη/dt = ∂F_x/∂z = 2τ_x/d²,  dξ/dt = −∂F_y/∂z = −2τ_y/d²   (z < d)
//   dζ/dt = −(2/d)(1 − z/d)(∂τ_y/∂x − ∂τ_x/∂y),   d<u>/dt = −<τ>/H
//
// In two dimensions the one component ∂w/∂x − ∂u/∂z is −η.
#pragma once
#include <algorithm>
#include <cmath>
#include <span>

#include "ground_layer.hpp"

namespace pileus::surface {

struct HorizontalVector {
  double x = 0, y = 0;
};

/// Wind next to the ground, as the mean over the plane sees it.
struct PlaneWind {
  HorizontalVector mean;
  double speed = 0;  // mean of the speed
};

/// Local stress of a plane's u*² (Moeng 1984, doi:10.1175/1520-0469(1984)041<2052:ALESMF>2.0.CO;2):
/// u*² [(u − ū) S̄ + ū S]/S̄² with the speed S and its mean S̄, whose mean is u*² ū/S̄.
inline HorizontalVector distributed_stress(double friction_squared, const PlaneWind& plane,
                                           HorizontalVector wind, double speed,
                                           double least_speed) {
  const double mean_speed = std::max(plane.speed, least_speed);
  const double scale = friction_squared / (mean_speed * mean_speed);
  return {scale * ((wind.x - plane.mean.x) * mean_speed + plane.mean.x * speed),
          scale * ((wind.y - plane.mean.y) * mean_speed + plane.mean.y * speed)};
}

/// The same for a scalar: transfer [S (φ_s − φ̄) + S̄ (φ̄ − φ)]/S̄.
inline double distributed_flux(double transfer, double speed_ratio, double at_surface, double mean,
                               double here) {
  return transfer * (speed_ratio * (at_surface - mean) + mean - here);
}

/// ∫∂_z F_x dV of a point over dt: what η gains below `depth`, m3 s-1. −η in two dimensions.
inline double vorticity_amount(const Ground& ground, double depth, double stress, double dt) {
  return dt * 2.0 * stress * ground.area() / depth;
}

/// ∫(∂_x F_y − ∂_y F_x) dV of every point over dt, by centred differences of the stress over the
/// points around: their sum vanishes.
inline void vertical_vorticity_amounts(const Ground& ground, std::span<const double> stress_x,
                                       std::span<const double> stress_y, double dt,
                                       std::span<double> amounts) {
  const auto nx = static_cast<std::size_t>(ground.cells[0]);
  const auto ny = static_cast<std::size_t>(ground.cells[1]);
  for (std::size_t j = 0; j < ny; ++j)
    for (std::size_t i = 0; i < nx; ++i) {
      const std::size_t row = nx * j, left = i == 0 ? nx - 1 : i - 1,
                        right = i + 1 < nx ? i + 1 : 0;
      const std::size_t south = nx * (j == 0 ? ny - 1 : j - 1), north = j + 1 < ny ? row + nx : 0;
      const double curl = (stress_y[row + right] - stress_y[row + left]) / (2 * ground.spacing[0]) -
                          (stress_x[north + i] - stress_x[south + i]) / (2 * ground.spacing[1]);
      amounts[row + i] = -dt * ground.area() * curl;
    }
}

/// Change over dt of the mean wind of the whole domain, m s-1.
inline double mean_wind_change(const Ground& ground, std::span<const double> stress, double dt) {
  double sum = 0;
  for (const double t : stress) sum += t;
  return -dt * sum / (static_cast<double>(stress.size()) * ground.height);
}

}  // namespace pileus::surface
