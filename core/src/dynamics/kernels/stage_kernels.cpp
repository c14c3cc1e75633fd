// One Runge–Kutta stage for eight parcels at a time: interpolate, turn, deform, move.
// Compiled once per instruction set (see pileus_add_kernels).
#include "dynamics/kernels.hpp"
#include "dynamics/shape_update.hpp"
#include "parcels/stencil.hpp"

namespace pileus::PILEUS_ISA {
namespace {

using dynamics::GivenStageJob;
using dynamics::ShapeIntegrator;
using dynamics::ShapeJob;
using dynamics::StageJob;
using mesh::FlowRecord;

/// Flow at eight parcels: value f of the flow record in pack f. Lanes from `count` on are zero.
void interpolate(const double* flow, const Stencil<3>& stencil, std::size_t count, Pack (&low)[8],
                 Pack (&high)[8]) {
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    if (lane >= count) {
      low[lane] = high[lane] = Pack{};
      continue;
    }
    // Two chains per half of the record: the sums are latency-bound otherwise.
    Pack low_a{}, low_b{}, high_a{}, high_b{};
    for_each_column(stencil, static_cast<int>(lane),
                    [&](std::int32_t at, double below, double above) {
                      const Pack* node = reinterpret_cast<const Pack*>(flow) + 2 * std::size_t(at);
                      low_a += below * node[0];
                      high_a += below * node[1];
                      low_b += above * node[2];
                      high_b += above * node[3];
                    });
    low[lane] = low_a + low_b;
    high[lane] = high_a + high_b;
  }
  transpose(low);
  transpose(high);
}

void interpolate(const double* flow, const Stencil<2>& stencil, std::size_t count,
                 Pack (&value)[8]) {
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    if (lane >= count) {
      value[lane] = Pack{};
      continue;
    }
    Pack a{}, b{};
    for_each_column(stencil, static_cast<int>(lane),
                    [&](std::int32_t at, double below, double above) {
                      const Pack* node = reinterpret_cast<const Pack*>(flow) + std::size_t(at);
                      a += below * node[0];
                      b += above * node[1];
                    });
    value[lane] = a + b;
  }
  transpose(value);
}

/// k ← A k + f (k ← f in the first stage), returned and stored.
Pack accumulate(double* increment, std::size_t p, Pack f, double keep, bool first) {
  const Pack k = first ? f : keep * load(increment + p) + f;
  store(increment + p, k);
  return k;
}

/// Cube root of numbers near one (Newton from one), any other number lane by lane.
Pack cube_root_near_one(Pack r) {
  Pack s = broadcast(1.0) + (r - 1.0) * (1.0 / 3.0);
  for (int newton = 0; newton < 3; ++newton) s = s - (s - r / (s * s)) * (1.0 / 3.0);
  for (int lane = 0; lane < lanes; ++lane)
    if (!(r[lane] > 0.9 && r[lane] < 1.1)) s[lane] = __builtin_cbrt(r[lane]);
  return s;
}

/// Lanes among the first `count` where the condition holds.
std::size_t count_lanes(Mask m, std::size_t count) {
  std::size_t n = 0;
  for (std::size_t lane = 0; lane < lanes && lane < count; ++lane) n += m[lane] != 0;
  return n;
}

/// (abc)² of an ellipsoid of the given volume, (3V/4π)².
Pack squared_axes_product_3d(Pack volume) {
  const Pack abc = volume * 0.23873241463784300365;  // 3/(4π)
  return abc * abc;
}

Pack cube_root(Pack x) {
  for (int lane = 0; lane < lanes; ++lane) x[lane] = __builtin_cbrt(x[lane]);
  return x;
}

