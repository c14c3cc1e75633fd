#include "planner/rule_number.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "base/error.hpp"
#include "scene/problems.hpp"

namespace pileus::planner {
namespace {

constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

/// The hydrostatic state an operator's parameters describe, if it has all of them.
std::shared_ptr<const thermo::ReferenceState> reference_of(const host::OperatorTable& table,
                                                           const host::ParameterValues& values) {
  const auto number = [&](const char* name) -> std::optional<double> {
    const int index = table.find_parameter(name);
    if (index < 0) return std::nullopt;
    return values.numbers()[index];
  };
  const int heights = table.find_parameter("reference_height");
  const int theta = table.find_parameter("reference_potential_temperature");
  const auto gravity = number("gravity"), gas = number("gas_constant_dry_air"),
             heat = number("heat_capacity"), pressure = number("surface_pressure"),
             base = number("base_height");
  if (heights < 0 || theta < 0 || !gravity || !gas || !heat || !pressure || !base) return nullptr;
  const std::vector<double>& z = values.list(heights);
  if (z.empty() || z.size() != values.list(theta).size() ||
      std::adjacent_find(z.begin(), z.end(), std::greater_equal<>()) != z.end())
    return nullptr;  // the plugin refuses such a profile
  thermo::Constants constants;
  constants.gravity = *gravity;
  constants.gas_constant_dry_air = *gas;
  constants.heat_capacity = *heat;
  return std::make_shared<const thermo::ReferenceState>(z, values.list(theta), *base, *pressure,
                                                        constants);
}

}  // namespace

RuleInputs inputs_of(const host::OperatorTable* table, const host::ParameterValues* values,
                     std::vector<std::string> quantities, double duration) {
  RuleInputs inputs;
  inputs.quantities = std::move(quantities);
  inputs.parameters.emplace_back("duration", duration);
  if (table == nullptr) return inputs;
  for (std::size_t i = 0; i < table->parameters.size(); ++i) {
    const pileus_parameter& p = table->parameters[i];
    const bool taken = p.type != PILEUS_NUMBER && p.type != PILEUS_INTEGER;
    if (!taken && scene::is_free_name(p.name) && std::string_view(p.name) != "duration")
      inputs.parameters.emplace_back(p.name, values->numbers()[i]);
  }
  inputs.reference = reference_of(*table, *values);
  if (inputs.reference) inputs.saturation = saturation_of(*table, *values);
  return inputs;
}

RuleNumber::RuleNumber(const RuleCase& rule_case, RuleInputs inputs)
    : inputs_(std::move(inputs)), threshold_(rule_case.threshold) {
  for (const std::string& quantity : inputs_.quantities) {
    names_.push_back("lowest_" + quantity);
    names_.push_back("highest_" + quantity);
  }
  values_.assign(names_.size(), 0.0);
  for (const auto& [name, value] : inputs_.parameters) {
    names_.push_back(name);
    values_.push_back(value);
  }
  input_count_ = names_.size();
  find_air(rule_case);
  const auto compile = [&](const RuleFormula& formula) {
    try {
      formulas_.emplace_back(formula.text, names_, std::map<std::string, double>{});
    } catch (const scene::FormulaProblem& problem) {
      throw Error(ExitCode::usage,
                  fmt::format("{}: error: {}", scene::describe(formula.where), problem.text));
    }
    names_.push_back(formula.name);
  };
  for (const RuleFormula& formula : rule_case.let) compile(formula);
  compile(rule_case.number);
  values_.resize(names_.size(), 0.0);
  find_used();
}

/// The names that follow from a reference state: which there are, and what they follow from.
void RuleNumber::find_air(const RuleCase& rule_case) {
  const auto position = [&](const std::string& name) {
    return static_cast<std::size_t>(std::find(names_.begin(), names_.end(), name) - names_.begin());
  };
  reference_ = saturation_ = none;
  if (!inputs_.reference) return;
  height_ = position("lowest_height");
  theta_ = position("lowest_" + rule_case.potential_temperature);
  epsilon_ = position("epsilon");
  reference_ = names_.size();
  names_.emplace_back("reference_exner");
  if (!inputs_.saturation || std::max(theta_, epsilon_) >= input_count_) return;
  saturation_ = names_.size();
  names_.emplace_back("lowest_saturation_humidity");
}

/// From the end backwards, since a formula uses only names before its own.
void RuleNumber::find_used() {
  used_.assign(names_.size(), false);
  used_.back() = true;
  for (std::size_t f = formulas_.size(); f-- > 0;) {
    const std::size_t own = names_.size() - formulas_.size() + f;
    for (std::size_t n = 0; used_[own] && n < own; ++n)
      if (formulas_[f].uses(n)) used_[n] = true;
  }
  if (saturation_ != none && used_[saturation_]) {
    used_[reference_] = true;
    for (const std::size_t n : {height_, height_ + 1, theta_, theta_ + 1, epsilon_})
      used_[n] = true;
  }
  if (reference_ != none && used_[reference_]) used_[height_ + 1] = true;
}

void RuleNumber::fill_derived() {
  if (reference_ == none) return;
  const Interval exner{inputs_.reference->at(values_[height_ + 1]).exner,
                       inputs_.reference->at(values_[height_]).exner};
  values_[reference_] = exner.low;
  if (saturation_ == none || !used_[saturation_]) return;
  values_[saturation_] = lowest_saturation_humidity(*inputs_.saturation, values_[epsilon_], exner,
                                                    {values_[theta_], values_[theta_ + 1]});
}

double RuleNumber::operator()(const double* extrema) {
  std::copy_n(extrema, 2 * inputs_.quantities.size(), values_.begin());
  fill_derived();
  for (std::size_t f = 0; f < formulas_.size(); ++f)
    values_[names_.size() - formulas_.size() + f] = formulas_[f](values_.data());
  return values_.back();
}

std::optional<double> RuleNumber::value(std::string_view name) const {
  const auto found = std::find(names_.begin(), names_.end(), name);
  if (found == names_.end()) return std::nullopt;
  return values_[static_cast<std::size_t>(found - names_.begin())];
}

}  // namespace pileus::planner
