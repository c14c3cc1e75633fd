// The number of a rule's case as a function of the extrema of quantities, compiled once.
#pragma once
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "host/operator_table.hpp"
#include "host/parameter_values.hpp"
#include "pileus/reference_state.hpp"
#include "planner/rules.hpp"
#include "planner/saturation_bound.hpp"
#include "scene/formula.hpp"

namespace pileus::planner {

/// What the formulas of a case may refer to beside the extrema of quantities.
struct RuleInputs {
  std::vector<std::string> quantities;                      // "height" and those the parcels carry
  std::vector<std::pair<std::string, double>> parameters;   // of the operator, and `duration`
  std::shared_ptr<const thermo::ReferenceState> reference;  // null: there is no reference_exner
  std::optional<AirSaturation> saturation;  // nothing: there is no lowest_saturation_humidity
};

/// Inputs from an operator's parameters; without an operator only `duration`.
RuleInputs inputs_of(const host::OperatorTable* table, const host::ParameterValues* values,
                     std::vector<std::string> quantities, double duration);

/// Evaluating changes the object: one copy per thread.
class RuleNumber {
 public:
  /// Errors  Error(ExitCode::usage) naming file, line and what is wrong in a formula
  RuleNumber(const RuleCase& rule_case, RuleInputs inputs);

  /// The number for quantities between extrema[2 i] and extrema[2 i + 1].
  double operator()(const double* extrema);
  /// Whether a number calls for the effect, an allowance for rounding included; a NaN does.
  bool calls(double number) const { return !(number <= threshold_ - margin()); }
  double threshold() const { return threshold_; }

  /// Names before the formulas: lowest_Q, highest_Q of every quantity, then parameters.
  std::size_t input_count() const { return input_count_; }
  const std::string& name(std::size_t input) const { return names_[input]; }
  bool uses(std::size_t input) const { return used_[input]; }
  /// Whether either extremum of a quantity is used.
  bool uses_quantity(std::size_t quantity) const {
    return used_[2 * quantity] || used_[2 * quantity + 1];
  }
  /// Value of a name as of the last evaluation; nothing for an unknown one.
  std::optional<double> value(std::string_view name) const;
  double value(std::size_t input) const { return values_[input]; }
  void set_parameter(std::size_t input, double value) { values_[input] = value; }

 private:
  static constexpr double rounding = 1e-6;  // relative, see schemas/effects.yaml
  double margin() const { return rounding * (threshold_ < 0 ? -threshold_ : threshold_); }
  void find_used();
  void find_air(const RuleCase& rule_case);
  void fill_derived();

  RuleInputs inputs_;
  std::size_t input_count_ = 0;
  std::size_t reference_ = 0, saturation_ = 0;  // positions of derived names
  std::size_t height_ = 0, theta_ = 0;          // positions of their lowest values
  std::size_t epsilon_ = 0;
  std::vector<std::string> names_;
  std::vector<double> values_;
  std::vector<scene::Formula> formulas_;  // each fills the next name
  std::vector<bool> used_;                // per name
  double threshold_ = 0;
};

}  // namespace pileus::planner