/// A shape with det B = target whose longest half-axis is at most `limit` times the others:
/// directions are kept, what is thinner is made as thick as that. What has no longest axis is a
/// sphere.
Symmetric3<Pack> blunted(const Symmetric3<Pack>& b, Pack target, double limit) {
  const auto axes = principal_axes(b);
  const Vector3<Pack> n = axes.major, m = axes.middle, l = cross(n, m);
  const auto measurable = (axes.a2 > 0.0) & (axes.a2 < 1e300);
  const Pack zero{}, one = broadcast(1.0), least = broadcast(1.0 / (limit * limit));
  const Pack a2 = select(measurable, axes.a2, one);
  // Ratios to the longest axis, so that products neither over- nor underflow.
  const Pack b2 = select(measurable, maximum(axes.b2 / a2, least), one);
  const Pack c2 = select(measurable, maximum(axes.c2 / a2, least), one);
  const Pack radius2 = cube_root(target), scale = radius2 / cube_root(b2 * c2);
  const auto sum = [&](Pack nn, Pack mm, Pack ll, Pack sphere) {
    return select(measurable, scale * (nn + b2 * mm + c2 * ll), sphere);
  };
  return {
      sum(n.x * n.x, m.x * m.x, l.x * l.x, radius2), sum(n.x * n.y, m.x * m.y, l.x * l.y, zero),
      sum(n.x * n.z, m.x * m.z, l.x * l.z, zero),    sum(n.y * n.y, m.y * m.y, l.y * l.y, radius2),
      sum(n.y * n.z, m.y * m.z, l.y * l.z, zero),    sum(n.z * n.z, m.z * m.z, l.z * l.z, radius2)};
}

/// The same of an ellipse, given the root of the target.
Symmetric2<Pack> blunted(const Symmetric2<Pack>& b, Pack ab, double limit) {
  const auto axes = principal_axes(b);
  const auto measurable = (axes.a2 > 0.0) & (axes.a2 < 1e300);
  const Pack one = broadcast(1.0), least = broadcast(1.0 / (limit * limit));
  const Pack a2 = select(measurable, axes.a2, one);
  const Pack b2 = select(measurable, maximum(axes.b2 / a2, least), one);
  const Pack scale = ab * square_root(1.0 / b2);
  const Pack x = axes.major_x, z = axes.major_z;
  return {select(measurable, scale * (x * x + b2 * z * z), ab),
          select(measurable, scale * (1.0 - b2) * x * z, Pack{}),
          select(measurable, scale * (z * z + b2 * x * x), ab)};
}

constexpr double inverse_pi = 0.31830988618379067154;

/// Whether a shape can be computed with. The determinant of a needle of aspect ratio λ is a
/// difference that keeps 1/λ⁴ of its terms: beyond the limit it is rounding and says nothing.
auto is_healthy(const Symmetric3<Pack>& b, Pack det, Pack target, double limit) {
  const Pack trace = b.xx + b.yy + b.zz;
  // (abc)²/(a² + b² + c²)³ is λ⁻⁴ for a needle, b = c, and λ⁻²/8 for a disc, a = b, whose
  // determinant loses less: discs may be as flat as limit²/√8.
  const double thinnest = 1.0 / (limit * limit * limit * limit);
  return (det > 0.0) & (b.xx > 0.0) & (b.xx * b.yy - b.xy * b.xy > 0.0) &
         (target > thinnest * (trace * trace * trace));
}

auto is_healthy(const Symmetric2<Pack>& b, Pack det, Pack target, double limit) {
  const Pack trace = b.xx + b.zz;
  return (det > 0.0) & (b.xx > 0.0) & (target > 1.0 / (limit * limit) * (trace * trace));
}

template <class Mask>
Symmetric3<Pack> choose(Mask mask, const Symmetric3<Pack>& a, const Symmetric3<Pack>& b) {
  return {select(mask, a.xx, b.xx), select(mask, a.xy, b.xy), select(mask, a.xz, b.xz),
          select(mask, a.yy, b.yy), select(mask, a.yz, b.yz), select(mask, a.zz, b.zz)};
}

