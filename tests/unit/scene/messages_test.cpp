// Every invalid scene of tests/schema gets exactly the message kept beside it.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "scene/read_scene.hpp"

namespace pileus::scene {
namespace {

namespace fs = std::filesystem;
const fs::path corpus = fs::path(PILEUS_SOURCE_DIR) / "tests" / "schema";

std::string text_of(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

/// The message for a scene, with the folder's own path cut out.
std::string message_of(const fs::path& path) {
  std::string text = "accepted";
  try {
    read_scene(path.string());
  } catch (const Error& error) {
    text = error.what();
    EXPECT_EQ(error.code(), ExitCode::usage) << path;
  }
  const std::string folder = path.parent_path().string() + "/";
  for (std::size_t at = text.find(folder); at != std::string::npos; at = text.find(folder, at))
    text.erase(at, folder.size());
  return text + "\n";
}

std::vector<fs::path> scenes_in(const fs::path& folder) {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".yaml") paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  return paths;
}

TEST(Messages, OfStructuralMistakes) {
  const auto paths = scenes_in(corpus / "invalid" / "structure");
  EXPECT_GE(paths.size(), 25u);
  for (const fs::path& path : paths)
    EXPECT_EQ(message_of(path), text_of(fs::path(path).replace_extension(".expected"))) << path;
}

TEST(Messages, OfMistakesOfMeaning) {
  const auto paths = scenes_in(corpus / "invalid" / "meaning");
  EXPECT_GE(paths.size(), 45u);
  for (const fs::path& path : paths)
    EXPECT_EQ(message_of(path), text_of(fs::path(path).replace_extension(".expected"))) << path;
}

TEST(Messages, NoneForValidScenes) {
  for (const fs::path& path : scenes_in(corpus / "valid"))
    EXPECT_EQ(message_of(path), "accepted\n") << path;
}

}  // namespace
}  // namespace pileus::scene
