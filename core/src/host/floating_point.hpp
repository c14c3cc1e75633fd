// The floating-point environment belongs to the program: plugins find it as it was and leave it so.
#pragma once
#include <cfenv>
#include <cstdint>

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace pileus::host {

/// Rounding, flush-to-zero, denormals-are-zero and trap settings of this thread, without the
/// sticky exception flags, as one number.
inline std::uint32_t arithmetic_mode() {
#if defined(__SSE2__)
  return _mm_getcsr() & ~std::uint32_t{0x3F};
#else
  return static_cast<std::uint32_t>(std::fegetround());
#endif
}

/// What is said of code that leaves another mode behind.
inline constexpr const char* changed_arithmetic =
    "it changed the floating-point mode (rounding, denormals or traps)";

/// Restores the whole environment at the end of its scope.
class FloatingPointGuard {
 public:
  FloatingPointGuard() { std::fegetenv(&saved_); }
  ~FloatingPointGuard() { std::fesetenv(&saved_); }
  FloatingPointGuard(const FloatingPointGuard&) = delete;
  FloatingPointGuard& operator=(const FloatingPointGuard&) = delete;

 private:
  std::fenv_t saved_;
};

}  // namespace pileus::host
