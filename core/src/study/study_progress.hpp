// Progress of a study on a terminal: which run of how many, and when all will be done.
#pragma once
#include <chrono>
#include <ostream>
#include <string>
#include <vector>

#include "study/duration_model.hpp"
#include "study/points.hpp"

namespace pileus::study {

class StudyProgress {
 public:
  struct Options {
    bool quiet = false, interactive = false;
    std::size_t width = 80;
  };
  StudyProgress(std::ostream& out, Options options, const Layout& layout)
      : out_(out), options_(options), layout_(layout), model_(layout.knobs.size()) {}

  /// A run to come.
  void plan(std::size_t point) { waiting_.push_back(point); }
  /// A run that an earlier call finished; it teaches how long others take.
  void already_done(std::size_t point, double seconds);
  void begin(std::size_t point);
  /// The run that was begun has covered this share of its way.
  void update(double share);
  void end(const std::string& outcome, double seconds);
  void message(const std::string& text);

 private:
  std::vector<double> position(std::size_t point) const;
  /// Seconds until all runs are done; negative when unknown.
  double remaining(double share) const;
  void clear();

  std::ostream& out_;
  Options options_;
  const Layout& layout_;
  DurationModel model_;
  std::vector<std::size_t> waiting_;  // the one that runs first
  std::size_t done_ = 0, total_ = 0, drawn_ = 0;
  std::chrono::steady_clock::time_point begun_;
};

}  // namespace pileus::study
