// Ways to advance eight shape matrices at a time in a velocity gradient that is linear in time.
#include "dynamics/runge_kutta.hpp"
#include "dynamics/shape_update.hpp"
#include "parcels/simd.hpp"
#include "study/shape_kernels.hpp"

namespace pileus::PILEUS_ISA {
namespace {

using dynamics::LowStorageScheme;
using study::ShapeIntegrator;
using study::ShapeJob;

/// Eight cases.
struct Cases {
  Symmetric3<Pack> shape;
  Matrix3<Pack> start, end;
  double duration;
};

Matrix3<Pack> gradient(const Cases& cases, double time) {
  const double share = time / cases.duration;
  return combine(1 - share, cases.start, share, cases.end);
}

Symmetric3<Pack> scaled_sum(double a, const Symmetric3<Pack>& x, double b,
                            const Symmetric3<Pack>& y) {
  return {a * x.xx + b * y.xx, a * x.xy + b * y.xy, a * x.xz + b * y.xz,
          a * x.yy + b * y.yy, a * x.yz + b * y.yz, a * x.zz + b * y.zz};
}

Symmetric3<Pack> runge_kutta_step(const LowStorageScheme& scheme, const Cases& cases,
                                  Symmetric3<Pack> b, double time, double dt) {
  Symmetric3<Pack> k{};
  for (std::size_t s = 0; s < scheme.stages(); ++s) {
    k = scaled_sum(scheme.a[s], k, 1.0, shape_rate(gradient(cases, time + scheme.c[s] * dt), b));
    b = scaled_sum(1.0, b, scheme.b[s] * dt, k);
  }
  return b;
}

Symmetric3<Pack> exponential_step(const LowStorageScheme& scheme, const Cases& cases,
                                  Symmetric3<Pack> b, double time, double dt) {
  Matrix3<Pack> z{};
  for (std::size_t s = 0; s < scheme.stages(); ++s) {
    z = combine(scheme.a[s], z, 1.0, gradient(cases, time + scheme.c[s] * dt));
    b = congruence(exponential(scaled(broadcast(scheme.b[s] * dt), z)), b);
  }
  return b;
}

template <ShapeIntegrator I>
Symmetric3<Pack> step(const Cases& cases, const Symmetric3<Pack>& b, double time, double dt) {
  if constexpr (I == ShapeIntegrator::rk3)
    return runge_kutta_step(dynamics::williamson_3(), cases, b, time, dt);
  else if constexpr (I == ShapeIntegrator::rk4)
    return runge_kutta_step(dynamics::carpenter_kennedy_4(), cases, b, time, dt);
  else if constexpr (I == ShapeIntegrator::exponential3)
    return exponential_step(dynamics::williamson_3(), cases, b, time, dt);
  else if constexpr (I == ShapeIntegrator::exponential4)
    return exponential_step(dynamics::carpenter_kennedy_4(), cases, b, time, dt);
  else
    return congruence(exponential(scaled(broadcast(dt), gradient(cases, time + 0.5 * dt))), b);
}

Matrix3<Pack> load_matrix(const double* const (&m)[9], std::size_t i) {
  return {load(m[0] + i), load(m[1] + i), load(m[2] + i), load(m[3] + i), load(m[4] + i),
          load(m[5] + i), load(m[6] + i), load(m[7] + i), load(m[8] + i)};
}

template <ShapeIntegrator I>
void integrate(const ShapeJob& job) {
  const double dt = job.duration / job.steps;
  for (std::size_t i = 0; i < job.count; i += lanes) {
    const Cases cases{{load(job.shape[0] + i), load(job.shape[1] + i), load(job.shape[2] + i),
                       load(job.shape[3] + i), load(job.shape[4] + i), load(job.shape[5] + i)},
                      load_matrix(job.start, i),
                      load_matrix(job.end, i),
                      job.duration};
    Symmetric3<Pack> b = cases.shape;
    for (int n = 0; n < job.steps; ++n) b = step<I>(cases, b, n * dt, dt);
    const Pack components[6] = {b.xx, b.xy, b.xz, b.yy, b.yz, b.zz};
    for (std::size_t c = 0; c < 6; ++c) store(job.result[c] + i, components[c]);
  }
}

}  // namespace

extern const study::ShapeKernels shape_kernels;
const study::ShapeKernels shape_kernels = {
    integrate<ShapeIntegrator::rk3>, integrate<ShapeIntegrator::rk4>,
    integrate<ShapeIntegrator::exponential3>, integrate<ShapeIntegrator::exponential4>,
    integrate<ShapeIntegrator::midpoint>};

}  // namespace pileus::PILEUS_ISA
