// What a run tells its watcher while it goes on.
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace pileus {

/// The state of a run after a step.
struct ProgressState {
  double time = 0;  // s, simulated
  std::uint64_t step = 0;
  double time_step = 0;      // s
  std::string_view limiter;  // what limited the time step, e.g. "strain"
  std::uint64_t parcels = 0;
  std::uint64_t splits = 0, merges = 0;                         // since the start of the run
  double seconds_per_step = 0;                                  // wall clock, recent mean
  std::span<const std::pair<std::string_view, double>> extras;  // shown as name=value
};

/// Receives the progress of a run. Called from the thread that owns the time loop, once a step;
/// implementations return quickly and decide themselves how often to show something.
class Progress {
 public:
  virtual ~Progress() = default;
  /// A run starts at `start` (not zero when resumed) and wants to reach `end`, both in s.
  virtual void begin(std::string_view title, double start, double end) = 0;
  virtual void update(const ProgressState& state) = 0;
  /// A line the user should see, e.g. a checkpoint written or an output file opened.
  virtual void message(std::string_view text) = 0;
  virtual void end() = 0;
};

/// Shows nothing.
class SilentProgress final : public Progress {
 public:
  void begin(std::string_view, double, double) override {}
  void update(const ProgressState&) override {}
  void message(std::string_view) override {}
  void end() override {}
};

}  // namespace pileus
