#include "host/services.hpp"

#include <chrono>
#include <cstdio>
#include <cstring>
#include <exception>
#include <limits>
#include <utility>

#include "base/aligned_array.hpp"
#include "base/log.hpp"
#include "base/parallel.hpp"
#include "base/random.hpp"
#include "host/breadcrumb.hpp"
#include "host/error_record.hpp"
#include "host/floating_point.hpp"

namespace pileus::host {
namespace {

/// Memory of one thread that lives until the call returns. Chunks do not move while in use; after
/// a call that needed several they are joined, so that steady use is one chunk and no allocation.
class ScratchArena {
 public:
  /// How far the memory is given out.
  struct Mark {
    std::size_t chunk = 0, used = 0;
  };

  void* take(std::size_t bytes) {
    const std::size_t padded = (bytes + cache_line_bytes - 1) / cache_line_bytes * cache_line_bytes;
    while (at_.chunk < chunks_.size() && chunks_[at_.chunk].size() - at_.used < padded)
      at_ = {at_.chunk + 1, 0};
    if (at_.chunk == chunks_.size()) chunks_.emplace_back(padded < smallest ? smallest : padded);
    void* memory = chunks_[at_.chunk].data() + at_.used;
    at_.used += padded;
    return memory;
  }
  Mark mark() const { return at_; }
  /// Takes back what was given out since the mark.
  void rewind(const Mark& mark) { at_ = mark; }
  void release() noexcept {
    at_ = {};
    if (chunks_.size() < 2) return;
    std::size_t total = 0;
    for (const auto& chunk : chunks_) total += chunk.size();
    chunks_.clear();
    try {
      chunks_.emplace_back(total);
    } catch (const std::bad_alloc&) {
      return;  // no chunk is as good: the next call allocates what it needs, or is told
    }
  }

