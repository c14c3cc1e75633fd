// Access to the libraries that break one rule each.
#pragma once
#include <filesystem>
#include <string>

#include "base/error.hpp"
#include "host/library.hpp"

namespace pileus::test {

inline std::filesystem::path hostile_path(const std::string& variant) {
  return std::filesystem::path(PILEUS_HOSTILE_FOLDER) / ("lib" + variant + ".so");
}

/// The message with which loading is refused; empty if it is not.
inline std::string refusal_of(const std::filesystem::path& path) {
  try {
    host::load_library(path);
  } catch (const Error& error) {
    return error.code() == ExitCode::plugin ? error.what() : "wrong exit code";
  }
  return {};
}

}  // namespace pileus::test
