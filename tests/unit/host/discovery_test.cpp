// Finding libraries by id and path, and printing what they declare.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/error.hpp"
#include "host/describe.hpp"
#include "host/search.hpp"

namespace pileus::host {
namespace {

const SearchPath built = {{PILEUS_BINARY_DIR "/lib/pileus/plugins"}};
constexpr const char* id = "org.pileus.saturation_adjustment";

std::string complaint_about(const std::string& use) {
  try {
    find_library(use, built);
  } catch (const Error& error) {
    return error.code() == ExitCode::plugin ? error.what() : "wrong exit code";
  }
  return {};
}

TEST(Search, finds_a_library_by_id_and_by_path_relative_to_the_first_folder) {
  const auto path = find_library(id, built);
  EXPECT_EQ(path.filename(), "libsaturation_adjustment.so");
  EXPECT_EQ(find_library("libsaturation_adjustment.so", built), path);
  EXPECT_EQ(find_library(path.string(), built), path);
}

TEST(Search, names_the_nearest_id_and_the_folders) {
  const std::string text = complaint_about("org.pileus.saturation_adjustmnt");
  EXPECT_NE(text.find("did you mean 'org.pileus.saturation_adjustment'?"), std::string::npos);
  EXPECT_NE(text.find(built.folders.front().string()), std::string::npos);
  EXPECT_NE(complaint_about("./nothing.so").find("does not exist"), std::string::npos);
}

TEST(Search, takes_folders_from_the_environment_after_the_scenes_own) {
  ::setenv("PILEUS_PLUGIN_PATH", "/first::/second", 1);
  const SearchPath path = default_search_path("scene_folder");
  ::unsetenv("PILEUS_PLUGIN_PATH");
  ASSERT_GE(path.folders.size(), 3u);
  EXPECT_EQ(path.folders[0], "scene_folder");
  EXPECT_EQ(path.folders[1], "/first");
  EXPECT_EQ(path.folders[2], "/second");
}

TEST(Describe, prints_quantities_units_parameters_and_effects) {
  const Library library = load_library(find_library(id, built));
  const std::string text = describe_text(library);
  for (const char* part : {"total_water_mass_fraction", "budget water", "m s-2", "thermodynamics",
                           "ideal | real", "scale_height", "1000 m", "when thermodynamics == real",
                           "provides", "condensation", "Bolton 1980"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  }
}

TEST(Describe, json_holds_every_declaration) {
  const Library library = load_library(find_library(id, built));
  const auto json = nlohmann::json::parse(describe_json(library));
  const OperatorTable& table = library.operators.front();
  const auto& op = json.at("operators").at(0);
  EXPECT_EQ(op.at("id"), id);
  EXPECT_EQ(op.at("quantities").size(), table.quantities.size());
  EXPECT_EQ(op.at("parameters").size(), table.parameters.size());
  EXPECT_EQ(op.at("effects").size(), table.effects.size());
  EXPECT_EQ(op.at("parameters").at(0).at("choices"), (std::vector<std::string>{"ideal", "real"}));
}

TEST(Describe, lists_candidates) {
  const auto json = nlohmann::json::parse(describe_candidates_json(built));
  EXPECT_GE(json.size(), 2u);
  EXPECT_NE(describe_candidates(built).find(id), std::string::npos);
}

}  // namespace
}  // namespace pileus::host
