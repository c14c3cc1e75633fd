// What the host lends to an operator instance: log, memory, random numbers, loops, timers.
#pragma once
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

#include "pileus/abi.h"

namespace pileus::host {

/// Total of a named timer.
struct Span {
  std::string name;
  std::uint64_t calls = 0;
  double seconds = 0;  // summed over threads
};

/// What the core lends to an instance beside the services themselves; all may be null.
struct Lent {
  bool (*stop)() = nullptr;                      // answers should_stop, on any thread
  const pileus_mesh_ext* mesh = nullptr;         // the extension pileus.mesh/1
  const pileus_item_lists_ext* items = nullptr;  // the extension pileus.item_lists/1
};

/// The service table of one instance. Does not move: the plugin keeps its address.
class Services {
 public:
  /// `operator_id` prefixes log records.
  Services(std::string operator_id, const Lent& lent);
  Services(const Services&) = delete;
  Services& operator=(const Services&) = delete;

  const pileus_host& table() const { return table_; }
  std::vector<Span> spans() const;
  std::uint64_t repairs() const { return repairs_.load(); }

 private:
  static const Services& self(const pileus_host* host) {
    return *static_cast<const Services*>(host->impl);
  }
  static void write_log(const pileus_host*, std::uint32_t level, const char* text);
  static int answer_should_stop(const pileus_host*);
  static const void* find_extension(const pileus_host*, const char* id);
  static std::uint64_t begin_span(const pileus_host*, const char* name);
  static void end_span(const pileus_host*, std::uint64_t token);
  static void count_repairs(const pileus_host*, std::uint64_t count);

  struct Timer {
    char name[40] = {};
    std::atomic<std::uint64_t> calls = 0, nanoseconds = 0;
  };
  static constexpr std::size_t most_timers = 15;  // an index of four bits, 0 meaning none

  std::string id_;
  Lent lent_;
  pileus_host table_{};
  mutable std::array<Timer, most_timers> timers_;
  mutable std::atomic<std::size_t> timer_count_ = 0;
  mutable std::mutex adding_timer_;
  mutable std::atomic<std::uint64_t> repairs_ = 0;
};

/// Gives back all scratch memory of this thread; called before each outermost call into a plugin.
void release_scratch() noexcept;

}  // namespace pileus::host
