// Studies and scenes for tests, written to a folder of the test's own.
#pragma once
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "study/points.hpp"

namespace pileus::study {

inline const std::string cube_scene = R"(
domain: {extent: 1 m, cells: [4, 4, 4]}
time: {end: 10 s, step: {alpha: 0.2}}
)";

class StudyTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        std::filesystem::path(testing::TempDir()) /
        (std::string("study_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    write("cube.yaml", cube_scene);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& text) const {
    const std::filesystem::path path = folder_ / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << text;
    return path.string();
  }

  /// What is wrong with a study, with paths relative to the folder.
  std::string problems_of(const std::string& text) const {
    scene::Problems problems;
    const Study study = read_study(write("study.yaml", text), problems);
    if (problems.empty()) lay_out(study, problems);
    std::string rendered = problems.render();
    const std::string prefix = folder_.string() + "/";
    for (std::size_t at = rendered.find(prefix); at != std::string::npos;
         at = rendered.find(prefix))
      rendered.erase(at, prefix.size());
    return rendered;
  }

  std::filesystem::path folder_;
};

}  // namespace pileus::study
