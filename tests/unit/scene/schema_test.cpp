// The printed schema: current in the repository, and of one mind with the reader.
#include "scene/schema.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "scene_text.hpp"

namespace pileus::scene {
namespace {

namespace fs = std::filesystem;
const fs::path root = PILEUS_SOURCE_DIR;

/// Runs the JSON Schema validator over scenes: 0 when every one is judged as expected.
int validate(const std::string& schema, const std::string& expectation,
             const std::vector<fs::path>& paths) {
  // Tests run side by side, each in a process of its own.
  const std::string test = testing::UnitTest::GetInstance()->current_test_info()->name();
  const fs::path file = fs::path(testing::TempDir()) / (test + ".schema.json");
  std::ofstream(file) << schema;
  std::string command = "/usr/bin/python3 '" + (root / "tests/schema/validate.py").string() + "' " +
                        expectation + " '" + file.string() + "'";
  for (const fs::path& path : paths) command += " '" + path.string() + "'";
  return std::system(command.c_str());
}

std::vector<fs::path> scenes_below(const fs::path& folder) {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.path().extension() == ".yaml") paths.push_back(entry.path());
  return paths;
}

TEST(Schema, InTheRepositoryIsTheOnePrinted) {
  std::ifstream stream(root / "schemas" / "scene.schema.json");
  const nlohmann::json kept = nlohmann::json::parse(stream);
  nlohmann::json printed = nlohmann::json::parse(scene_schema());
  // The kept schema also has one branch for each plugin of the repository.
  nlohmann::json without_operators = kept;
  without_operators["definitions"].erase("operator");
  printed["definitions"].erase("operator");
  EXPECT_EQ(without_operators, printed);
}

TEST(Schema, AcceptsEveryValidScene) {
  EXPECT_EQ(validate(scene_schema(), "valid", scenes_below(root / "tests/schema/valid")), 0);
  EXPECT_EQ(validate(scene_schema(), "valid", scenes_below(root / "configs/scenes")), 0);
}

TEST(Schema, RefusesEveryStructuralMistake) {
  EXPECT_EQ(
      validate(scene_schema(), "invalid", scenes_below(root / "tests/schema/invalid/structure")),
      0);
}

TEST(Schema, AcceptsResolvedScenes) {
  std::vector<fs::path> paths;
  for (const fs::path& path : scenes_below(root / "configs/scenes")) {
    paths.push_back(fs::path(testing::TempDir()) / ("resolved_" + path.filename().string()));
    std::ofstream(paths.back()) << read_scene(path.string()).resolved_yaml;
  }
  EXPECT_EQ(validate(scene_schema(), "valid", paths), 0);
}

TEST(Schema, KnowsTheParametersOfOperators) {
  const std::vector<OperatorSchema> operators = {
      {"org.example.relax",
       "Relaxes.",
       {{.name = "time_scale",
         .units = "s",
         .doc = "E-folding time.",
         .fallback = 3600,
         .low = 1,
         .high = 1e6},
        {.name = "mode", .type = ParameterType::choice, .choices = {"fast", "exact"}}}}};
  const fs::path folder = fs::path(testing::TempDir()) / "operator_schema";
  fs::create_directories(folder);
  const auto scene = [&](const std::string& name, const std::string& block) {
    std::ofstream(folder / name) << cube << "operators:\n  - {" << block << "}\n";
    return folder / name;
  };
  const std::string schema = scene_schema(operators);
  EXPECT_EQ(validate(schema, "valid",
                     {scene("a.yaml", "use: org.example.relax, time_scale: 1 h, mode: exact"),
                      scene("b.yaml", "use: org.other.thing, anything: 3")}),
            0);
  EXPECT_EQ(validate(schema, "invalid",
                     {scene("c.yaml", "use: org.example.relax, time_scal: 1 h"),
                      scene("d.yaml", "use: org.example.relax, time_scale: 0.5"),
                      scene("e.yaml", "use: org.example.relax, mode: slow")}),
            0);
}

}  // namespace
}  // namespace pileus::scene
