// How long the runs to come will take, from those that are done.
#pragma once
#include <optional>
#include <vector>

namespace pileus::study {

/// ln(duration) as a linear function of the knobs' positions, fitted by ridge regression: with few
/// runs it stays near their mean, with more it follows the powers by which each knob costs time.
class DurationModel {
 public:
  explicit DurationModel(std::size_t knobs) : knobs_(knobs) {}

  /// A finished run at these positions (logarithms of the knobs' numbers, or places on ladders).
  void learn(const std::vector<double>& position, double seconds);
  /// Expected duration in s; nothing before the first run is done.
  std::optional<double> predict(const std::vector<double>& position) const;

 private:
  void fit();

  std::size_t knobs_;
  std::vector<std::vector<double>> positions_;
  std::vector<double> logarithms_;
  std::vector<double> centre_, slopes_;
  double mean_ = 0;
};

}  // namespace pileus::study
