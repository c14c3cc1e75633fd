#include "base/signals.hpp"

#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>

namespace pileus {

namespace {

std::atomic<int> requested{0};
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler must not wait for a lock");

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

void on_stop_signal(int signal) {
  const int saved_errno = errno;
  const int before = requested.exchange(signal);
  if (signal == SIGINT && before == SIGINT) restore_terminal_and_die(signal);
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
}

}  // namespace pileus
