// Wall-clock time by phase of the step; two clock reads per phase, always on.
#pragma once
#include <array>
#include <chrono>
#include <cstdint>
#include <string_view>

namespace pileus {

enum class Phase : int {
  deposit,
  compensation,  // of the window of deposit and interpolation
  inversion,
  tendency,
  interpolate,
  stage_update,
  closure,
  operators,
  sort,
  merge,
  split,
  correction,
  diagnostics,
  output,
  count_
};

inline constexpr std::array<std::string_view, static_cast<int>(Phase::count_)> phase_names = {
    "deposit",   "compensation", "inversion", "tendency", "interpolate", "stage_update", "closure",
    "operators", "sort",         "merge",     "split",    "correction",  "diagnostics",  "output"};

/// Seconds and number of entries of every phase.
class PhaseTimes {
 public:
  struct Entry {
    double seconds = 0;
    std::uint64_t calls = 0;
  };
  Entry& operator[](Phase phase) { return entries_[static_cast<std::size_t>(phase)]; }
  const Entry& operator[](Phase phase) const { return entries_[static_cast<std::size_t>(phase)]; }
  void clear() { entries_ = {}; }
  /// In the order of `Phase`.
  auto begin() { return entries_.begin(); }
  auto end() { return entries_.end(); }

 private:
  std::array<Entry, static_cast<std::size_t>(Phase::count_)> entries_{};
};

/// Adds the time between construction and destruction to one phase.
class PhaseScope {
 public:
  PhaseScope(PhaseTimes& times, Phase phase)
      : entry_(times[phase]), start_(std::chrono::steady_clock::now()) {}
  ~PhaseScope() {
    entry_.seconds +=
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    ++entry_.calls;
  }
  PhaseScope(const PhaseScope&) = delete;
  PhaseScope& operator=(const PhaseScope&) = delete;

 private:
  PhaseTimes::Entry& entry_;
  std::chrono::steady_clock::time_point start_;
};

}  // namespace pileus
