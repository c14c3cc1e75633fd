#include "study/sweep_progress.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/terminal.hpp"

namespace pileus::study {

namespace {

constexpr std::chrono::milliseconds redraw_interval{200};
constexpr std::size_t most_lines = 16;  // of running members

}  // namespace

void SweepProgress::already_ended(std::size_t done, std::size_t failed) {
  const std::lock_guard lock(mutex_);
  done_ += done;
  failed_ += failed;
}

/// From the ways covered since the start, of running members too; negative when unknown.
double SweepProgress::seconds_left() const {
  double covered = covered_, open = static_cast<double>(members_ - done_ - failed_);
  for (const auto& [index, one] : running_) {
    covered += one.share - std::max(0.0, one.at_start);
    open -= one.share;
  }
  const std::chrono::duration<double> spent = options_.now() - started_;
  return covered > 0.02 ? spent.count() * open / covered : -1;
}

std::string SweepProgress::headline() const {
  std::string line = fmt::format("{} of {} members done, {} running, {} failed", done_, members_,
                                 running_.size(), failed_);
  const double left = seconds_left();
  if (left >= 0 && done_ + failed_ < members_) line += ", ETA " + format_duration(left);
  return line;
}

void SweepProgress::begin(const Member& member, bool resumed) {
  const std::lock_guard lock(mutex_);
  running_[member.index] = {member.label, 0, resumed ? -1.0 : 0.0};
  draw();
}

void SweepProgress::update(const Member& member, double share) {
  const std::lock_guard lock(mutex_);
  Running& one = running_[member.index];
  if (one.at_start < 0 && share > 0) one.at_start = share;
  one.share = std::clamp(share, 0.0, 1.0);
  if (options_.now() - last_drawn_ >= redraw_interval) draw();
}

void SweepProgress::end(const Member& member, const std::string& outcome, bool well) {
  const std::lock_guard lock(mutex_);
  covered_ += 1 - std::max(0.0, running_[member.index].at_start);
  running_.erase(member.index);
  ++(well ? done_ : failed_);
  if (options_.quiet) return;
  clear();
  // The table says how all stands; without it every line does.
  if (!options_.interactive || !well)
    out_ << fmt::format("{}  {}{}{}", index_text(member.index), member.label,
                        member.label.empty() ? "" : ": ", outcome)
         << (options_.interactive ? "" : "; " + headline()) << '\n'
         << std::flush;
  draw();
}

void SweepProgress::message(const std::string& text) {
  const std::lock_guard lock(mutex_);
  if (options_.quiet) return;
  clear();
  out_ << text << '\n' << std::flush;
  draw();
}

void SweepProgress::finish() {
  const std::lock_guard lock(mutex_);
  clear();
  out_ << std::flush;
}

/// Takes the table off the screen: up to its first line, and erase from there.
void SweepProgress::clear() {
  if (drawn_ == 0) return;
  out_ << fmt::format("\r\x1b[{}A\x1b[J", drawn_);
  drawn_ = 0;
}

std::string SweepProgress::fitted(std::string line) const {
  if (line.size() + 1 > options_.width) line.resize(options_.width > 1 ? options_.width - 1 : 0);
  return line + '\n';
}

void SweepProgress::draw() {
  if (options_.quiet || !options_.interactive) return;
  clear();
  std::string table = fitted(headline());
  drawn_ = 1;
  for (const auto& [index, one] : running_) {
    if (drawn_ > most_lines) break;
    constexpr std::size_t bar = 20;
    const auto full = static_cast<std::size_t>(one.share * bar);
    table +=
        fitted(fmt::format("  {}  [{}{}] {:3.0f} %  {}", index_text(index), std::string(full, '='),
                           std::string(bar - full, ' '), 100 * one.share, one.label));
    ++drawn_;
  }
  out_ << table << std::flush;
  last_drawn_ = options_.now();
}

}  // namespace pileus::study
