// Loading a plugin library: the note first, then its code, then every row of its tables.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "host/operator_table.hpp"

namespace pileus::host {

/// Facts of the note of a library file.
struct LibraryNote {
  std::string module, version, toolchain;
  unsigned abi_major = 0, abi_minor_built = 0, abi_minor_needed = 0, build_flags = 0;
};

/// Reads and judges the note and the exported symbols of a library; none of its code runs.
///
/// Errors  Error(ExitCode::plugin) naming the file, the reason and the remedy: not a readable ELF
///         library, no note, wrong magic, another major version, a newer minor needed, built with
///         fast-math, built with a sanitizer this program lacks, entry symbol missing, other
///         symbols exported
LibraryNote inspect_library(const std::filesystem::path& path);

/// A loaded library. Its code stays in the process for good.
struct Library {
  std::filesystem::path path;
  LibraryNote note;
  std::vector<OperatorTable> operators;
};

/// Inspects, loads and checks a library. The floating-point environment is the same afterwards.
///
/// Errors  as inspect_library; the loader's own message; every complaint about its tables at once
Library load_library(const std::filesystem::path& path);

}  // namespace pileus::host
