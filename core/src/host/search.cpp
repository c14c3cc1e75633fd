#include "host/search.hpp"

#include <algorithm>
#include <cstdlib>

#include "base/error.hpp"
#include "base/nearest_word.hpp"
#include "host/library.hpp"

namespace pileus::host {
namespace fs = std::filesystem;
namespace {

bool names_a_file(const std::string& use) {
  return use.find('/') != std::string::npos || use.ends_with(".so");
}

bool module_holds(const std::string& module, const std::string& id) {
  return id == module || id.starts_with(module + ".");
}

std::vector<fs::path> libraries_in(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry->path().extension() == ".so") files.push_back(entry->path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

Candidate judge(const fs::path& path) {
  Candidate candidate{path, {}, {}, {}};
  try {
    const LibraryNote note = inspect_library(path);
    candidate.module = note.module;
    candidate.version = note.version;
  } catch (const Error& refusal) {
    candidate.refusal = refusal.what();
  }
  return candidate;
}

[[noreturn]] void report_missing(const std::string& id, const SearchPath& search,
                                 const std::vector<std::string>& modules,
                                 const std::vector<std::string>& refusals) {
  std::string text = "no plugin with the id '" + id + "' was found";
  const std::string nearest = nearest_word(id, modules);
  if (!nearest.empty()) text += "; did you mean '" + nearest + "'?";
  text += "\nsearched:";
  for (const fs::path& folder : search.folders) text += "\n  " + folder.string();
  for (const std::string& refusal : refusals) text += "\n" + refusal;
  text += "\nset PILEUS_PLUGIN_PATH to the folder that holds it, or name the library by its path";
  throw Error(ExitCode::plugin, text);
}

}  // namespace

SearchPath default_search_path(const fs::path& scene_folder) {
  SearchPath search;
  search.folders.push_back(scene_folder.empty() ? fs::path(".") : scene_folder);
  if (const char* variable = std::getenv("PILEUS_PLUGIN_PATH")) {
    std::string_view rest = variable;
    while (!rest.empty()) {
      const std::size_t end = std::min(rest.find(':'), rest.size());
      if (end > 0) search.folders.emplace_back(rest.substr(0, end));
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
  }
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (!error) {
    const fs::path prefix = program.parent_path().parent_path();
    for (const char* library_folder :
         {"lib", "lib64", "lib/x86_64-linux-gnu", "lib/aarch64-linux-gnu"}) {
      const fs::path folder = prefix / library_folder / "pileus" / "plugins";
      if (fs::is_directory(folder, error)) search.folders.push_back(folder);
    }
  }
  return search;
}

std::vector<Candidate> list_candidates(const SearchPath& search) {
  std::vector<Candidate> all;
  for (const fs::path& folder : search.folders) {
    for (const fs::path& path : libraries_in(folder)) all.push_back(judge(path));
  }
  return all;
}

fs::path find_library(const std::string& use, const SearchPath& search) {
  if (names_a_file(use)) {
    fs::path path = use;
    if (path.is_relative() && !search.folders.empty()) path = search.folders.front() / path;
    std::error_code error;
    if (!fs::exists(path, error)) {
      throw Error(ExitCode::plugin, "the plugin library '" + path.string() + "' does not exist");
    }
    return path;
  }
  std::vector<std::string> modules, refusals;
  for (const fs::path& folder : search.folders) {
    std::vector<fs::path> matches;
    for (const fs::path& path : libraries_in(folder)) {
      const Candidate candidate = judge(path);
      if (!candidate.refusal.empty()) {
        refusals.push_back(candidate.refusal);
      } else {
        modules.push_back(candidate.module);
        if (module_holds(candidate.module, use)) matches.push_back(path);
      }
    }
    if (matches.size() > 1) {
      throw Error(ExitCode::plugin, "two libraries provide '" + use + "': '" + matches[0].string() +
                                        "' and '" + matches[1].string() +
                                        "'; name one of them by its path");
    }
    if (matches.size() == 1) return matches.front();
  }
  report_missing(use, search, modules, refusals);
}

}  // namespace pileus::host
