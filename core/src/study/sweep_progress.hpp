// Progress of a sweep: how many members are done, running and failed, and when all will be done.
#pragma once
#include <chrono>
#include <map>
#include <mutex>
#include <ostream>
#include <string>

#include "study/sweep_members.hpp"

namespace pileus::study {

/// On a terminal a table redrawn in place, without one a line per member that ends. May be called
/// from several threads.
class SweepProgress {
 public:
  using Clock = std::chrono::steady_clock;
  struct Options {
    bool quiet = false, interactive = false;
    std::size_t width = 80;
    Clock::time_point (*now)() = &Clock::now;  // replaced by tests
  };
  SweepProgress(std::ostream& out, Options options, std::size_t members)
      : out_(out), options_(options), members_(members), started_(options.now()) {}

  /// Members that an earlier call ended, well or not, and that are not run now.
  void already_ended(std::size_t done, std::size_t failed);
  /// `resumed`: it does not begin at its start.
  void begin(const Member& member, bool resumed);
  /// A running member has covered this share of its way.
  void update(const Member& member, double share);
  void end(const Member& member, const std::string& outcome, bool well);
  void message(const std::string& text);
  /// Leaves the terminal clean.
  void finish();

 private:
  struct Running {
    std::string label;
    double share = 0, at_start = -1;  // of the way; −1: not yet known
  };
  std::string headline() const;
  double seconds_left() const;
  void clear();
  void draw();
  std::string fitted(std::string line) const;

  std::ostream& out_;
  const Options options_;
  const std::size_t members_;
  const Clock::time_point started_;
  std::mutex mutex_;
  std::map<std::size_t, Running> running_;  // by index
  std::size_t done_ = 0, failed_ = 0;
  double covered_ = 0;     // ways of members that this call has finished, in members
  std::size_t drawn_ = 0;  // lines of the table on the screen
  Clock::time_point last_drawn_{};
};

}  // namespace pileus::study
