#include "base/terminal.hpp"

#include <gtest/gtest.h>

#include <sstream>
#include <vector>

namespace pileus {
namespace {

using Clock = TerminalProgress::Clock;

// A clock the tests move by hand.
Clock::time_point current_time;
Clock::time_point now() {
  return current_time;
}
void pass(double seconds) {
  current_time +=
      std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

ProgressState state_at(double time) {
  ProgressState state;
  state.time = time;
  state.step = 42;
  state.time_step = 0.5;
  state.limiter = "strain";
  state.parcels = 200000;
  state.seconds_per_step = 0.2;  // 1000 ns per parcel
  return state;
}

std::size_t lines_in(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

TEST(format_duration, changes_units_where_people_do) {
  EXPECT_EQ(format_duration(0.44), "0.4 s");
  EXPECT_EQ(format_duration(9.96), "10 s");
  EXPECT_EQ(format_duration(59.4), "59 s");
  EXPECT_EQ(format_duration(59.6), "1 min 00 s");
  EXPECT_EQ(format_duration(250), "4 min 10 s");
  EXPECT_EQ(format_duration(3900), "1 h 05 min");
  EXPECT_EQ(format_duration(-1), "?");
}

TEST(format_count, separates_thousands) {
  EXPECT_EQ(format_count(7), "7");
  EXPECT_EQ(format_count(999), "999");
  EXPECT_EQ(format_count(1000), "1 000");
  EXPECT_EQ(format_count(1234567), "1 234 567");
}

TEST(TerminalProgress, without_terminal_a_line_for_every_twentieth_of_the_way) {
  std::ostringstream out;
  TerminalProgress progress(out, {.interactive = false, .width = 80, .now = &now});
  progress.begin("wave", 0, 100);
  for (int i = 1; i <= 1000; ++i) progress.update(state_at(0.1 * i));
  // One for the title, then at 5, 10, … 100 %.
  EXPECT_EQ(lines_in(out.str()), 21u);
  EXPECT_EQ(out.str().find('\r'), std::string::npos);
}

TEST(TerminalProgress, without_terminal_a_line_after_a_minute_on_a_slow_run) {
  std::ostringstream out;
  TerminalProgress progress(out, {.interactive = false, .width = 80, .now = &now});
  progress.begin("wave", 0, 1e6);
  pass(59);
  progress.update(state_at(1));
  EXPECT_EQ(lines_in(out.str()), 1u);
  pass(1);
  progress.update(state_at(2));
  EXPECT_EQ(lines_in(out.str()), 2u);
}

TEST(TerminalProgress, on_a_terminal_at_most_five_draws_a_second) {
  std::ostringstream out;
  TerminalProgress progress(out, {.interactive = true, .width = 200, .now = &now});
  progress.begin("wave", 0, 100);
  for (int i = 0; i < 100; ++i) {
    progress.update(state_at(1));
    pass(0.01);
  }
  const std::string text = out.str();
  // Draws at 0, 0.2, 0.4, 0.6 and 0.8 s.
  EXPECT_EQ(std::count(text.begin(), text.end(), '\r'), 5);
}

TEST(TerminalProgress, line_names_time_step_limiter_cost_and_remaining_time) {
  std::ostringstream out;
  TerminalProgress progress(out, {.interactive = true, .width = 300, .now = &now});
  progress.begin("wave", 0, 100);
  pass(10);
  ProgressState state = state_at(25);
  state.splits = 1200;
  state.merges = 3;
  const std::vector<std::pair<std::string_view, double>> extras = {{"max w", 12.3456}};
  state.extras = extras;
  progress.update(state);
  // A quarter of the way in 10 s leaves 30 s.
  EXPECT_NE(out.str().find(" 25 %  t=25 s  step 42  dt=0.5 s (strain)  200 000 parcels  "
                           "1000 ns/parcel-step  ETA 30 s  split 1 200, merged 3  max w=12.35"),
            std::string::npos)
      << out.str();
}

TEST(TerminalProgress, remaining_time_of_a_resumed_run_counts_from_where_it_resumed) {
  std::ostringstream out;
  TerminalProgress progress(out, {.interactive = true, .width = 300, .now = &now});
  progress.begin("wave", 50, 100);
  pass(10);
  progress.update(state_at(60));  // a fifth of what is left
  EXPECT_NE(out.str().find("ETA 40 s"), std::string::npos) << out.str();
}

TEST(TerminalProgress, line_fits_a_narrow_terminal) {
  std::ostringstream out;
  TerminalProgress progress(out, {.interactive = true, .width = 30, .now = &now});
  progress.begin("wave", 0, 100);
  progress.update(state_at(25));
  const std::string text = out.str();
  EXPECT_EQ(text.size() - text.find('\r') - 1, 29u);
}

TEST(TerminalProgress, message_leaves_no_rest_of_the_progress_line) {
  std::ostringstream out;
  TerminalProgress progress(out, {.interactive = true, .width = 40, .now = &now});
  progress.begin("wave", 0, 100);
  progress.update(state_at(25));
  progress.message("checkpoint written");
  const std::string text = out.str();
  EXPECT_NE(text.find('\r' + std::string(39, ' ') + "\rcheckpoint written\n"), std::string::npos);
}

}  // namespace
}  // namespace pileus
