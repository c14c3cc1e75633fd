// The mean of arrays over samples, which a run that was interrupted continues to the bit.
#pragma once
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "output/named_data.hpp"

namespace pileus::model {

/// A checkpoint precedes what is measured of its own state, and the last one of a run follows it;
/// so the mean remembers what it was before its latest time, and saves that if this is the time.
class RunningMean {
 public:
  void add(double time, std::span<const double> sample);
  /// Begins anew after a record of `time`.
  void clear(double time);

  std::uint64_t samples() const { return now_.samples; }
  /// Time of the latest sample or clear(), s; −infinity before.
  double latest() const { return now_.latest; }
  /// Of at least one sample; of a single one that sample, to the bit.
  void mean(std::vector<double>& result) const;

  /// What a run that continues at `time` (s) has to know.
  void save(output::NamedData& data, const std::string& name, double time) const;
  /// Without such an array, or with one of another size than `size`, the mean begins here.
  void restore(const output::NamedData& data, const std::string& name, std::size_t size);

 private:
  struct State {
    std::vector<double> sum;
    std::uint64_t samples = 0;
    double latest = -std::numeric_limits<double>::infinity();
  };
  void go_to(double time);

  State now_, before_;
};

}  // namespace pileus::model
