// Reading scenes: values, defaults, overrides, inheritance, and the resolved scene.
#include "scene/read_scene.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "base/error.hpp"
#include "scene_text.hpp"

namespace pileus::scene {
namespace {

namespace fs = std::filesystem;
const fs::path scenes = fs::path(PILEUS_SOURCE_DIR) / "configs" / "scenes";

std::vector<std::string> shipped_scenes() {
  std::vector<std::string> paths;
  for (const auto& entry : fs::recursive_directory_iterator(scenes))
    if (entry.path().extension() == ".yaml") paths.push_back(entry.path().string());
  std::sort(paths.begin(), paths.end());
  return paths;
}

TEST(ReadScene, ConvertsUnitsAndFillsDefaults) {
  const Scene scene = scene_of(cube + "background: {coriolis: 1e-4 s-1}\n");
  EXPECT_EQ(scene.name, "scene");
  EXPECT_EQ(scene.domain.dimension, 3);
  EXPECT_EQ(scene.domain.extent, (std::vector<double>{1000, 1000, 1000}));
  EXPECT_EQ(scene.domain.lower, (std::vector<double>{0, 0, 0}));
  EXPECT_EQ(scene.time.end, 600);
  EXPECT_EQ(scene.background.coriolis, (std::vector<double>{0, 0, 1e-4}));
  EXPECT_EQ(scene.parcels.per_cell, 8);
  EXPECT_EQ(scene.parcels.min_volume_ratio, 20);
  EXPECT_EQ(scene.output.directory, "results/scene");
  EXPECT_EQ(scene.output.fields.every, 30);    // a twentieth
  EXPECT_EQ(scene.output.series.every, 3);     // a two-hundredth
  EXPECT_EQ(scene.output.parcels.every, 300);  // half
}

TEST(ReadScene, TwoDimensionsChangeTheDefaults) {
  const Scene scene = scene_of("domain: {extent: [2 km, 1 km], cells: [16, 8]}\ntime: {end: 1}\n");
  EXPECT_EQ(scene.domain.dimension, 2);
  EXPECT_EQ(scene.parcels.per_cell, 9);
  EXPECT_EQ(scene.parcels.min_volume_ratio, 40);
  EXPECT_EQ(scene.initial.mean_wind.size(), 1u);
}

TEST(ReadScene, NumbersMayBeFormulasOfConstants) {
  const Scene scene = scene_of(
      "constants: {H: 2 km, a: H/4 + 1}\n"
      "domain: {extent: [4*pi m, H, 0.5*H], cells: [8, 8, 8]}\ntime: {end: 4*pi/sqrt(2) s}\n");
  EXPECT_EQ(scene.constants.at("a"), 501);
  EXPECT_EQ(scene.domain.extent[0], 4 * M_PI);
  EXPECT_EQ(scene.domain.extent[1], 2000);
  EXPECT_EQ(scene.domain.extent[2], 1000);
  EXPECT_EQ(scene.time.end, 4 * M_PI / std::sqrt(2.0));
}

TEST(ReadScene, LatitudeGivesThePlanetaryVorticity) {
  const Scene scene = scene_of(cube +
                               "background: {latitude: 30 degrees, rotation_rate: 1e-4 rad/s, "
                               "horizontal_coriolis: true}\n");
  EXPECT_DOUBLE_EQ(scene.background.coriolis[1], 2e-4 * std::cos(M_PI / 6));
  EXPECT_DOUBLE_EQ(scene.background.coriolis[2], 1e-4);
}

TEST(ReadScene, FieldsTakeEveryForm) {
  const Scene scene = scene_of(
      cube +
      "initial:\n"
      "  total_water_mass_fraction: {height: [0, 1 km], value: [17, 0.01 kg/kg], units: g/kg}\n"
      "  buoyancy: 1e-4*z\n"
      "  passive_tracer: 3\n"
      "  air_potential_temperature: {constant: 20 degC, noise: {amplitude: 0.1 K, seed: 4}}\n");
  const auto& fields = scene.initial.scalars;
  const FieldDescription& water = fields.at("total_water_mass_fraction");
  EXPECT_EQ(water.form, FieldDescription::Form::profile);
  EXPECT_EQ(water.profile.height, (std::vector<double>{0, 1000}));
  EXPECT_DOUBLE_EQ(water.profile.value[0], 0.017);
  EXPECT_DOUBLE_EQ(water.profile.value[1], 0.01);
  EXPECT_EQ(fields.at("buoyancy").form, FieldDescription::Form::formula);
  EXPECT_EQ(fields.at("passive_tracer").constant, 3);
  EXPECT_DOUBLE_EQ(fields.at("air_potential_temperature").constant, 293.15);
  EXPECT_EQ(fields.at("air_potential_temperature").noise->amplitude, 0.1);
}

TEST(ReadScene, OverridesGoThroughTheSameChecks) {
  const std::string text = cube + "operators: [{use: org.example.mixing, beta: 2}]\n";
  const Scene scene =
      scene_of(text, {"time.end=300 s", "domain.cells=[16,16,16]", "operators.mixing.beta=1",
                      "parcels.per_cell=27", "time.step.alpha=0.1"});
  EXPECT_EQ(scene.time.end, 300);
  EXPECT_EQ(scene.domain.cells, (std::vector<int>{16, 16, 16}));
  EXPECT_EQ(scene.operators[0].parameters[0].second.text, "1");
  EXPECT_EQ(scene.parcels.per_cell, 27);
  EXPECT_EQ(scene.time.alpha, 0.1);
  EXPECT_EQ(problems_of(cube, {"time.ned=3"}),
            "command line: --set time.ned=3: error: unknown key 'ned' in 'time'; did you mean "
            "'end'?");
  EXPECT_EQ(problems_of(cube, {"time.end=3 kg"}),
            "command line: --set time.end=3 kg: error: 'end': in '3 kg' 'kg' does not measure a "
            "time; expected a value such as '10 min'");
  EXPECT_NE(problems_of(text, {"operators.mixng.beta=1"}).find("there is 'mixing'"),
            std::string::npos);
  EXPECT_NE(problems_of(cube, {"nonsense"}).find("expected key=value"), std::string::npos);
}

TEST(ReadScene, ResolvedScenesReadBackAsThemselves) {
  for (const std::string& path : shipped_scenes()) {
    const Scene scene = read_scene(path);
    const Scene again = scene_of(scene.resolved_yaml);
    EXPECT_EQ(again.resolved_yaml, scene.resolved_yaml) << path;
    EXPECT_EQ(again.constants, scene.constants) << path;
    EXPECT_EQ(again.domain.extent, scene.domain.extent) << path;
    EXPECT_EQ(again.expect.size(), scene.expect.size()) << path;
  }
}

TEST(ReadScene, OperatorsOfAVariantAreLaidOverByNameAddedOrLeftOut) {
  const fs::path folder = fs::path(testing::TempDir()) / "operators";
  fs::create_directories(folder);
  std::ofstream(folder / "base.yaml") << cube
                                      << "operators: [{use: org.a.clouds}, {use: org.a.rain, "
                                         "name: fall}, {use: org.a.mixing, beta: 1}]\n";
  std::ofstream(folder / "child.yaml")
      << "extends: base.yaml\noperators: [{name: mixing, beta: 5}, {name: fall, use: none}, "
         "{use: org.a.forcing}]\n";
  std::ofstream(folder / "wrong.yaml")
      << "extends: base.yaml\noperators: [{name: rian, use: none}]\n";
  Problems problems;
  const Scene scene = read_scene((folder / "child.yaml").string(), {}, problems);
  EXPECT_TRUE(problems.empty()) << problems.render();
  std::vector<std::string> uses;
  for (const OperatorBlock& block : scene.operators) uses.push_back(block.use);
  EXPECT_EQ(uses, (std::vector<std::string>{"org.a.clouds", "org.a.mixing", "org.a.forcing"}));
  EXPECT_EQ(scene.operators[1].parameters.at(0).second.text, "5");
  // What is not there cannot be left out: the name stays, and no library answers to it.
  const Scene wrong = read_scene((folder / "wrong.yaml").string(), {}, problems);
  ASSERT_EQ(wrong.operators.size(), 4u);
  EXPECT_EQ(wrong.operators[3].use, "none");
}

TEST(ReadScene, InheritsByKeysAndBlamesTheRightFile) {
  const fs::path folder = fs::path(testing::TempDir()) / "extends";
  fs::create_directories(folder);
  std::ofstream(folder / "base.yaml")
      << cube
      << "initial: {buoyancy: {height: [0, 1], value: [0, 1]}}\n"
         "operators: [{use: org.a.mixing, beta: 1, gamma: 2}, {use: org.a.rain}]\n"
         "parcels: {per_cel: 8}\n";
  std::ofstream(folder / "child.yaml")
      << "extends: base.yaml\ntime: {end: 1 kg}\ndomain: {cells: [4, 4, 4]}\n"
         "initial: {buoyancy: 1e-4*z}\noperators: [{name: mixing, beta: 5}]\n";
  Problems problems;
  const Scene scene = read_scene((folder / "child.yaml").string(), {}, problems);
  EXPECT_EQ(scene.domain.cells, (std::vector<int>{4, 4, 4}));
  EXPECT_EQ(scene.domain.extent[0], 1000);
  EXPECT_EQ(scene.initial.scalars.at("buoyancy").form, FieldDescription::Form::formula);
  ASSERT_EQ(scene.operators.size(), 2u);
  EXPECT_EQ(scene.operators[0].use, "org.a.mixing");
  EXPECT_EQ(scene.operators[0].parameters[0].second.text, "5");
  EXPECT_EQ(scene.operators[0].parameters[1].second.text, "2");
  ASSERT_EQ(problems.size(), 2u) << problems.render();
  const std::string text = problems.render();
  EXPECT_NE(text.find("base.yaml:5:11: error: unknown key 'per_cel'"), std::string::npos) << text;
  EXPECT_NE(text.find("child.yaml:2:13: error: 'end'"), std::string::npos) << text;
}

// Bounds replace those of the scene that is extended, unless those are asked for.
TEST(ReadScene, ExpectationsAreInheritedOnRequest) {
  const fs::path folder = fs::path(testing::TempDir()) / "inherited";
  fs::create_directories(folder);
  std::ofstream(folder / "base.yaml")
      << cube << "expect: [{diagnostic: volume, at_least: 1}, {diagnostic: parcels, at_most: 9}]\n";
  std::ofstream(folder / "middle.yaml")
      << "extends: base.yaml\nexpect: [{diagnostic: max_speed, at_most: 1}, inherited]\n";
  std::ofstream(folder / "child.yaml")
      << "extends: middle.yaml\nexpect:\n  - inherited\n  - {diagnostic: enstrophy, at_most: 2}\n";
  std::ofstream(folder / "other.yaml")
      << "extends: middle.yaml\nexpect: [{diagnostic: enstrophy, at_most: 2}]\n";
  const auto diagnostics = [&](const char* file) {
    std::vector<std::string> names;
    for (const Expectation& e : read_scene((folder / file).string()).expect)
      names.push_back(e.diagnostic);
    return names;
  };
  EXPECT_EQ(diagnostics("child.yaml"),
            (std::vector<std::string>{"max_speed", "volume", "parcels", "enstrophy"}));
  EXPECT_EQ(diagnostics("other.yaml"), std::vector<std::string>{"enstrophy"});
}

TEST(ReadScene, MissingFilesAndFoldersAreExplained) {
  const auto failure = [](const std::string& path) -> std::pair<int, std::string> {
    try {
      read_scene(path);
    } catch (const Error& error) {
      return {static_cast<int>(error.code()), error.what()};
    }
    return {0, ""};
  };
  const auto [code, text] = failure((scenes / "beltrami" / "beltrmi.yaml").string());
  EXPECT_EQ(code, 2);
  EXPECT_NE(text.find("Did you mean"), std::string::npos) << text;
  EXPECT_NE(text.find("beltrami.yaml"), std::string::npos) << text;
  const auto [folder_code, folder_text] = failure((scenes / "beltrami").string());
  EXPECT_EQ(folder_code, 2);
  EXPECT_NE(folder_text.find("is a folder"), std::string::npos) << folder_text;
  EXPECT_EQ(failure("/no/such/folder/scene.yaml").first, 2);
}

// Derived figures of the moist thermal as published with its set-up, to the digits given there.
TEST(MoistThermal, ConstantsAreThePublishedOnes) {
  const Scene scene = read_scene((scenes / "moist_thermal" / "moist_thermal.yaml").string());
  EXPECT_NEAR(scene.constants.at("q_th"), 1.231275e-3, 0.5e-9);
  EXPECT_NEAR(scene.constants.at("q_env"), 1.108147e-3, 0.5e-9);
  EXPECT_NEAR(scene.constants.at("z_b"), 2382.216964, 0.5e-6);
  EXPECT_NEAR(scene.constants.at("N2"), 9.418381e-5, 0.5e-11);
  EXPECT_NEAR(scene.constants.at("b_0"), 0.152369, 0.5e-6);
}

}  // namespace
}  // namespace pileus::scene
