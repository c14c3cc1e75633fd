// A failure bundle: what is needed to look at a breakdown afterwards.
#pragma once
#include <filesystem>

#include "output/named_data.hpp"

namespace pileus::output {

/// Writes the data to an HDF5 file (named_data.hpp), synced, replacing one of that name. What goes
/// in is up to the caller. Throws Error(ExitCode::file).
void write_failure_bundle(const std::filesystem::path& path, const NamedData& data);

/// Reads it back. Throws Error(ExitCode::file), also when the content was damaged.
NamedData read_failure_bundle(const std::filesystem::path& path);

}  // namespace pileus::output
