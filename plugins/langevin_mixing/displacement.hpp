// One step of a particle that is moved at random and keeps what is well mixed well mixed.
#pragma once
#include <cmath>

namespace pileus::langevin {

/// Value and gradient of a quantity at a point.
template <int D>
struct Local {
  double value = 0;
  double gradient[D] = {};
};

/// Displacement by eddy diffusion with diffusivity K(x), Itô: dX_i = ∂_iK dt + √(2K) dW_i. With the
/// drift, uniform stays uniform (Thomson 1987); without it, particles gather where K is small.
/// Milstein's term in each direction by itself: strong order 1 where K varies along one direction,
/// weak order 1 otherwise. `normal`: D draws from N(0, 1).
template <int D>
void brownian_displacement(const Local<D>& diffusivity, double dt, const double* normal,
                           double* shift) {
  const double spread = std::sqrt(2.0 * diffusivity.value * dt);
  for (int i = 0; i < D; ++i) {
    const double squared = normal[i] * normal[i];
    shift[i] = spread * normal[i] + 0.5 * diffusivity.gradient[i] * dt * (squared + 1.0);
  }
}

/// Exact Ornstein–Uhlenbeck process of time scale `t` over `dt` for a variable of unit variance.
inline double relaxed_velocity(double w, double dt, double t, double normal) {
  const double ratio = dt / t;
  return w * std::exp(-ratio) + std::sqrt(-std::expm1(-2.0 * ratio)) * normal;
}

/// One step of the Langevin equation with the velocity fluctuation in units of its own standard
/// deviation, W = U/σ(x), which turns Thomson's drift into
///
///   dX_i = σ W_i dt        dW_i = (−W_i/T + ∂_iσ) dt + √(2/T) dξ_i
///
/// whatever σ does in time or along the mean flow. Half a step of relaxation, exactly; the motion
/// by the midpoint rule; another half. `sigma(x)` and `time_scale(x)` are asked at D coordinates.
/// `normal`: 2 D draws. Second order in dt but for the change of T along a step.
template <int D, class Sigma, class TimeScale>
void langevin_step(double* x, double* w, double dt, Sigma&& sigma, TimeScale&& time_scale,
                   const double* normal) {
  const double before = time_scale(x);
  for (int i = 0; i < D; ++i) w[i] = relaxed_velocity(w[i], 0.5 * dt, before, normal[i]);
  const Local<D> start = sigma(x);
  double half[D], w_half[D];
  for (int i = 0; i < D; ++i) {
    half[i] = x[i] + 0.5 * dt * start.value * w[i];
    w_half[i] = w[i] + 0.5 * dt * start.gradient[i];
  }
  const Local<D> middle = sigma(half);
  for (int i = 0; i < D; ++i) {
    x[i] += dt * middle.value * w_half[i];
    w[i] += dt * middle.gradient[i];
  }
  const double after = time_scale(x);
  for (int i = 0; i < D; ++i) w[i] = relaxed_velocity(w[i], 0.5 * dt, after, normal[D + i]);
}

/// A height reflected into [bottom, top]; `turned` says whether it was. More than a domain's depth
/// beyond a wall it is put on the wall.
inline double reflected(double z, double bottom, double top, bool& turned) {
  turned = z < bottom || z > top;
  if (!turned) return z;
  const double mirrored = z < bottom ? 2 * bottom - z : 2 * top - z;
  return mirrored < bottom ? bottom : mirrored > top ? top : mirrored;
}

/// A quantity continued beyond the walls as its mirror image: there a reflected particle sees what
/// it would see at its image.
template <int D, class Field>
Local<D> even_at_walls(Field&& field, const double* x, double bottom, double top) {
  double inside[D];
  for (int d = 0; d < D; ++d) inside[d] = x[d];
  bool turned;
  inside[D - 1] = reflected(x[D - 1], bottom, top, turned);
  Local<D> result = field(inside);
  if (turned) result.gradient[D - 1] = -result.gradient[D - 1];
  return result;
}

}  // namespace pileus::langevin
