// Finding the library that a scene names by operator id or by path. No folder is loaded wholesale.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace pileus::host {

/// Folders in which ids are looked up, first match wins; the first is also what relative paths
/// are relative to.
struct SearchPath {
  std::vector<std::filesystem::path> folders;
};

/// The folder of the scene, those of PILEUS_PLUGIN_PATH (colon-separated), then the plugins that
/// belong to this executable: lib*/pileus/plugins beside the folder it lies in.
SearchPath default_search_path(const std::filesystem::path& scene_folder);

/// A library found in a folder, or why it is none.
struct Candidate {
  std::filesystem::path path;
  std::string module;  // empty when refused
  std::string version;
  std::string refusal;  // empty when acceptable
};

/// Every .so file of the search path by folder and name, judged by its note; none of it is loaded.
std::vector<Candidate> list_candidates(const SearchPath& search);

/// The library for `use`: a path if it contains a slash or ends in .so, else an operator id, which
/// begins with the module's name in the note.
///
/// Errors  Error(ExitCode::plugin): no such file; no library with this id (naming the nearest id
///         and the folders searched); two in one folder; refused
std::filesystem::path find_library(const std::string& use, const SearchPath& search);

}  // namespace pileus::host