template <class Mask>
Symmetric2<Pack> choose(Mask mask, const Symmetric2<Pack>& a, const Symmetric2<Pack>& b) {
  return {select(mask, a.xx, b.xx), select(mask, a.xz, b.xz), select(mask, a.zz, b.zz)};
}

/// Restores det B exactly. A shape that is not healthy is blunted.
Symmetric3<Pack> close_shape(Symmetric3<Pack> b, Pack volume, std::size_t count, double limit,
                             std::size_t& broken) {
  const Pack target = squared_axes_product_3d(volume);
  const Pack det = determinant(b);
  const auto healthy = is_healthy(b, det, target, limit);
  const Pack s = cube_root_near_one(select(healthy, target / det, broadcast(1.0)));
  const Symmetric3<Pack> whole{s * b.xx, s * b.xy, s * b.xz, s * b.yy, s * b.yz, s * b.zz};
  const std::size_t lost = count - count_lanes(healthy, count);
  if (lost == 0) [[likely]]
    return whole;
  broken += lost;
  return choose(healthy, whole, blunted(b, target, limit));
}

Symmetric2<Pack> close_shape(Symmetric2<Pack> b, Pack area, std::size_t count, double limit,
                             std::size_t& broken) {
  const Pack ab = area * inverse_pi;
  const Pack target = ab * ab;
  const Pack det = determinant(b);
  const auto healthy = is_healthy(b, det, target, limit);
  const Pack s = square_root(select(healthy, target / det, broadcast(1.0)));
  const Symmetric2<Pack> whole{s * b.xx, s * b.xz, s * b.zz};
  const std::size_t lost = count - count_lanes(healthy, count);
  if (lost == 0) [[likely]]
    return whole;
  broken += lost;
  return choose(healthy, whole, blunted(b, ab, limit));
}

void store_shape(double* const* shape, std::size_t p, const Symmetric3<Pack>& b) {
  store(shape[0] + p, b.xx);
  store(shape[1] + p, b.xy);
  store(shape[2] + p, b.xz);
  store(shape[3] + p, b.yy);
  store(shape[4] + p, b.yz);
  store(shape[5] + p, b.zz);
}

void store_shape(double* const* shape, std::size_t p, const Symmetric2<Pack>& b) {
  store(shape[0] + p, b.xx);
  store(shape[1] + p, b.xz);
  store(shape[2] + p, b.zz);
}

void advance_shape(StageJob<3>& job, std::size_t p, std::size_t count, const Matrix3<Pack>& s) {
  Symmetric3<Pack> b{load(job.shape[0] + p), load(job.shape[1] + p), load(job.shape[2] + p),
                     load(job.shape[3] + p), load(job.shape[4] + p), load(job.shape[5] + p)};
  const auto grow = [&](int c, Pack f) {
    return accumulate(job.shape_increment[c], p, f, job.keep, job.first);
  };
  if (job.shape_integrator == ShapeIntegrator::exponential) {
    Matrix3<Pack> z;
    z.xx = grow(0, s.xx);
    z.xy = grow(1, s.xy);
    z.xz = grow(2, s.xz);
    z.yx = grow(3, s.yx);
    z.yy = grow(4, s.yy);
    z.yz = grow(5, s.yz);
    z.zx = grow(6, s.zx);
    z.zy = grow(7, s.zy);
    z.zz = -(z.xx + z.yy);
    if (job.evaluate_only) return;
    b = congruence(exponential(scaled(broadcast(job.advance), z)), b);
  } else {
    const Symmetric3<Pack> rate = shape_rate(s, b);
    const Symmetric3<Pack> k{grow(0, rate.xx), grow(1, rate.xy), grow(2, rate.xz),
                             grow(3, rate.yy), grow(4, rate.yz), grow(5, rate.zz)};
    if (job.evaluate_only) return;
    b = {b.xx + job.advance * k.xx, b.xy + job.advance * k.xy, b.xz + job.advance * k.xz,
         b.yy + job.advance * k.yy, b.yz + job.advance * k.yz, b.zz + job.advance * k.zz};
  }
  if (job.last) b = close_shape(b, load(job.size_volume + p), count, job.aspect_limit, job.broken);
  store_shape(job.shape, p, b);
}

