// The diagnostics of a run over time, and what is asked of them.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "model/diagnostics.hpp"
#include "output/named_data.hpp"
#include "output/summary.hpp"
#include "scene/scene.hpp"

namespace pileus::model {

class Record {
 public:
  explicit Record(std::vector<DiagnosticInfo> list)
      : list_(std::move(list)), series_(list_.size()) {}

  void append(double time, const std::vector<double>& values);

  std::size_t size() const { return times_.size(); }
  const std::vector<double>& times() const { return times_; }
  const std::vector<DiagnosticInfo>& list() const { return list_; }
  const std::vector<double>& series(std::size_t diagnostic) const { return series_[diagnostic]; }

  /// Linear between records, constant beyond them.
  double at(std::size_t diagnostic, double time) const;
  /// initial, final, min, max, mean (over the records), relative_change ((final −
  /// initial)/|initial|), relative_rise ((max − initial)/|initial|), first_time_above (s, of the
  /// first record above zero); nothing for an unknown word or when there is no such record;
  /// growth_rate: slope of the straight line through the logarithms of the magnitudes (s⁻¹),
  /// nothing for fewer than three records or a zero among them; mean_deviation: the mean of
  /// |1 − v/⟨v⟩|; first_value: of the first record that is a number. Extrema and means are over the
  /// records that are numbers. `time` replaces the end of the run, `from` its beginning.
  std::optional<double> statistic(std::size_t diagnostic, const std::string& name,
                                  std::optional<double> time,
                                  std::optional<double> from = {}) const;

  std::vector<output::DiagnosticSummary> summarise() const;

  void save(output::NamedData& data) const;
  /// What was saved, up to but without `time`: a run that continues from there measures it again.
  void restore(const output::NamedData& data, double time);

 private:
  std::vector<DiagnosticInfo> list_;
  std::vector<double> times_;
  std::vector<std::vector<double>> series_;
};

/// Statistics a scene may expect bounds of.
const std::vector<std::string>& known_statistics();

/// Compares every expectation of the scene with the record; inclusive bounds.
std::vector<output::ExpectSummary> judge(const std::vector<scene::Expectation>& expect,
                                         const Record& record);

/// Throws Error (usage) naming line, found word and nearest valid one for every expectation of a
/// diagnostic or statistic that does not exist.
void check_expectations(const std::vector<scene::Expectation>& expect,
                        const std::vector<DiagnosticInfo>& list);

}  // namespace pileus::model
