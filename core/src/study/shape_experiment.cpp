#include "study/shape_experiment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <numbers>
#include <random>

#include "base/nearest_word.hpp"
#include "base/version.hpp"
#include "parcels/kernels.hpp"
#include "study/shape_kernels.hpp"

namespace pileus::study {

namespace {

constexpr std::size_t case_count = 1024;
constexpr double duration = 3.2;  // over the worst-case strain
constexpr int reference_steps = 1024;
constexpr int timed_passes = 40;

using Matrix = std::array<double, 9>;  // row by row
using Shapes = std::array<std::vector<double>, 6>;

/// The random cases, as arrays over them.
struct Cases {
  Shapes shape;
  std::array<std::vector<double>, 9> start, end;
};

Matrix random_matrix(std::mt19937_64& engine) {
  std::normal_distribution<double> normal;
  Matrix m;
  for (double& entry : m) entry = normal(engine);
  return m;
}

/// Largest magnitude of an eigenvalue of the symmetric part of a traceless matrix, from the
/// trigonometric solution of its characteristic equation.
double largest_strain(const Matrix& m) {
  const double xy = 0.5 * (m[1] + m[3]), xz = 0.5 * (m[2] + m[6]), yz = 0.5 * (m[5] + m[7]);
  const double xx = m[0], yy = m[4], zz = m[8];
  const double p = std::sqrt((xx * xx + yy * yy + zz * zz + 2 * (xy * xy + xz * xz + yz * yz)) / 6);
  if (p == 0) return 0;
  const double determinant =
      xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz);
  const double angle = std::acos(std::clamp(determinant / (2 * p * p * p), -1.0, 1.0)) / 3;
  return 2 * p * std::max(std::cos(angle), std::abs(std::cos(angle + 2 * std::numbers::pi / 3)));
}

/// Positive definite with determinant one.
std::array<double, 6> random_shape(std::mt19937_64& engine) {
  const Matrix g = random_matrix(engine);
  std::array<double, 6> b{};
  std::size_t entry = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = i; j < 3; ++j, ++entry) {
      for (std::size_t k = 0; k < 3; ++k) b[entry] += g[3 * i + k] * g[3 * j + k];
      if (i == j) b[entry] += 0.1;
    }
  }
  const double determinant = b[0] * (b[3] * b[5] - b[4] * b[4]) -
                             b[1] * (b[1] * b[5] - b[4] * b[2]) +
                             b[2] * (b[1] * b[4] - b[3] * b[2]);
  for (double& value : b) value /= std::cbrt(determinant);
  return b;
}

Cases random_cases() {
  std::mt19937_64 engine(20231);
  Cases cases;
  for (std::size_t n = 0; n < case_count; ++n) {
    std::array<Matrix, 2> ends;
    double strain = 0;
    for (Matrix& m : ends) {
      m = random_matrix(engine);
      const double third = (m[0] + m[4] + m[8]) / 3;
      for (const std::size_t d : {0U, 4U, 8U}) m[d] -= third;
      strain = std::max(strain, largest_strain(m));
    }
    for (std::size_t e = 0; e < 9; ++e) {
      cases.start[e].push_back(ends[0][e] / strain);
      cases.end[e].push_back(ends[1][e] / strain);
    }
    const std::array<double, 6> shape = random_shape(engine);
    for (std::size_t c = 0; c < 6; ++c) cases.shape[c].push_back(shape[c]);
  }
  return cases;
}

void integrate(ShapeIntegrator integrator, const Cases& cases, int steps, Shapes& result) {
  ShapeJob job{};
  for (std::size_t c = 0; c < 6; ++c) {
    result[c].resize(case_count);
    job.shape[c] = cases.shape[c].data();
    job.result[c] = result[c].data();
  }
  for (std::size_t e = 0; e < 9; ++e) {
    job.start[e] = cases.start[e].data();
    job.end[e] = cases.end[e].data();
  }
  job.count = case_count;
  job.duration = duration;
  job.steps = steps;
  shape_kernels()[static_cast<std::size_t>(integrator)](job);
}

double squared_norm(const std::array<double, 6>& b) {
  return b[0] * b[0] + b[3] * b[3] + b[5] * b[5] + 2 * (b[1] * b[1] + b[2] * b[2] + b[4] * b[4]);
}