 private:
  static constexpr std::size_t smallest = 65536;
  std::vector<AlignedArray<std::byte>> chunks_;
  Mark at_;
};

thread_local ScratchArena arena;

void* take_scratch(const pileus_host*, std::size_t bytes) {
  if (bytes == 0 || bytes > std::numeric_limits<std::size_t>::max() / 2) return nullptr;
  try {
    return arena.take(bytes);
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
}

void give_uniform(const pileus_host*, const pileus_step* step, std::uint64_t uid,
                  std::uint32_t channel, std::uint32_t n, double* out) {
  draw_random({step->seed, step->stream, uid, step->number, step->call, channel}, {out, n});
}

/// A rejected chunk on its way to the plugin that started the loop.
struct ChunkFailure {
  pileus_status status;
  pileus_error error;
};

ChunkFailure chunk_failure(pileus_status status, const char* text) {
  ChunkFailure failure{status, {}};
  failure.error.size = sizeof(pileus_error);
  failure.error.slot = -1;
  std::snprintf(failure.error.text, sizeof failure.error.text, "%s", text);
  return failure;
}

/// One chunk of a loop, on whatever thread: a crash in it names the operator that started the loop,
/// its scratch memory goes back, and the thread's arithmetic stays as it was.
void run_chunk(const Breadcrumb& crumb, pileus_range_fn body, void* user, std::size_t begin,
               std::size_t end) {
  const BreadcrumbScope scope(crumb);
  const std::uint32_t mode = arithmetic_mode();
  const ScratchArena::Mark mark = arena.mark();
  ChunkFailure failure = chunk_failure(PILEUS_OK, "");
  try {
    failure.status = body(user, static_cast<std::int64_t>(begin), static_cast<std::int64_t>(end),
                          &failure.error);
  } catch (const std::exception& exception) {
    failure = chunk_failure(PILEUS_E_INTERNAL, exception.what());
  } catch (...) {
    failure = chunk_failure(PILEUS_E_INTERNAL, "an exception that is no std::exception");
  }
  arena.rewind(mark);
  if (arithmetic_mode() != mode) {
    std::fesetenv(FE_DFL_ENV);
    failure = chunk_failure(PILEUS_E_INTERNAL, changed_arithmetic);
  }
  if (failure.status != PILEUS_OK) throw failure;
}

pileus_status loop_in_parallel(const pileus_host*, std::int64_t n, std::int64_t grain,
                               pileus_range_fn body, void* user, pileus_error* error) {
  if (n <= 0) return PILEUS_OK;
  const auto chunk = static_cast<std::size_t>(grain > 0 ? grain : 1);
  try {
    const Breadcrumb crumb = current_breadcrumb();
    parallel_chunks(
        static_cast<std::size_t>(n),
        [&](std::size_t begin, std::size_t end) { run_chunk(crumb, body, user, begin, end); },
        chunk);
    return PILEUS_OK;
  } catch (const ChunkFailure& failure) {
    give_error(failure.error, error);
    return failure.status;
  } catch (...) {
    return PILEUS_E_INTERNAL;
  }
}

std::uint64_t now_ns() {
  const auto since = std::chrono::steady_clock::now().time_since_epoch();
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::nanoseconds>(since).count());
}

}  // namespace

Services::Services(std::string operator_id, const Lent& lent)
    : id_(std::move(operator_id)), lent_(lent) {
  table_.size = sizeof table_;
  table_.abi_minor = PILEUS_ABI_MINOR;
  table_.impl = this;
  table_.log = write_log;
  table_.should_stop = answer_should_stop;
  table_.scratch = take_scratch;
  table_.uniform = give_uniform;
  table_.parallel_for = loop_in_parallel;
  table_.span_begin = begin_span;
  table_.span_end = end_span;
  table_.extension = find_extension;
  table_.repaired = count_repairs;
}

void Services::write_log(const pileus_host* host, std::uint32_t level, const char* text) {
  constexpr std::array<LogLevel, 4> levels = {LogLevel::debug, LogLevel::info, LogLevel::warning,
                                              LogLevel::error};
  log(levels[level < levels.size() ? level : levels.size() - 1],
      self(host).id_ + ": " + (text != nullptr ? text : ""));
}

int Services::answer_should_stop(const pileus_host* host) {
  bool (*const stop)() = self(host).lent_.stop;
  return stop != nullptr && stop() ? 1 : 0;
}

const void* Services::find_extension(const pileus_host* host, const char* id) {
  if (id == nullptr) return nullptr;
  if (std::strcmp(id, PILEUS_MESH_EXTENSION) == 0) return self(host).lent_.mesh;
  if (std::strcmp(id, PILEUS_ITEM_LISTS_EXTENSION) == 0) return self(host).lent_.items;
  return nullptr;
}

// A token is the time in nanoseconds with its top four bits replaced by the timer's number; 2^60 ns
// are 36 years, and differences are taken modulo that.
std::uint64_t Services::begin_span(const pileus_host* host, const char* name) {
  if (name == nullptr) return 0;
  const Services& me = self(host);
  std::size_t index = 0;
  const auto find = [&] {
    const std::size_t count = me.timer_count_.load(std::memory_order_acquire);
    while (index < count && std::strncmp(me.timers_[index].name, name, 39) != 0) ++index;
    return index < count;
  };
  if (!find()) {
    const std::lock_guard lock(me.adding_timer_);
    if (!find()) {
      if (index == most_timers) return 0;
      std::strncpy(me.timers_[index].name, name, 39);
      me.timer_count_.store(index + 1, std::memory_order_release);
    }
  }
  return std::uint64_t{index + 1} << 60 | (now_ns() << 4 >> 4);
}

void Services::end_span(const pileus_host* host, std::uint64_t token) {
  const std::uint64_t index = token >> 60;
  if (index == 0) return;
  Timer& timer = self(host).timers_[index - 1];
  timer.calls.fetch_add(1, std::memory_order_relaxed);
  timer.nanoseconds.fetch_add((now_ns() - token) << 4 >> 4, std::memory_order_relaxed);
}

void Services::count_repairs(const pileus_host* host, std::uint64_t count) {
  self(host).repairs_.fetch_add(count, std::memory_order_relaxed);
}

std::vector<Span> Services::spans() const {
  std::vector<Span> all;
  for (std::size_t i = 0; i < timer_count_.load(std::memory_order_acquire); ++i) {
    all.push_back({timers_[i].name, timers_[i].calls.load(),
                   static_cast<double>(timers_[i].nanoseconds.load()) * 1e-9});
  }
  return all;
}

void release_scratch() noexcept {
  arena.release();
}

}  // namespace pileus::host
