// Any text may be given as a scene: it is read, or refused with a problem or an Error.
#include <cstdint>
#include <string>

#include "base/error.hpp"
#include "scene/read_scene.hpp"

/// UDUNITS keeps the copy of a word when a unit it stands in cannot be parsed: two bytes once per
/// message to the user, and not ours to free.
extern "C" const char* __lsan_default_suppressions() {  // NOLINT: the sanitizer's name
  return "leak:utlex\n";
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t longest = 1 << 16;
  if (size > longest) return 0;
  const std::string text(reinterpret_cast<const char*>(data), size);
  pileus::scene::Problems problems;
  try {
    const auto scene = pileus::scene::read_scene_text("fuzz.yaml", text, {}, problems);
    // What was read is written out again, and that text is a scene too.
    if (!problems.empty()) {
      problems.render();
      return 0;
    }
    pileus::scene::Problems again;
    pileus::scene::read_scene_text("resolved.yaml", scene.resolved_yaml, {}, again);
    if (!again.empty()) __builtin_trap();
  } catch (const pileus::Error&) {
    // a sentence for the user, as it should be
  }
  return 0;
}
