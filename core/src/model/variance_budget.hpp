// Where the variance of carried quantities goes: what operators mix away, and what merging does.
#pragma once
#include <string>
#include <vector>

#include "output/checkpoint.hpp"
#include "parcels/store.hpp"
#include "scene/scene.hpp"

namespace pileus::model {

/// Parcels carry their values unchanged through transport, splits and the volume correction, so the
/// variance of a quantity over the domain changes in two places only, and the budget
///
///   variance(0) = variance(t) + lost to operators + lost to mergers
///
/// is closed to rounding. What operators add counts as a negative loss.
class VarianceBudget {
 public:
  enum class Sink { operators, mergers };

  /// Throws Error (usage) for a quantity that parcels do not carry.
  VarianceBudget(const std::vector<scene::VarianceBudgetControl>& quantities,
                 const parcels::Store& store, double domain_volume);

  /// Name, unit and description of the three measures of each quantity.
  std::vector<std::array<std::string, 3>> outputs() const;
  /// Their values: the variance of the present state and what has been lost so far.
  std::vector<double> measure(const parcels::Store& store) const;

  /// Books the variance that has gone since the last call, or since the first, which only looks.
  void book(const parcels::Store& store, Sink sink);
  bool empty() const { return entries_.empty(); }
  /// Whether every quantity has been looked at once.
  bool started() const;

  void save(output::NamedData& data) const;
  void restore(const output::NamedData& data);

 private:
  struct Entry {
    int scalar;
    std::string name;
    bool started = false;
    double centre = 0;  // the first mean: variances are taken about a value near the mean
    double last = 0;    // variance when it was last looked at
    double lost[2] = {0, 0};
  };
  double variance(const parcels::Store& store, const Entry& entry) const;

  std::vector<Entry> entries_;
  double domain_volume_;
  std::vector<std::array<std::string, 3>> outputs_;
};

}  // namespace pileus::model
