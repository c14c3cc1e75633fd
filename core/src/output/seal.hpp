// A checksum of a whole file, at its end.
//
// HDF5 does not survive every damaged file, so a file a run is continued from is checked byte by
// byte before HDF5 sees it. The seal stands behind the end that HDF5 knows of; readers ignore it.
#pragma once
#include <filesystem>

#include "output/staged_file.hpp"

namespace pileus::output {

/// Adds the SHA-256 of everything in the file, as its last change before the commit.
void add_seal(StagedFile& file);

/// Throws Error(ExitCode::file) unless the file carries the seal of its content.
void require_seal(const std::filesystem::path& path);

}  // namespace pileus::output
