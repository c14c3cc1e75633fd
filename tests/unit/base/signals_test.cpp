#include "base/signals.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

namespace pileus {
namespace {

/// How a child ends that runs `body`: its exit status, or minus the signal that killed it.
template <class Body>
int ending_of(Body&& body) {
  const pid_t child = fork();
  if (child == 0) {
    install_stop_signals();
    body();
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
}

TEST(Signals, each_stop_signal_sets_the_flag_and_the_process_goes_on) {
  for (const int signal : {SIGINT, SIGTERM, SIGUSR1})
    EXPECT_EQ(ending_of([signal] {
                if (stop_requested()) _exit(1);
                raise(signal);
                if (!stop_requested() || stop_signal() != signal) _exit(2);
                _exit(42);
              }),
              42)
        << "signal " << signal;
}

TEST(Signals, second_interrupt_ends_the_process_by_that_signal) {
  EXPECT_EQ(ending_of([] {
              raise(SIGINT);
              raise(SIGINT);
            }),
            -SIGINT);
}

TEST(Signals, repeated_termination_requests_do_not_kill) {
  EXPECT_EQ(ending_of([] {
              for (int n = 0; n < 3; ++n) raise(SIGTERM);
              _exit(stop_signal() == SIGTERM ? 42 : 1);
            }),
            42);
}

TEST(Signals, a_termination_asked_for_again_later_ends_the_process) {
  EXPECT_EQ(ending_of([] {
              raise(SIGTERM);
              usleep(600'000);
              raise(SIGTERM);
            }),
            -SIGTERM);
}

// Ctrl-C reaches a sweep and its members, and the sweep passes a SIGTERM on: one request.
TEST(Signals, an_interrupt_and_a_termination_are_one_request) {
  EXPECT_EQ(ending_of([] {
              raise(SIGINT);
              usleep(600'000);
              raise(SIGTERM);
              _exit(42);
            }),
            42);
  EXPECT_EQ(ending_of([] {
              raise(SIGINT);
              raise(SIGTERM);
              raise(SIGINT);
            }),
            -SIGINT);
}

TEST(Signals, an_interrupt_after_another_request_is_still_the_first) {
  EXPECT_EQ(ending_of([] {
              raise(SIGUSR1);
              raise(SIGINT);
              _exit(42);
            }),
            42);
}

TEST(Signals, request_can_be_made_and_cleared_by_the_program) {
  request_stop(SIGTERM);
  EXPECT_TRUE(stop_requested());
  request_stop(0);
  EXPECT_FALSE(stop_requested());
}

}  // namespace
}  // namespace pileus
