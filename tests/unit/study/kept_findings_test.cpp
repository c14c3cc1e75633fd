// The findings that come with Pileus say where they come from, and are of the scenes as they are.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "study/study_files.hpp"
#include "study/target_error.hpp"

namespace pileus::study {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const fs::path studies = fs::path(PILEUS_SOURCE_DIR) / "configs/studies";

std::vector<fs::path> kept() {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(studies / "results"))
    if (entry.path().extension() == ".json") paths.push_back(entry.path());
  return paths;
}

Json read(const fs::path& path) {
  std::ifstream file(path);
  return Json::parse(file);
}

std::string scene_of(const Json& findings) {
  return (studies / "results" / findings.at("scene").get<std::string>()).lexically_normal();
}

TEST(KeptFindings, SayWhereTheyComeFrom) {
  ASSERT_FALSE(kept().empty());
  for (const fs::path& path : kept()) {
    SCOPED_TRACE(path.filename().string());
    const Json findings = read(path);
    EXPECT_TRUE(fs::exists(studies / (findings.at("study").get<std::string>() + ".yaml")));
    EXPECT_FALSE(findings.at("machine").get<std::string>().empty());
    for (const Json& point : findings.at("points"))
      EXPECT_EQ(point.at("commit").get<std::string>().size(), 40U);
  }
}

/// One who changes what a scene simulates runs its studies again, with --keep.
TEST(KeptFindings, AreOfTheScenesAsTheyAre) {
  for (const fs::path& path : kept()) {
    SCOPED_TRACE(path.filename().string());
    const Json findings = read(path);
    if (!findings.contains("scene")) continue;
    for (const Json& point : findings.at("points"))
      EXPECT_EQ(point.at("scene_sha256").get<std::string>(),
                scene_fingerprint(scene_of(findings),
                                  point.at("settings").get<std::vector<std::string>>()))
          << point.at("label");
  }
}

/// The wave of the user's guide: 5 per cent is met, and the reason given.
TEST(KeptFindings, ChooseASettingOfTheWave) {
  TargetRequest request;
  request.scene_path =
      fs::path(PILEUS_SOURCE_DIR) / "configs/scenes/internal_wave/internal_wave.yaml";
  request.target = "5%";
  request.norm = "vorticity";
  const Choice choice = choose_setting(request);
  EXPECT_FALSE(choice.overrides.empty());
  EXPECT_NE(choice.explanation.find("configs/studies/results/"), std::string::npos)
      << choice.explanation;
}

}  // namespace
}  // namespace pileus::study
