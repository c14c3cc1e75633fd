// Whole runs of scenes against linear theory: growth rates of instabilities, dispersion of waves.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "base/progress.hpp"
#include "model/run.hpp"

namespace pileus::model {
namespace {

/// Runs configs/scenes/<scene>.yaml in a folder of its own, on one thread: tests run side by side,
/// and results do not depend on the number.
output::Summary summary_of(const std::string& scene, std::vector<std::string> overrides = {}) {
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  std::string folder = fmt::format("{}_{}_{}", test->test_suite_name(), test->name(),
                                   std::filesystem::path(scene).filename().string());
  for (char& c : folder)
    if (c == '/') c = '_';
  RunRequest request;
  request.scene_path = fmt::format("{}/configs/scenes/{}.yaml", PILEUS_SOURCE_DIR, scene);
  request.overrides = std::move(overrides);
  request.output_directory = (std::filesystem::path(testing::TempDir()) / folder).string();
  request.threads = 1;
  request.force = true;
  request.quiet = true;
  SilentProgress silent;
  const output::Summary summary = run(request, silent).summary;
  std::filesystem::remove_all(request.output_directory);
  return summary;
}

/// The value that the expectation of this diagnostic and statistic found.
double found(const output::Summary& summary, const std::string& diagnostic,
             const std::string& statistic) {
  for (const output::ExpectSummary& e : summary.expect)
    if (e.diagnostic == diagnostic && e.statistic == statistic) return e.value;
  ADD_FAILURE() << "the scene expects nothing of " << diagnostic << ", " << statistic;
  return std::nan("");
}

struct ShearLayer {
  std::string scene;
  double rate;  // s⁻¹
};

class KelvinHelmholtz : public testing::TestWithParam<ShearLayer> {};

// Rates of the Taylor–Goldstein equation for tanh z and J tanh z between walls at ±10, by shooting;
// without stratification Michalke (1964) has 0.1897 in unbounded fluid. Five per cent: the layer,
// of half-depth 1, is resolved by 3.2 cells.
TEST_P(KelvinHelmholtz, GrowsAsTheTaylorGoldsteinEquationSays) {
  const output::Summary summary = summary_of("kelvin_helmholtz/" + GetParam().scene);
  EXPECT_NEAR(found(summary, "wave_amplitude", "growth_rate") / GetParam().rate, 1, 0.05);
}

INSTANTIATE_TEST_SUITE_P(Layers, KelvinHelmholtz,
                         testing::Values(ShearLayer{"kelvin_helmholtz_alpha_30", 0.10894},
                                         ShearLayer{"kelvin_helmholtz_alpha_40", 0.12441},
                                         ShearLayer{"kelvin_helmholtz_alpha_50", 0.12357},
                                         ShearLayer{"kelvin_helmholtz_alpha_60", 0.10866},
                                         ShearLayer{"kelvin_helmholtz_unstratified", 0.18964}),
                         [](const auto& each) { return each.param.scene; });

// Miles (1961), Howard (1961): a Richardson number of 0.3 is stable. The wave starts at 0.9462
// times the vorticity's amplitude of 1e-3 (inversion by finite differences) and must not double.
TEST(StableShearLayer, DoesNotGrow) {
  const output::Summary summary = summary_of("kelvin_helmholtz/kelvin_helmholtz_stable");
  EXPECT_LT(found(summary, "wave_amplitude", "max"), 2 * 0.9462e-3);
}

struct Rotation {
  std::string coriolis;
  double rate;  // s⁻¹
};

class RayleighTaylor : public testing::TestWithParam<Rotation> {};

// Slope of the logarithm of <w cos z> over 2 ≤ t ≤ 5 in the linear initial-value problem
// (∂_t² + f²) w″ = κ² (∂_t² − cos z) w, κ² = 20, from rest with b = cos² z, by finite differences
// with 400 levels. The fastest mode alone grows at 0.88883 (f = 1) and 0.92527 s⁻¹ (f = 0); at
// these times the start is not yet forgotten. Six per cent at 16³.
TEST_P(RayleighTaylor, GrowsAsTheLinearInitialValueProblemSays) {
  const output::Summary summary = summary_of("rayleigh_taylor/rayleigh_taylor_growth_16",
                                             {"background.coriolis=" + GetParam().coriolis});
  EXPECT_NEAR(found(summary, "wave_amplitude", "growth_rate") / GetParam().rate, 1, 0.06);
}

INSTANTIATE_TEST_SUITE_P(Rotations, RayleighTaylor,
                         testing::Values(Rotation{"1 s-1", 0.89428}, Rotation{"0 s-1", 0.92302}),
                         [](const auto& each) { return "f_" + each.param.coriolis.substr(0, 1); });

struct Slope {
  std::string name, k;
};

class InternalWave : public testing::TestWithParam<Slope> {};

// σ = N k/√(k² + m²); one per cent at 16 cells per wavelength, 0.3 per cent at 32. Halving the
// spacing divides the error by at least six: what the compensated window and the compact difference
// leave is of fourth order (16), the walls' half cells weigh less than that (2³ = 8), less a
// quarter for their mixture.
TEST_P(InternalWave, FrequencyConvergesToTheDispersionRelation) {
  const std::vector<std::string> k = {"constants.k=" + GetParam().k};
  const double coarse = found(summary_of("internal_wave_2d/internal_wave_2d_small", k),
                              "vorticity_frequency_error", "final");
  const double fine = found(summary_of("internal_wave_2d/internal_wave_2d", k),
                            "vorticity_frequency_error", "final");
  EXPECT_LT(std::abs(coarse), 0.01);
  EXPECT_LT(std::abs(fine), 0.003);
  EXPECT_LT(std::abs(fine), std::abs(coarse) / 6);
}

INSTANTIATE_TEST_SUITE_P(Slopes, InternalWave,
                         testing::Values(Slope{"k_is_m", "1 m-1"}, Slope{"k_is_2m", "2 m-1"},
                                         Slope{"k_is_half_m", "0.5 m-1"}),
                         [](const auto& each) { return each.param.name; });

}  // namespace
}  // namespace pileus::model
