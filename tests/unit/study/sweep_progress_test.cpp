// Progress of sweeps: lines without a terminal, a table on one, and how long it still takes.
#include "study/sweep_progress.hpp"

#include <gtest/gtest.h>

#include <sstream>

namespace pileus::study {
namespace {

using Clock = SweepProgress::Clock;

Clock::time_point now_of_tests{};

Clock::time_point made_up_now() {
  return now_of_tests;
}

void wait(int seconds) {
  now_of_tests += std::chrono::seconds(seconds);
}

Member member(std::size_t index, const std::string& label) {
  Member one;
  one.index = index;
  one.label = label;
  return one;
}

TEST(SweepProgress, WritesALinePerMemberWithoutATerminal) {
  std::ostringstream out;
  SweepProgress progress(out, {.now = made_up_now}, 4);
  progress.already_ended(1, 0);
  progress.begin(member(1, "beta 0.1"), false);
  progress.begin(member(2, "beta 0.3"), false);
  wait(10);
  progress.update(member(1, "beta 0.1"), 0.5);
  EXPECT_EQ(out.str(), "");
  progress.end(member(1, "beta 0.1"), "done (10 s)", true);
  // One of three ways took 10 s while the others stood still.
  EXPECT_EQ(out.str(),
            "0001  beta 0.1: done (10 s); 2 of 4 members done, 1 running, 0 failed, ETA 20 s\n");
  progress.end(member(2, "beta 0.3"), "failed with exit code 4", false);
  EXPECT_NE(out.str().find("0002  beta 0.3: failed with exit code 4; 2 of 4 members done, 0 "
                           "running, 1 failed"),
            std::string::npos);
}

TEST(SweepProgress, CountsHalfWaysTowardsTheEnd) {
  std::ostringstream out;
  SweepProgress progress(out, {.interactive = true, .now = made_up_now}, 4);
  progress.begin(member(0, ""), false);
  progress.begin(member(1, ""), false);
  wait(10);
  progress.update(member(0, ""), 0.01);
  wait(10);
  progress.update(member(0, ""), 0.5);
  progress.update(member(1, ""), 0.01);
  wait(10);
  out.str("");
  progress.update(member(1, ""), 0.5);
  // One of four ways in 30 s: three are left.
  EXPECT_NE(out.str().find("0 of 4 members done, 2 running, 0 failed, ETA 1 min 30 s"),
            std::string::npos)
      << out.str();
}

TEST(SweepProgress, WaysOfEarlierCallsTookNoTimeNow) {
  std::ostringstream out;
  SweepProgress progress(out, {.interactive = true, .now = made_up_now}, 2);
  progress.begin(member(0, ""), true);
  progress.update(member(0, ""), 0.6);
  wait(10);
  out.str("");
  progress.update(member(0, ""), 0.8);
  // A fifth of a way in 10 s: one and a fifth are left.
  EXPECT_NE(out.str().find("ETA 1 min 00 s"), std::string::npos) << out.str();
}

TEST(SweepProgress, RedrawsATableOnATerminal) {
  std::ostringstream out;
  SweepProgress progress(out, {.interactive = true, .width = 40, .now = made_up_now}, 2);
  progress.begin(member(0, "a label that is longer than the line has room for"), false);
  EXPECT_EQ(out.str(),
            "0 of 2 members done, 1 running, 0 faile\n"
            "  0000  [                    ]   0 %  a\n");
  out.str("");
  progress.finish();
  EXPECT_EQ(out.str(), "\r\x1b[2A\x1b[J");  // two lines up, and erase
}

TEST(SweepProgress, SaysNothingWhenQuiet) {
  std::ostringstream out;
  SweepProgress progress(out, {.quiet = true, .interactive = true, .now = made_up_now}, 1);
  progress.begin(member(0, ""), false);
  progress.update(member(0, ""), 1);
  progress.end(member(0, ""), "done", true);
  progress.message("words");
  progress.finish();
  EXPECT_EQ(out.str(), "");
}

}  // namespace
}  // namespace pileus::study
