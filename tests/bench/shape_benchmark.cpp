// Errors and cost of ways to advance a shape matrix in a velocity gradient that changes with time:
// random positive definite B with det B = 1, random traceless S_start and S_end, S linear in time
// between, and a step of alpha over the worst-case strain (the largest eigenvalue of the symmetric
// part that either end has).
//
//   bench_shape [--data FILE]
//
// Needs AVX-512: the integrators are timed in packs of eight, compiled as the widest kernels are.
#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "dynamics/runge_kutta.hpp"
#include "dynamics/shape_update.hpp"
#include "parcels/simd.hpp"

namespace pileus::PILEUS_ISA {
namespace {

using dynamics::LowStorageScheme;

/// Eight cases; time runs from 0 to `duration` in units of one over the worst-case strain.
struct Cases {
  Symmetric3<Pack> shape;
  Matrix3<Pack> start, end;
};
constexpr double duration = 3.2;
constexpr int packs = 128;

Matrix3<Pack> gradient(const Cases& cases, double time) {
  return combine(1 - time / duration, cases.start, time / duration, cases.end);
}

Eigen::Matrix3d random_matrix(std::mt19937_64& engine) {
  std::normal_distribution<double> normal;
  Eigen::Matrix3d m;
  for (int i = 0; i < 9; ++i) m(i / 3, i % 3) = normal(engine);
  return m;
}

double largest_strain(const Eigen::Matrix3d& s) {
  const Eigen::Matrix3d symmetric = 0.5 * (s + s.transpose());
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(symmetric)
      .eigenvalues()
      .cwiseAbs()
      .maxCoeff();
}

void set_lane(Matrix3<Pack>& m, int lane, const Eigen::Matrix3d& s) {
  Pack* const entry[9] = {&m.xx, &m.xy, &m.xz, &m.yx, &m.yy, &m.yz, &m.zx, &m.zy, &m.zz};
  for (int i = 0; i < 9; ++i) (*entry[i])[lane] = s(i / 3, i % 3);
}

std::vector<Cases> random_cases() {
  std::mt19937_64 engine(20231);
  std::vector<Cases> all(packs);
  for (Cases& cases : all)
    for (int lane = 0; lane < lanes; ++lane) {
      Eigen::Matrix3d s[2];
      double strain = 0;
      for (Eigen::Matrix3d& m : s) {
        m = random_matrix(engine);
        m -= m.trace() / 3 * Eigen::Matrix3d::Identity();
        strain = std::max(strain, largest_strain(m));
      }
      set_lane(cases.start, lane, s[0] / strain);
      set_lane(cases.end, lane, s[1] / strain);
      const Eigen::Matrix3d g = random_matrix(engine);
      Eigen::Matrix3d b = g * g.transpose() + 0.1 * Eigen::Matrix3d::Identity();
      b /= std::cbrt(b.determinant());
      Pack* const entry[6] = {&cases.shape.xx, &cases.shape.xy, &cases.shape.xz,
                              &cases.shape.yy, &cases.shape.yz, &cases.shape.zz};
      const double value[6] = {b(0, 0), b(0, 1), b(0, 2), b(1, 1), b(1, 2), b(2, 2)};
      for (int c = 0; c < 6; ++c) (*entry[c])[lane] = value[c];
    }
  return all;
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

Symmetric3<Pack> midpoint_step(const Cases& cases, const Symmetric3<Pack>& b, double time,
                               double dt) {
  return congruence(exponential(scaled(broadcast(dt), gradient(cases, time + 0.5 * dt))), b);
}

enum Integrator { rk3, rk4, exponential3, exponential4, midpoint, integrators };
constexpr const char* names[integrators] = {"RK3 on dB/dt", "RK4 on dB/dt", "RK3 exponential",
                                            "RK4 exponential", "midpoint exponential"};

template <int I>
Symmetric3<Pack> step(const Cases& cases, const Symmetric3<Pack>& b, double time, double dt) {
  if constexpr (I == rk3)
    return runge_kutta_step(dynamics::williamson_3(), cases, b, time, dt);
  else if constexpr (I == rk4)
    return runge_kutta_step(dynamics::carpenter_kennedy_4(), cases, b, time, dt);
  else if constexpr (I == exponential3)
    return exponential_step(dynamics::williamson_3(), cases, b, time, dt);
  else if constexpr (I == exponential4)
    return exponential_step(dynamics::carpenter_kennedy_4(), cases, b, time, dt);
  else
    return midpoint_step(cases, b, time, dt);
}

template <int I>
Symmetric3<Pack> integrate(const Cases& cases, int steps) {
  Symmetric3<Pack> b = cases.shape;
  const double dt = duration / steps;
  for (int n = 0; n < steps; ++n) b = step<I>(cases, b, n * dt, dt);
  return b;
}

struct Errors {
  double shape = 0, determinant = 0;
  int broken = 0;  // shapes that are no longer positive definite
};

double squared_norm(const Symmetric3<Pack>& b, int lane) {
  const auto at = [&](const Pack& p) { return p[lane] * p[lane]; };
  return at(b.xx) + at(b.yy) + at(b.zz) + 2 * (at(b.xy) + at(b.xz) + at(b.yz));
}

/// r.m.s. over all cases of the relative Frobenius error of B and of the error of det B.
template <int I>
Errors errors(const std::vector<Cases>& all, const std::vector<Symmetric3<Pack>>& reference,
              int steps) {
  Errors sum;
  for (std::size_t c = 0; c < all.size(); ++c) {
    const Symmetric3<Pack> b = integrate<I>(all[c], steps);
    const Symmetric3<Pack> difference = scaled_sum(1.0, b, -1.0, reference[c]);
    const Pack det = determinant(b), minor = b.xx * b.yy - b.xy * b.xy;
    for (int lane = 0; lane < lanes; ++lane) {
      sum.shape += squared_norm(difference, lane) / squared_norm(reference[c], lane);
      sum.determinant += (det[lane] - 1) * (det[lane] - 1);
      sum.broken += !(det[lane] > 0 && minor[lane] > 0 && b.xx[lane] > 0);
    }
  }
  const double count = static_cast<double>(all.size()) * lanes;
  return {std::sqrt(sum.shape / count), std::sqrt(sum.determinant / count), sum.broken};
}

/// Nanoseconds of one step of one matrix at alpha = 0.2; best of many passes over all cases.
template <int I>
double cost(const std::vector<Cases>& all) {
  std::vector<Symmetric3<Pack>> out(all.size());
  double best = 1e300;
  for (int repeat = 0; repeat < 200; ++repeat) {
    const auto started = std::chrono::steady_clock::now();
    for (std::size_t c = 0; c < all.size(); ++c) out[c] = step<I>(all[c], all[c].shape, 0, 0.2);
    asm volatile("" : : "r"(out.data()) : "memory");
    best = std::min(
        best, std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count());
  }
  return best / (static_cast<double>(all.size()) * lanes) * 1e9;
}

constexpr int step_counts[] = {2, 4, 8, 16, 32, 64};  // alpha = 1.6 … 0.05

template <int I>
void report(const std::vector<Cases>& all, const std::vector<Symmetric3<Pack>>& reference,
            std::FILE* data) {
  fmt::print("\n{}: {:.1f} ns per step of one matrix\n", names[I], cost<I>(all));
  fmt::print("  {:>6} {:>10} {:>6} {:>10} {:>6} {:>7}\n", "alpha", "error B", "order", "error det",
             "order", "broken");
  if (data) fmt::print(data, "# {}\n", names[I]);
  Errors last;
  for (const int steps : step_counts) {
    const Errors e = errors<I>(all, reference, steps);
    const auto order = [&](double before, double now) {
      return steps == step_counts[0] || now < 1e-13
                 ? std::string("-")
                 : fmt::format("{:.2f}", std::log2(before / now));
    };
    fmt::print("  {:>6.2f} {:>10.2e} {:>6} {:>10.2e} {:>6} {:>7}\n", duration / steps, e.shape,
               order(last.shape, e.shape), e.determinant, order(last.determinant, e.determinant),
               e.broken);
    if (data)
      fmt::print(data, "{} {:.6e} {:.6e} {}\n", duration / steps, e.shape, e.determinant, e.broken);
    last = e;
  }
  if (data) fmt::print(data, "\n\n");
}

void run(const std::string& data_path) {
  const std::vector<Cases> all = random_cases();
  std::vector<Symmetric3<Pack>> reference;
  // Sixteen times finer than the finest: its error is 16⁻⁴ of what is compared with it.
  for (const Cases& cases : all) reference.push_back(integrate<exponential4>(cases, 1024));
  std::FILE* data = data_path.empty() ? nullptr : std::fopen(data_path.c_str(), "w");
  if (!data_path.empty() && !data) throw Error(ExitCode::file, data_path + " cannot be written");
  if (data) fmt::print(data, "# alpha, r.m.s. relative error of B, of det B, broken shapes\n");
  fmt::print("{} random cases over {} strain times, packs of eight, AVX-512\n", packs * lanes,
             duration);
  report<rk3>(all, reference, data);
  report<rk4>(all, reference, data);
  report<exponential3>(all, reference, data);
  report<exponential4>(all, reference, data);
  report<midpoint>(all, reference, data);
  if (data) std::fclose(data);
}

}  // namespace
}  // namespace pileus::PILEUS_ISA

int main(int argc, char** argv) {
  if (!__builtin_cpu_supports("avx512f") || !__builtin_cpu_supports("avx512dq")) {
    std::fputs("bench_shape needs a processor with AVX-512\n", stderr);
    return 2;
  }
  if (argc != 1 && !(argc == 3 && std::string(argv[1]) == "--data")) {
    std::fputs("bench_shape [--data FILE]\n", stderr);
    return 2;
  }
  try {
    pileus::PILEUS_ISA::run(argc == 3 ? argv[2] : "");
  } catch (const pileus::Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return static_cast<int>(error.code());
  }
  return 0;
}
