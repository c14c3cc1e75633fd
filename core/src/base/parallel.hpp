// Loops over threads whose results do not depend on how many threads there are.
//
// Work is cut into chunks whose boundaries depend on the problem alone; reductions add the chunks'
// results in chunk order. Exceptions thrown inside a chunk are carried out of the parallel region
// (the one of the lowest chunk wins, so that the message is reproducible too).
#pragma once
#include <omp.h>

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

/// Calls body(task) for task = 0 … count−1, in any order, on all threads.
template <class F>
void parallel_tasks(std::size_t count, F&& body) {
  FirstFailure failure;
#pragma omp parallel for schedule(dynamic, 1) if (count > 1)
  for (std::size_t task = 0; task < count; ++task) failure.guard(task, [&] { body(task); });
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
