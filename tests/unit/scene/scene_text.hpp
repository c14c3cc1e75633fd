// Scenes from text, for tests.
#pragma once
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "scene/read_scene.hpp"

namespace pileus::scene {

inline const std::string cube = "domain: {extent: 1 km, cells: [8, 8, 8]}\ntime: {end: 10 min}\n";

/// The scene of a text that has no problems.
inline Scene scene_of(const std::string& text, const std::vector<std::string>& overrides = {}) {
  Problems problems;
  Scene scene = read_scene_text("scene.yaml", text, overrides, problems);
  EXPECT_TRUE(problems.empty()) << problems.render();
  return scene;
}

/// The messages of a text that has problems.
inline std::string problems_of(const std::string& text,
                               const std::vector<std::string>& overrides = {}) {
  Problems problems;
  read_scene_text("scene.yaml", text, overrides, problems);
  return problems.render();
}

}  // namespace pileus::scene
