// What this program is made of, for --version and for every file it writes.
#pragma once
#include <span>
#include <string_view>

namespace pileus {

struct LibraryVersion {
  std::string_view name, version;
};

struct BuildRecord {
  std::string_view version;  // of Pileus, e.g. "0.1.0"
  std::string_view commit;   // full hash, "-modified" appended when the tree differed; or "unknown"
  std::string_view compiler;                  // name and version
  std::string_view build_type;                // Release, Debug, …
  std::string_view sanitizer;                 // empty, address, undefined or thread
  std::span<const LibraryVersion> libraries;  // found when the build was configured
};

/// The record of this build; the commit is that of the last compilation.
const BuildRecord& build_record();

}  // namespace pileus