void advance_shape(StageJob<2>& job, std::size_t p, std::size_t count, const Matrix2<Pack>& s) {
  Symmetric2<Pack> b{load(job.shape[0] + p), load(job.shape[1] + p), load(job.shape[2] + p)};
  const auto grow = [&](int c, Pack f) {
    return accumulate(job.shape_increment[c], p, f, job.keep, job.first);
  };
  if (job.shape_integrator == ShapeIntegrator::exponential) {
    Matrix2<Pack> z;
    z.xx = grow(0, s.xx);
    z.xz = grow(1, s.xz);
    z.zx = grow(2, s.zx);
    z.zz = -z.xx;
    if (job.evaluate_only) return;
    const double h = job.advance;
    b = congruence(exponential(Matrix2<Pack>{h * z.xx, h * z.xz, h * z.zx, h * z.zz}), b);
  } else {
    const Symmetric2<Pack> rate = shape_rate(s, b);
    const Symmetric2<Pack> k{grow(0, rate.xx), grow(1, rate.xz), grow(2, rate.zz)};
    if (job.evaluate_only) return;
    b = {b.xx + job.advance * k.xx, b.xz + job.advance * k.xz, b.zz + job.advance * k.zz};
  }
  if (job.last) b = close_shape(b, load(job.size_volume + p), count, job.aspect_limit, job.broken);
  store_shape(job.shape, p, b);
}

/// k ← A k + f and, unless only evaluating, y ← y + B Δt k for one variable.
void advance(double* y, double* increment, std::size_t p, Pack f, double keep, double step,
             bool first, bool evaluate_only) {
  const Pack k = accumulate(increment, p, f, keep, first);
  if (!evaluate_only) store(y + p, load(y + p) + step * k);
}

void stage_3d(StageJob<3>& job) {
  using R = FlowRecord<3>;
  Stencil<3> stencil;
  OffsetBlock<3> block;
  for (std::size_t p = job.begin; p < job.end; p += lanes) {
    const std::size_t count = job.end - p;
    place_points(job, p, block, stencil);
    Pack low[8], high[8];
    interpolate(job.flow, stencil, count, low, high);
    const auto value = [&](int f) { return f < 8 ? low[f] : high[f - 8]; };
    for (int d = 0; d < 3; ++d)
      advance(job.position[d], job.position_increment[d], p, value(R::u + d), job.keep, job.advance,
              job.first, job.evaluate_only);
    for (int d = 0; d < 3; ++d)
      advance(job.vorticity[d], job.vorticity_increment[d], p, value(R::tendency + d), job.keep,
              job.advance, job.first, job.evaluate_only);
    const Pack w_z = -(value(R::u_x) + value(R::v_y));
    advance_shape(job, p, count < lanes ? count : lanes,
                  Matrix3<Pack>{value(R::u_x), value(R::u_y), value(R::u_z), value(R::v_x),
                                value(R::v_y), value(R::v_z), value(R::w_x), value(R::w_y), w_z});
  }
}

void stage_2d(StageJob<2>& job) {
  using R = FlowRecord<2>;
  Stencil<2> stencil;
  OffsetBlock<2> block;
  for (std::size_t p = job.begin; p < job.end; p += lanes) {
    const std::size_t count = job.end - p;
    place_points(job, p, block, stencil);
    Pack value[8];
    interpolate(job.flow, stencil, count, value);
    for (int d = 0; d < 2; ++d)
      advance(job.position[d], job.position_increment[d], p, value[R::u + d], job.keep, job.advance,
              job.first, job.evaluate_only);
    advance(job.vorticity[0], job.vorticity_increment[0], p, value[R::tendency], job.keep,
            job.advance, job.first, job.evaluate_only);
    advance_shape(job, p, count < lanes ? count : lanes,
                  Matrix2<Pack>{value[R::u_x], value[R::u_z], value[R::w_x], -value[R::u_x]});
  }
}

