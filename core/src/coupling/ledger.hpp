// What the operators of a run cost, skipped and brought about.
#pragma once
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "host/services.hpp"

namespace pileus::coupling {

/// Sum with a running correction (Neumaier 1974, doi:10.1002/zamm.19740540106): the rounding error
/// does not grow with the number of terms.
class CompensatedSum {
 public:
  CompensatedSum() = default;
  CompensatedSum(double total, double correction) : total_(total), correction_(correction) {}
  void add(double term) {
    const double total = total_ + term;
    const bool larger = (total_ < 0 ? -total_ : total_) >= (term < 0 ? -term : term);
    correction_ += larger ? (total_ - total) + term : (term - total) + total_;
    total_ = total;
  }
  double value() const { return total_ + correction_; }
  double total() const { return total_; }
  double correction() const { return correction_; }

 private:
  double total_ = 0, correction_ = 0;
};

/// One budget under one operator, since the start of the run, in the budget's unit times volume.
struct OperatorBudget {
  std::string budget;
  double change = 0;  // by the operator's writes
  double source = 0;  // of it, declared as brought in from outside
  double defect() const { return change - source; }
};

struct OperatorLedger {
  std::string name, id, version;
  bool closure = false;
  std::uint64_t calls = 0;    // of hooks on blocks
  std::uint64_t parcels = 0;  // handed over, summed over calls
  // Found inactive: because nothing had changed, by the extrema of their block, by their values.
  std::uint64_t skipped_by_epoch = 0, skipped_by_bounds = 0, skipped_by_list = 0;
  std::uint64_t audited = 0;  // of the skipped, called after all to compare
  std::uint64_t retries = 0;
  std::uint64_t repairs = 0;  // reported by the plugin
  double core_seconds = 0;    // summed over threads
  std::uint64_t applied = 0;  // parcels handed to apply, and the time that took
  double apply_seconds = 0;
  std::vector<OperatorBudget> budgets;
  std::vector<host::Span> spans;  // timers of the plugin's own

  std::uint64_t skipped() const { return skipped_by_epoch + skipped_by_bounds + skipped_by_list; }
  /// Time the skipped parcels would have cost at the price of those apply was called for, s: at
  /// most what skipping saved, since an inactive parcel costs less. NaN when it was called for
  /// none.
  double seconds_saved() const {
    if (skipped() == 0) return 0;
    if (applied == 0) return std::numeric_limits<double>::quiet_NaN();
    return apply_seconds / static_cast<double>(applied) * static_cast<double>(skipped());
  }
};

/// Total of a closed sum over all parcels.
struct BudgetTotal {
  std::string budget;
  double total = 0;
};

struct Ledger {
  std::vector<OperatorLedger> operators;
  std::vector<BudgetTotal> totals;
};

}  // namespace pileus::coupling
