#include "base/signals.hpp"

#include <signal.h>
#include <time.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdint>

namespace pileus {

namespace {

std::atomic<int> requested{0};
std::atomic<bool> interrupted{false};
std::atomic<std::int64_t> first_termination{0};  // monotonic ns; 0: none
static_assert(std::atomic<int>::is_always_lock_free && std::atomic<bool>::is_always_lock_free &&
                  std::atomic<std::int64_t>::is_always_lock_free,
              "a signal handler must not wait for a lock");

/// Programs such as timeout(1) send one request twice, to the process and to its group.
constexpr std::int64_t one_request = 500'000'000;  // ns

/// Only async-signal-safe calls from here on (signal-safety(7)).
void restore_terminal_and_die(int signal) {
  if (isatty(STDERR_FILENO) != 0) {
    constexpr char show_cursor[] = "\x1b[?25h\x1b[0m\r\n";
    const ssize_t ignored = write(STDERR_FILENO, show_cursor, sizeof show_cursor - 1);
    (void)ignored;
  }
  struct sigaction action {};
  action.sa_handler = SIG_DFL;
  sigaction(signal, &action, nullptr);
  // The signal is blocked while its handler runs: unblocking delivers it with the default action,
  // so that the shell sees how the process ended.
  raise(signal);
  sigset_t only;
  sigemptyset(&only);
  sigaddset(&only, signal);
  pthread_sigmask(SIG_UNBLOCK, &only, nullptr);
  _exit(128 + signal);
}

std::int64_t monotonic_time() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * std::int64_t{1'000'000'000} + now.tv_nsec;
}

/// Whether a stop was asked for before in this way, so that asking again means at once.
bool is_repeated(int signal) {
  if (signal == SIGINT) return interrupted.exchange(true);
  if (signal != SIGTERM) return false;
  const std::int64_t now = monotonic_time();
  std::int64_t first = 0;
  return !first_termination.compare_exchange_strong(first, now) && now - first > one_request;
}

void on_stop_signal(int signal) {
  const int saved_errno = errno;
  requested.store(signal);
  if (is_repeated(signal)) restore_terminal_and_die(signal);
  errno = saved_errno;
}

}  // namespace

void install_stop_signals() {
  struct sigaction action {};
  action.sa_handler = on_stop_signal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;  // a request must not make a write fail
  for (const int signal : {SIGINT, SIGTERM, SIGUSR1}) sigaction(signal, &action, nullptr);
}

bool stop_requested() {
  return requested.load(std::memory_order_relaxed) != 0;
}
int stop_signal() {
  return requested.load(std::memory_order_relaxed);
}
void request_stop(int signal) {
  requested.store(signal);
  if (signal != 0) return;
  interrupted.store(false);
  first_termination.store(0);
}

}  // namespace pileus
