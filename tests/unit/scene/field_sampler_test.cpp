// Fields at points: every form, noise by cell, and the same bits for any number of threads.
#include "scene/field_sampler.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>

#include "base/error.hpp"
#include "scene_text.hpp"

namespace pileus::scene {
namespace {

std::vector<double> sampled(const Scene& scene, const FieldDescription& field,
                            const std::vector<double>& x, const std::vector<double>& y,
                            const std::vector<double>& z) {
  std::vector<double> out(x.size());
  FieldSampler(field, scene).sample(x.size(), x.data(), y.data(), z.data(), out.data());
  return out;
}

const FieldDescription& buoyancy(const Scene& scene) {
  return scene.initial.scalars.at("buoyancy");
}

TEST(FieldSampler, EvaluatesNamedFormulasInTheirOrder) {
  const Scene scene =
      scene_of("constants: {H: 1 km}\nformulas: {s: x + y, t: s*z, unused: 1/(x - x)}\n" + cube +
               "initial: {buoyancy: t/H + s}\n");
  const auto out = sampled(scene, buoyancy(scene), {1, 2}, {10, 20}, {100, 200});
  EXPECT_EQ(out[0], 11 * 100.0 / 1000 + 11);
  EXPECT_EQ(out[1], 22 * 200.0 / 1000 + 22);
}

TEST(FieldSampler, ProfilesAreLinearBetweenAndConstantBeyond) {
  const Scene scene =
      scene_of(cube + "initial: {buoyancy: {height: [100, 200, 400], value: [1, 3, 2]}}\n");
  const std::vector<double> zero(7, 0.0), z = {0, 100, 150, 200, 300, 400, 900};
  EXPECT_EQ(sampled(scene, buoyancy(scene), zero, zero, z),
            (std::vector<double>{1, 1, 2, 3, 2.5, 2, 2}));
}

TEST(FieldSampler, NoiseIsOnePerCellInsideItsLayer) {
  const Scene scene = scene_of(cube +
                               "initial: {buoyancy: {constant: 5, noise: {amplitude: 0.5, "
                               "layer: [0 m, 500 m], seed: 9}}}\n");
  // Cells are 125 m: two points of one cell, one of its image a period away, one of the next cell,
  // one above the layer.
  const auto out = sampled(scene, buoyancy(scene), {10, 120, 1010, 130, 10}, {10, 5, 10, 10, 10},
                           {10, 100, 20, 10, 600});
  EXPECT_EQ(out[0], out[1]);
  EXPECT_EQ(out[0], out[2]);
  EXPECT_NE(out[0], out[3]);
  EXPECT_EQ(out[4], 5);
  EXPECT_LE(std::abs(out[0] - 5), 0.5);
  EXPECT_NE(out[0], 5);
}

TEST(FieldSampler, NoiseIsUniform) {
  const Scene scene = scene_of(
      "domain: {extent: 32 m, cells: [32, 32, 32]}\ntime: {end: 1}\n"
      "initial: {buoyancy: {constant: 0, noise: {amplitude: 1, seed: 3}}}\n");
  std::vector<double> x, y, z;
  for (int i = 0; i < 32 * 32 * 32; ++i) {
    x.push_back(i % 32 + 0.5);
    y.push_back(i / 32 % 32 + 0.5);
    z.push_back(i / 1024 + 0.5);
  }
  const auto out = sampled(scene, buoyancy(scene), x, y, z);
  double mean = 0, square = 0;
  for (const double value : out) {
    mean += value / static_cast<double>(out.size());
    square += value * value / static_cast<double>(out.size());
  }
  // Standard errors of n draws from U(-1, 1): mean sqrt(1/3/n), mean square sqrt(4/45/n); five
  // each.
  const double n = static_cast<double>(out.size());
  EXPECT_NEAR(mean, 0, 5 * std::sqrt(1.0 / 3 / n));
  EXPECT_NEAR(square, 1.0 / 3, 5 * std::sqrt(4.0 / 45 / n));
}

TEST(FieldSampler, SameBitsForAnyNumberOfThreads) {
  const Scene scene = scene_of("formulas: {r: sqrt(x^2 + y^2 + z^2)}\n" + cube +
                               "initial: {buoyancy: {formula: 'r > 500 ? exp(-r/300) : tanh(r)', "
                               "noise: {amplitude: 1e-3}}}\n");
  std::vector<double> x, y, z;
  for (int i = 0; i < 20000; ++i) {
    x.push_back(std::fmod(i * 0.37, 1000.0));
    y.push_back(std::fmod(i * 1.91, 1000.0));
    z.push_back(std::fmod(i * 0.11, 1000.0));
  }
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const auto one = sampled(scene, buoyancy(scene), x, y, z);
  omp_set_num_threads(3);
  const auto three = sampled(scene, buoyancy(scene), x, y, z);
  omp_set_num_threads(threads);
  EXPECT_EQ(one, three);
}

TEST(FieldSampler, NamesTheFirstPointWithoutAValue) {
  const Scene scene = scene_of(cube + "initial: {buoyancy: sqrt(500 - x)}\n");
  try {
    sampled(scene, buoyancy(scene), {1, 600, 700}, {0, 0, 0}, {2, 3, 4});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::usage);
    EXPECT_STREQ(
        error.what(),
        "scene.yaml:3:21: error: the field is not a number at x = 600 m, y = 0 m, z = 3 m");
  }
}

TEST(FieldSampler, NeedsNoYInTwoDimensions) {
  const Scene scene = scene_of(
      "domain: {extent: [1 km, 1 km], cells: [8, 8]}\ntime: {end: 1}\ninitial: {buoyancy: x + 2*z "
      "+ y}\n");
  const double x = 3, z = 4;
  double out = 0;
  FieldSampler(buoyancy(scene), scene).sample(1, &x, nullptr, &z, &out);
  EXPECT_EQ(out, 11);
}

TEST(FieldSampler, KnowsWhatDependsOnHeightAlone) {
  const Scene scene = scene_of("formulas: {a: 2*z, b: a + x}\n" + cube +
                               "initial: {buoyancy: a + 1, passive_tracer: b}\n");
  EXPECT_TRUE(FieldSampler(buoyancy(scene), scene).height_alone());
  EXPECT_FALSE(FieldSampler(scene.initial.scalars.at("passive_tracer"), scene).height_alone());
}

// Where a formula and the analytic state of the moist thermal meet: the sphere's centre holds b_0.
TEST(FieldSampler, MoistThermalAtItsCentreAndOutside) {
  const Scene scene = read_scene(std::string(PILEUS_SOURCE_DIR) +
                                 "/configs/scenes/moist_thermal/moist_thermal.yaml");
  const auto& water = scene.initial.scalars.at("total_water_mass_fraction");
  const auto& dry = scene.initial.scalars.at("liquid_water_buoyancy");
  const std::vector<double> x = {3140, 3140, 3140, 100}, y = {3140, 3140, 3140, 100},
                            z = {800, 6280, 3000, 1000};
  const auto b = sampled(scene, dry, x, y, z);
  const auto q = sampled(scene, water, x, y, z);
  EXPECT_NEAR(b[0], 0.1523690, 0.5e-7);
  EXPECT_NEAR(q[0], 1.231275e-3, 0.5e-9);
  EXPECT_NEAR(b[1], 0.367108, 0.5e-6);  // published with the set-up: b_l at the top
  EXPECT_NEAR(q[1], 2.25e-5, 0.5e-7);
  EXPECT_NEAR(q[2], 0.015 * 0.8 * std::exp(-3.0), 1e-18);
  EXPECT_EQ(b[3], 0);
  EXPECT_NEAR(q[3], 1.108147e-3, 0.5e-9);
}

}  // namespace
}  // namespace pileus::scene
