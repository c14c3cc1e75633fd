#include "authoring/new_plugin.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <string_view>

#include "authoring/embedded_texts.hpp"
#include "base/error.hpp"
#include "base/nearest_word.hpp"
#include "base/version.hpp"

namespace pileus::authoring {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view common = "common";
/// The note of a library has room for 63 bytes of "org.example.<name>".
constexpr std::size_t longest_name = 40;
/// Targets that CMake has in every project, and the template's own.
constexpr std::array<std::string_view, 12> taken_targets = {
    "all",           "clean",
    "edit_cache",    "help",
    "install",       "list_install_components",
    "preinstall",    "test",
    "package",       "package_source",
    "rebuild_cache", "rates_test"};

bool is_snake_case(std::string_view name) {
  const auto good = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  };
  return !name.empty() && name.front() >= 'a' && name.front() <= 'z' && name.back() != '_' &&
         name.find("__") == std::string_view::npos && std::all_of(name.begin(), name.end(), good);
}

void check_name(const std::string& name) {
  if (!is_snake_case(name)) {
    throw Error(ExitCode::usage,
                fmt::format("'{}' is no name for a plugin; names consist of lower-case letters, "
                            "digits and single underscores and begin with a letter, as 'warm_rain'",
                            name));
  }
  if (name.size() > longest_name) {
    throw Error(ExitCode::usage, fmt::format("the name '{}' has {} characters; {} fit", name,
                                             name.size(), longest_name));
  }
  if (std::find(taken_targets.begin(), taken_targets.end(), name) != taken_targets.end()) {
    throw Error(
        ExitCode::usage,
        fmt::format("'{}' is the name of a target of CMake or of the project; choose another",
                    name));
  }
}

void check_kind(const std::string& kind) {
  const std::vector<std::string> kinds = plugin_kinds();
  if (std::find(kinds.begin(), kinds.end(), kind) != kinds.end()) return;
  const std::string nearest = nearest_word(kind, kinds);
  throw Error(ExitCode::usage,
              fmt::format("there is no template for the kind '{}'{}; there are {}", kind,
                          nearest.empty() ? "" : "; did you mean '" + nearest + "'?",
                          fmt::join(kinds, ", ")));
}

/// "WarmRain" of "warm_rain".
std::string class_name(std::string_view name) {
  std::string result;
  bool begins_word = true;
  for (const char c : name) {
    if (c != '_') result += begins_word ? static_cast<char>(std::toupper(c)) : c;
    begins_word = c == '_';
  }
  return result;
}

/// "Warm rain" of "warm_rain".
std::string title(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  name.front() = static_cast<char>(std::toupper(name.front()));
  return name;
}

void replace_all(std::string& text, std::string_view what, std::string_view by) {
  for (std::size_t at = text.find(what); at != std::string::npos;
       at = text.find(what, at + by.size())) {
    text.replace(at, what.size(), by);
  }
}

/// A template with the plugin's own name. Templates are whole files of a plugin "my_scheme".
std::string filled_in(std::string_view text, const std::string& name) {
  std::string result(text);
  const std::string_view version = build_record().version;
  replace_all(result, "PILEUS_VERSION", version.substr(0, version.rfind('.')));
  replace_all(result, "MyScheme", class_name(name));
  replace_all(result, "My scheme", title(name));
  replace_all(result, "my_scheme", name);
  return result;
}

std::vector<fs::path> write_files(const NewPlugin& request, const fs::path& folder) {
  std::vector<fs::path> written;
  for (const TemplateFile& file : template_files()) {
    if (file.kind != common && file.kind != request.kind) continue;
    const fs::path path = folder / file.name;
    std::ofstream stream(path, std::ios::binary);
    stream << filled_in(file.text, request.name);
    if (!stream.flush()) {
      throw Error(ExitCode::file, fmt::format("{}: cannot be written", path.string()));
    }
    written.push_back(path);
  }
  std::sort(written.begin(), written.end());
  return written;
}

}  // namespace

std::vector<std::string> plugin_kinds() {
  std::vector<std::string> kinds;
  for (const TemplateFile& file : template_files()) {
    if (file.kind != common) kinds.emplace_back(file.kind);
  }
  std::sort(kinds.begin(), kinds.end());
  kinds.erase(std::unique(kinds.begin(), kinds.end()), kinds.end());
  return kinds;
}

std::vector<fs::path> write_project(const NewPlugin& request) {
  check_name(request.name);
  check_kind(request.kind);
  const fs::path folder = request.folder.empty() ? fs::path(request.name) : request.folder;
  std::error_code error;
  if (fs::symlink_status(folder, error).type() != fs::file_type::not_found) {
    throw Error(ExitCode::usage, fmt::format("'{}' exists already; nothing was written. Name "
                                             "another folder with --out",
                                             folder.string()));
  }
  if (!fs::create_directories(folder, error) && error) {
    throw Error(ExitCode::file, fmt::format("the folder '{}' cannot be made: {}", folder.string(),
                                            error.message()));
  }
  try {
    return write_files(request, folder);
  } catch (const Error&) {
    fs::remove_all(folder, error);
    throw;
  }
}

}  // namespace pileus::authoring
