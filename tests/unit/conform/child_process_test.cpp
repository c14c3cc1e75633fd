// Whatever becomes of work in a process of its own, it is a result here.
#include "conform/child_process.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <stdexcept>
#include <thread>

namespace pileus::conform {
namespace {

TEST(ChildProcess, returns_what_the_work_returns) {
  const ChildResult child = run_in_child([] { return std::string(100000, 'x'); }, 20);
  EXPECT_TRUE(child.finished);
  EXPECT_EQ(child.text.size(), 100000u);
}

TEST(ChildProcess, catches_what_the_work_prints) {
  const ChildResult child = run_in_child(
      [] {
        std::fputs("a remark", stderr);
        return std::string("done");
      },
      20);
  EXPECT_TRUE(child.finished);
  EXPECT_EQ(child.words, "a remark");
}

TEST(ChildProcess, survives_a_crash) {
  const ChildResult child = run_in_child(
      [] {
        std::raise(SIGKILL);
        return std::string("done");
      },
      20);
  EXPECT_FALSE(child.finished);
  EXPECT_EQ(child.end, "crashed with signal 9 (Killed)");
}

TEST(ChildProcess, ends_what_computes_without_end) {
  const ChildResult child = run_in_child(
      [] {
        for (volatile bool on = true; on;) {
        }
        return std::string("done");
      },
      0.2);
  EXPECT_FALSE(child.finished);
  EXPECT_EQ(child.end, "took longer than 0.2 s of processor time");
}

TEST(ChildProcess, ends_what_waits_without_end) {
  const ChildResult child = run_in_child(
      [] {
        while (true) std::this_thread::sleep_for(std::chrono::seconds(1));
        return std::string("done");
      },
      0.1);
  EXPECT_FALSE(child.finished);
  EXPECT_EQ(child.end, "took longer than 1 s");
}

// A busy machine fails nobody: what counts is the time a processor was at work for it.
TEST(ChildProcess, lets_work_wait_longer_than_it_may_compute) {
  const ChildResult child = run_in_child(
      [] {
        std::this_thread::sleep_for(std::chrono::milliseconds(600));
        return std::string("done");
      },
      0.2);
  EXPECT_TRUE(child.finished) << child.end;
}

TEST(ChildProcess, notices_an_early_end) {
  const ChildResult child = run_in_child(
      [] {
        ::_exit(7);
        return std::string("done");
      },
      20);
  EXPECT_FALSE(child.finished);
  EXPECT_EQ(child.end, "ended with exit code 7");
}

TEST(ChildProcess, an_exception_is_no_result) {
  const ChildResult child =
      run_in_child([]() -> std::string { throw std::runtime_error("no luck"); }, 20);
  EXPECT_FALSE(child.finished);
  EXPECT_NE(child.words.find("no luck"), std::string::npos);
}

}  // namespace
}  // namespace pileus::conform
