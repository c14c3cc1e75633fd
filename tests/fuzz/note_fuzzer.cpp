// Any bytes may be given as a plugin library: its note and symbols are read, or it is refused.
#include <cstdint>
#include <span>
#include <stdexcept>

#include "host/elf.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const auto facts = pileus::host::parse_elf({reinterpret_cast<const std::byte*>(data), size});
    // The texts of a note end within it, whatever its bytes are.
    if (facts.has_note && (facts.note.module[63] != '\0' || facts.note.version[31] != '\0'))
      __builtin_trap();
  } catch (const std::invalid_argument&) {
    // the reason why it is no plugin
  }
  return 0;
}