std::map<std::string, double> compare(const Shapes& shapes, const Shapes& reference) {
  double shape = 0, determinant = 0;
  int broken = 0;
  for (std::size_t n = 0; n < case_count; ++n) {
    std::array<double, 6> b{}, right{}, difference{};
    for (std::size_t c = 0; c < 6; ++c) {
      b[c] = shapes[c][n];
      right[c] = reference[c][n];
      difference[c] = b[c] - right[c];
    }
    const double minor = b[0] * b[3] - b[1] * b[1];
    const double det = b[0] * (b[3] * b[5] - b[4] * b[4]) - b[1] * (b[1] * b[5] - b[4] * b[2]) +
                       b[2] * (b[1] * b[4] - b[3] * b[2]);
    shape += squared_norm(difference) / squared_norm(right);
    determinant += (det - 1) * (det - 1);
    broken += !(det > 0 && minor > 0 && b[0] > 0);
  }
  return {{"shape_error", std::sqrt(shape / case_count)},
          {"determinant_error", std::sqrt(determinant / case_count)},
          {"broken_shapes", broken}};
}

/// ns per shape of the whole way.
double cost_of(ShapeIntegrator integrator, const Cases& cases, int steps, Shapes& result) {
  double best = std::numeric_limits<double>::infinity();
  for (int pass = 0; pass < timed_passes; ++pass) {
    const auto started = std::chrono::steady_clock::now();
    integrate(integrator, cases, steps, result);
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - started;
    best = std::min(best, taken.count());
  }
  return best / case_count * 1e9;
}

const Rung* rung_of(const Layout& layout, const Point& point, const std::string& key) {
  for (std::size_t k = 0; k < layout.knobs.size(); ++k)
    if (layout.knobs[k].keys.front() == key && point.rungs[k] >= 0)
      return &layout.knobs[k].ladder[static_cast<std::size_t>(point.rungs[k])];
  return nullptr;
}

}  // namespace

const std::vector<std::string>& shape_integrator_names() {
  static const std::vector<std::string> names = {"rk3", "rk4", "exponential3", "exponential4",
                                                 "midpoint"};
  return names;
}

void check_shape_knobs(const Study& study, const Layout& layout, scene::Problems& problems) {
  const std::vector<std::string>& words = shape_integrator_names();
  for (const char* wanted : {"integrator", "alpha"}) {
    const auto found = std::find_if(
        layout.knobs.begin(), layout.knobs.end(),
        [&](const Knob& knob) { return !knob.keys.empty() && knob.keys.front() == wanted; });
    if (found == layout.knobs.end())
      problems.add(
          {study.path, 1, 1},
          fmt::format("the experiment 'shape_integrators' needs a knob with the key '{}'", wanted));
  }
  for (const Knob& knob : layout.knobs) {
    const std::string key = knob.keys.empty() ? std::string() : knob.keys.front();
    if (key != "integrator" && key != "alpha")
      problems.add(knob.where,
                   fmt::format("the experiment 'shape_integrators' has the keys 'integrator' and "
                               "'alpha', found '{}'",
                               key));
    for (const Rung& rung : knob.ladder) {
      const scene::Node& value = rung.settings.front().value;
      if (key == "alpha" && !(rung.number > 0))
        problems.add(value.where, "'alpha' is a number greater than 0", value.width());
      if (key != "integrator" || std::find(words.begin(), words.end(), value.text) != words.end())
        continue;
      problems.add(value.where,
                   fmt::format("there is no integrator '{}'; there is {}", value.text,
                               scene::alternatives(words)),
                   value.width());
    }
  }
  if (study.combine != Study::Combine::product)
    problems.add({study.path, 1, 1},
                 "the experiment 'shape_integrators' needs both of its knobs: combine: product");
}

RunOutcome run_shape_experiment(const Layout& layout, const Point& point) {
  static const Cases cases = random_cases();
  static const Shapes reference = [] {
    Shapes shapes;
    integrate(ShapeIntegrator::exponential4, cases, reference_steps, shapes);
    return shapes;
  }();
  const std::vector<std::string>& words = shape_integrator_names();
  const std::string& word = rung_of(layout, point, "integrator")->settings.front().value.text;
  const auto integrator =
      static_cast<ShapeIntegrator>(std::find(words.begin(), words.end(), word) - words.begin());
  const double alpha = rung_of(layout, point, "alpha")->number;
  const int steps = std::max(1, static_cast<int>(std::lround(duration / alpha)));
  RunOutcome outcome;
  Shapes shapes;
  const auto started = std::chrono::steady_clock::now();
  outcome.core_time = outcome.wall_time = cost_of(integrator, cases, steps, shapes);
  outcome.numbers = compare(shapes, reference);
  outcome.parcels = case_count;
  outcome.steps = steps;
  outcome.commit = build_record().commit;
  outcome.date = date_now();
  outcome.total_wall =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  return outcome;
}

const ShapeKernels& shape_kernels() {
  static const ShapeKernels& table = []() -> const ShapeKernels& {
    const std::string_view name = parcels::chosen_instruction_set();
    if (name == "avx512") return avx512::shape_kernels;
    if (name == "avx2") return avx2::shape_kernels;
    return baseline::shape_kernels;
  }();
  return table;
}

}  // namespace pileus::study