void given_stage_3d(GivenStageJob<3>& job) {
  for (std::size_t p = job.begin; p < job.end; p += lanes) {
    const std::size_t count = job.end - p, i = p - job.begin;
    for (int d = 0; d < 3; ++d)
      advance(job.position[d], job.position_increment[d], p, load(job.velocity[d] + i), job.keep,
              job.advance, job.first, job.evaluate_only);
    const auto gradient = [&](int c) { return load(job.gradient[c] + i); };
    advance_shape(
        job, p, count < lanes ? count : lanes,
        Matrix3<Pack>{gradient(0), gradient(1), gradient(2), gradient(3), gradient(4), gradient(5),
                      gradient(6), gradient(7), -(gradient(0) + gradient(4))});
  }
}

void given_stage_2d(GivenStageJob<2>& job) {
  for (std::size_t p = job.begin; p < job.end; p += lanes) {
    const std::size_t count = job.end - p, i = p - job.begin;
    for (int d = 0; d < 2; ++d)
      advance(job.position[d], job.position_increment[d], p, load(job.velocity[d] + i), job.keep,
              job.advance, job.first, job.evaluate_only);
    const Pack u_x = load(job.gradient[0] + i);
    advance_shape(job, p, count < lanes ? count : lanes,
                  Matrix2<Pack>{u_x, load(job.gradient[1] + i), load(job.gradient[2] + i), -u_x});
  }
}

void blunt_shapes_3d(ShapeJob<3>& job) {
  for (std::size_t p = job.begin; p < job.end; p += lanes) {
    const std::size_t count = std::min<std::size_t>(job.end - p, lanes);
    const Symmetric3<Pack> b{load(job.shape[0] + p), load(job.shape[1] + p),
                             load(job.shape[2] + p), load(job.shape[3] + p),
                             load(job.shape[4] + p), load(job.shape[5] + p)};
    const Pack target = squared_axes_product_3d(load(job.size_volume + p));
    const auto healthy = is_healthy(b, determinant(b), target, job.aspect_limit);
    const std::size_t lost = count - count_lanes(healthy, count);
    if (lost == 0) [[likely]]
      continue;
    job.broken += lost;
    store_shape(job.shape, p, choose(healthy, b, blunted(b, target, job.aspect_limit)));
  }
}

void blunt_shapes_2d(ShapeJob<2>& job) {
  for (std::size_t p = job.begin; p < job.end; p += lanes) {
    const std::size_t count = std::min<std::size_t>(job.end - p, lanes);
    const Symmetric2<Pack> b{load(job.shape[0] + p), load(job.shape[1] + p),
                             load(job.shape[2] + p)};
    const Pack ab = load(job.size_volume + p) * inverse_pi;
    const auto healthy = is_healthy(b, determinant(b), ab * ab, job.aspect_limit);
    const std::size_t lost = count - count_lanes(healthy, count);
    if (lost == 0) [[likely]]
      continue;
    job.broken += lost;
    store_shape(job.shape, p, choose(healthy, b, blunted(b, ab, job.aspect_limit)));
  }
}

}  // namespace

const dynamics::Kernels dynamics_kernels = {.stage_3d = stage_3d,
                                            .stage_2d = stage_2d,
                                            .given_stage_3d = given_stage_3d,
                                            .given_stage_2d = given_stage_2d,
                                            .blunt_shapes_3d = blunt_shapes_3d,
                                            .blunt_shapes_2d = blunt_shapes_2d};

}  // namespace pileus::PILEUS_ISA
