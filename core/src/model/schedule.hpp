// When something is due that happens at intervals.
#pragma once
#include <vector>

namespace pileus::model {

/// Multiples of an interval, without drift.
class Schedule {
 public:
  /// `every` ≤ 0: never.
  explicit Schedule(double every) : every_(every) {}
  /// Next multiple that is not done (s), infinity when never.
  double next() const;
  /// First multiple after `time` (s), infinity when never.
  double next_after(double time) const;
  bool due(double time) const { return time >= next() - 1e-9 * every_; }
  /// The record of `time` is written: the next one is the first multiple after it.
  void done(double time);
  /// Goes on after records of these times.
  void resume_after(const std::vector<double>& written) {
    if (!written.empty()) done(written.back());
  }

 private:
  double every_;
  double count_ = 0;
};

}  // namespace pileus::model
