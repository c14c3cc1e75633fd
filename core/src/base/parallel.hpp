// Loops over threads whose results do not depend on how many threads there are.
//
// Work is cut into chunks whose boundaries depend on the problem alone; reductions add the chunks'
// results in chunk order. Exceptions thrown inside a chunk are carried out of the parallel region
// (the one of the lowest chunk wins, so that the message is reproducible too).
#pragma once
#include <omp.h>

#include <atomic>
#include <cstddef>
#include <exception>
#include <limits>
#include <vector>

namespace pileus {

/// Elements per chunk where nothing argues for another number: long enough to hide the loop's
/// start, short enough for its arrays to stay in the second-level cache.
inline constexpr std::size_t default_chunk = 2048;

/// Keeps the exception of the lowest task index thrown in a parallel region.
class FirstFailure {
 public:
  template <class F>
  void guard(std::size_t task, F&& body) noexcept {
    try {
      body();
    } catch (...) {
#pragma omp critical(pileus_first_failure)
      if (task < task_) {
        task_ = task;
        failure_ = std::current_exception();
      }
    }
  }
  void rethrow() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  std::exception_ptr failure_;
  std::size_t task_ = std::numeric_limits<std::size_t>::max();
};

/// Shares of consecutive tasks, one per thread. A thread works through its own share and then helps
/// the others with theirs. The same task so tends to meet the same thread, with its data in that
/// thread's cache, in one loop after another.
class TaskShares {
 public:
  TaskShares(std::size_t tasks, int threads)
      : tasks_(tasks), shares_(static_cast<std::size_t>(threads < most ? threads : most)) {
    for (std::size_t s = 0; s < shares_; ++s) next_[s].task.store(begin(s));
  }
  /// Calls body(task) until no share has a task left; on every thread of a parallel region.
  template <class F>
  void work(int thread, F&& body) {
    for (std::size_t turn = 0; turn < shares_; ++turn) {
      const std::size_t share = (static_cast<std::size_t>(thread) + turn) % shares_;
      const std::size_t end = begin(share + 1);
      for (;;) {
        const std::size_t task = next_[share].task.fetch_add(1, std::memory_order_relaxed);
        if (task >= end) break;
        body(task);
      }
    }
  }

 private:
  static constexpr int most = 128;
  std::size_t begin(std::size_t share) const { return tasks_ * share / shares_; }

  struct alignas(64) Counter {
    std::atomic<std::size_t> task;
  };
  std::size_t tasks_, shares_;
  Counter next_[most];
};

/// Calls body(task) for task = 0 … count−1, in any order, on all threads.
template <class F>
void parallel_tasks(std::size_t count, F&& body) {
  FirstFailure failure;
  const int threads = omp_in_parallel() ? 1 : omp_get_max_threads();
  if (count <= 1 || threads == 1) {
    for (std::size_t task = 0; task < count; ++task) failure.guard(task, [&] { body(task); });
  } else {
    TaskShares shares(count, threads);
#pragma omp parallel
    shares.work(omp_get_thread_num(),
                [&](std::size_t task) { failure.guard(task, [&] { body(task); }); });
  }
  failure.rethrow();
}

/// Calls body(begin, end) over [0, count) in chunks of `chunk` elements (a multiple of 8, so that
/// only the last chunk has a ragged end).
template <class F>
void parallel_chunks(std::size_t count, F&& body, std::size_t chunk = default_chunk) {
  parallel_tasks((count + chunk - 1) / chunk, [&](std::size_t task) {
    const std::size_t begin = task * chunk;
    body(begin, begin + chunk < count ? begin + chunk : count);
  });
}

/// Reduces partial(begin, end) over chunks of [0, count) with `combine`, in chunk order.
template <class T, class Partial, class Combine>
T ordered_reduce(std::size_t count, T initial, Partial&& partial, Combine&& combine,
                 std::size_t chunk = default_chunk) {
  const std::size_t tasks = (count + chunk - 1) / chunk;
  std::vector<T> partials(tasks, initial);
  parallel_chunks(
      count,
      [&](std::size_t begin, std::size_t end) { partials[begin / chunk] = partial(begin, end); },
      chunk);
  T total = initial;
  for (const T& value : partials) total = combine(total, value);
  return total;
}

}  // namespace pileus
