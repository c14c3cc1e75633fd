#include "base/terminal.hpp"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <string>

namespace pileus {

namespace {

constexpr double redraw_seconds = 0.2;
constexpr double line_seconds = 60;
constexpr double line_share = 0.05;

/// Columns a UTF-8 text takes: its code points (all single-width here).
std::size_t columns_of(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  }));
}

/// The first `columns` code points of a UTF-8 text.
std::string_view cut(std::string_view text, std::size_t columns) {
  std::size_t seen = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if ((static_cast<unsigned char>(text[i]) & 0xC0) != 0x80 && seen++ == columns) {
      return text.substr(0, i);
    }
  }
  return text;
}

}  // namespace

std::string format_duration(double seconds) {
  if (!std::isfinite(seconds) || seconds < 0) return "?";
  if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
  const auto whole = static_cast<long long>(std::llround(seconds));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

std::string format_count(std::uint64_t count) {
  std::string digits = std::to_string(count);
  for (std::size_t from_end = 3; from_end < digits.size(); from_end += 4) {
    digits.insert(digits.size() - from_end, 1, ' ');
  }
  return digits;
}

std::string format_value(double value) {
  return fmt::format("{:.4g}", value);
}

bool standard_error_is_terminal() {
  const char* term = std::getenv("TERM");
  return isatty(STDERR_FILENO) != 0 && (term == nullptr || std::strcmp(term, "dumb") != 0);
}

std::size_t terminal_width() {
  winsize size{};
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return 80;
  return size.ws_col;
}

void TerminalProgress::begin(std::string_view title, double start, double end) {
  start_ = start;
  end_ = end;
  begun_ = last_shown_ = options_.now();
  last_share_ = 0;
  shown_ = false;
  out_ << fmt::format("{}: {:.6g} s to {:.6g} s\n", title, start, end) << std::flush;
}

double TerminalProgress::share_of(double time) const {
  return end_ > start_ ? std::clamp((time - start_) / (end_ - start_), 0.0, 1.0) : 1.0;
}

bool TerminalProgress::is_due(double share, Clock::time_point now) const {
  const double since = std::chrono::duration<double>(now - last_shown_).count();
  if (options_.interactive) return !shown_ || since >= redraw_seconds || share >= 1;
  return since >= line_seconds || share >= 1 ||
         std::floor(share / line_share) > std::floor(last_share_ / line_share);
}

std::string TerminalProgress::line_of(const ProgressState& state, double share,
                                      double elapsed) const {
  std::string line = fmt::format("{:3.0f} %  t={:.5g} s  step {}  dt={:.3g} s", 100 * share,
                                 state.time, state.step, state.time_step);
  if (!state.limiter.empty()) line += fmt::format(" ({})", state.limiter);
  line += fmt::format("  {} parcels", format_count(state.parcels));
  if (state.parcels > 0 && state.seconds_per_step > 0) {
    line += fmt::format("  {:.0f} ns/parcel-step",
                        1e9 * state.seconds_per_step / static_cast<double>(state.parcels));
  }
  // From the share of simulated time covered so far: right as soon as the step length settles.
  if (share > 0 && share < 1) line += "  ETA " + format_duration(elapsed * (1 - share) / share);
  if (state.splits > 0 || state.merges > 0) {
    line += fmt::format("  split {}, merged {}", format_count(state.splits),
                        format_count(state.merges));
  }
  for (const auto& [name, value] : state.extras) {
    line += fmt::format("  {}={}", name, format_value(value));
  }
  return line;
}

void TerminalProgress::update(const ProgressState& state) {
  const Clock::time_point now = options_.now();
  const double share = share_of(state.time);
  if (!is_due(share, now)) return;
  const double elapsed = std::chrono::duration<double>(now - begun_).count();
  const std::string line = line_of(state, share, elapsed);
  if (options_.interactive) {
    // The last column stays free: some terminals wrap as soon as it is written.
    const std::string_view visible = cut(line, options_.width - 1);
    const std::size_t columns = columns_of(visible);
    out_ << '\r' << visible << std::string(drawn_ > columns ? drawn_ - columns : 0, ' ')
         << std::flush;
    drawn_ = columns;
  } else {
    out_ << line << '\n' << std::flush;
  }
  last_shown_ = now;
  last_share_ = share;
  shown_ = true;
}

void TerminalProgress::clear_line() {
  if (drawn_ == 0) return;
  out_ << '\r' << std::string(drawn_, ' ') << '\r';
  drawn_ = 0;
}

void TerminalProgress::message(std::string_view text) {
  clear_line();
  out_ << text << '\n' << std::flush;
}

void TerminalProgress::end() {
  if (drawn_ > 0) out_ << '\n' << std::flush;  // the last state stays readable
  drawn_ = 0;
}

}  // namespace pileus
