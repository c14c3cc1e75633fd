#include "study/study_progress.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/terminal.hpp"

namespace pileus::study {

std::vector<double> StudyProgress::position(std::size_t point) const {
  std::vector<double> place;
  for (std::size_t k = 0; k < layout_.knobs.size(); ++k) {
    const int rung = layout_.points[point].rungs[k];
    const auto& ladder = layout_.knobs[k].ladder;
    // A run that only others are compared with is as fine as the finest.
    const std::size_t at = rung < 0 ? ladder.size() - 1 : static_cast<std::size_t>(rung);
    const double number = ladder[at].number;
    place.push_back(number > 0 ? std::log(number) : static_cast<double>(at));
  }
  return place;
}

void StudyProgress::already_done(std::size_t point, double seconds) {
  model_.learn(position(point), seconds);
  ++done_;
}

double StudyProgress::remaining(double share) const {
  double seconds = 0;
  for (std::size_t w = 0; w < waiting_.size(); ++w) {
    const auto expected = model_.predict(position(waiting_[w]));
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - begun_;
    if (w == 0 && share > 0.02)
      seconds += spent.count() * (1 - share) / share;
    else if (expected)
      seconds += *expected;
    else
      return -1;
  }
  return seconds;
}

void StudyProgress::begin(std::size_t) {
  total_ = done_ + waiting_.size();
  begun_ = std::chrono::steady_clock::now();
  update(0);
}

void StudyProgress::update(double share) {
  if (options_.quiet || !options_.interactive || waiting_.empty()) return;
  std::string line = fmt::format("run {} of {}: {}  {:.0f} %", done_ + 1, total_,
                                 layout_.points[waiting_.front()].label, 100 * share);
  const double seconds = remaining(share);
  if (seconds >= 0) line += "  study: ETA " + format_duration(seconds);
  if (line.size() + 1 > options_.width) line.resize(options_.width - 1);
  out_ << '\r' << line << std::string(drawn_ > line.size() ? drawn_ - line.size() : 0, ' ')
       << std::flush;
  drawn_ = line.size();
}

void StudyProgress::end(const std::string& outcome, double seconds) {
  const std::size_t point = waiting_.front();
  model_.learn(position(point), seconds);
  waiting_.erase(waiting_.begin());
  ++done_;
  if (options_.quiet) return;
  std::string line = fmt::format("{} of {}  {}: {} ({})", done_, total_,
                                 layout_.points[point].label, outcome, format_duration(seconds));
  const double left = remaining(0);
  if (!waiting_.empty() && left >= 0) line += ", ETA " + format_duration(left);
  message(line);
}

void StudyProgress::clear() {
  if (drawn_ == 0) return;
  out_ << '\r' << std::string(drawn_, ' ') << '\r';
  drawn_ = 0;
}

void StudyProgress::message(const std::string& text) {
  if (options_.quiet) return;
  clear();
  out_ << text << '\n' << std::flush;
}

}  // namespace pileus::study
