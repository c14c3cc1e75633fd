// Progress on a terminal: one line redrawn in place, or a line now and then where there is none.
#pragma once
#include <chrono>
#include <cstddef>
#include <ostream>
#include <string>
#include <string_view>

#include "base/progress.hpp"

namespace pileus {

/// "1 h 05 min", "4 min 10 s", "12 s", "0.4 s".
std::string format_duration(double seconds);

/// 1234567 → "1 234 567".
std::string format_count(std::uint64_t count);

/// "name  value" with 4 significant digits, as the progress line and the tables show numbers.
std::string format_value(double value);

/// Whether standard error is a terminal that understands carriage returns.
bool standard_error_is_terminal();

/// The columns of the terminal behind standard error; 80 when unknown.
std::size_t terminal_width();

/// Progress for people. With `interactive`, one line redrawn at most five times a second, cut to
/// `width` columns; without, a line for every 5 % of the way or 60 s, whichever comes first.
class TerminalProgress final : public Progress {
 public:
  using Clock = std::chrono::steady_clock;
  struct Options {
    bool interactive = false;
    std::size_t width = 80;
    Clock::time_point (*now)() = &Clock::now;  // replaced by tests
  };

  TerminalProgress(std::ostream& out, Options options) : out_(out), options_(options) {}

  void begin(std::string_view title, double start, double end) override;
  void update(const ProgressState& state) override;
  void message(std::string_view text) override;
  void end() override;

 private:
  double share_of(double time) const;
  bool is_due(double share, Clock::time_point now) const;
  std::string line_of(const ProgressState& state, double share, double elapsed) const;
  void clear_line();

  std::ostream& out_;
  Options options_;
  double start_ = 0, end_ = 0;  // s, simulated
  Clock::time_point begun_, last_shown_;
  double last_share_ = 0;  // of the way, at the last line
  bool shown_ = false;     // since begin()
  std::size_t drawn_ = 0;  // columns of the line on screen
};

}  // namespace pileus
