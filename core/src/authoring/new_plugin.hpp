// Writes the project of a new plugin: what an author begins with.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace pileus::authoring {

struct NewPlugin {
  std::string name;              // snake_case; also the name of the library
  std::string kind;              // one of plugin_kinds()
  std::filesystem::path folder;  // to be made; empty: `name` in the current folder
};

/// The kinds there are templates for, in alphabetical order.
std::vector<std::string> plugin_kinds();

/// Makes the folder with a project that builds against the installed package alone: core/templates
/// with the name in place of my_scheme. Returns the paths of its files.
///
/// Errors  Error(usage): a name that is none, an unknown kind, a folder that exists; Error(file):
/// it
///         cannot be written, of which nothing is left
std::vector<std::filesystem::path> write_project(const NewPlugin& request);

}  // namespace pileus::authoring
