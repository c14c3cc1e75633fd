// What a shared library says about itself, read from its file while none of its code runs.
#pragma once
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "pileus/abi.h"

namespace pileus::host {

/// Facts found in the section and dynamic symbol tables of an ELF file.
struct ElfFacts {
  bool has_note = false;
  pileus_note note{};                  // the texts inside are zero-terminated
  std::vector<std::string> exports;    // defined symbols other objects can bind to
  std::vector<std::string> undefined;  // symbols it needs from elsewhere; weak ones left out
  std::vector<std::string> needed;     // libraries it asks the loader for
  bool has_text_relocations = false;   // the loader has to write into its code
};

/// Parses a little-endian 64-bit ELF shared object of this machine's architecture. Every offset is
/// checked against the size before it is followed, so any bytes may be given.
///
/// Errors  std::invalid_argument with the reason ("is not an ELF file", "is cut short: …")
ElfFacts parse_elf(std::span<const std::byte> file);

/// Reads a file and parses it. Errors: as parse_elf, or "cannot be read: …".
ElfFacts read_elf(const std::filesystem::path& path);

}  // namespace pileus::host
