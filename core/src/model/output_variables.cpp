#include "model/output_variables.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.hpp"
#include "base/nearest_word.hpp"
#include "base/quantities.hpp"

namespace pileus::model {

output::Variable described(output::Variable variable) {
  if (const Quantity* q = find_quantity(variable.name)) {
    variable.long_name = std::string(q->definition);
    variable.standard_name = std::string(q->standard_name);
  }
  return variable;
}

std::string standard_name_of(const std::string& name) {
  const Quantity* q = find_quantity(name);
  return q != nullptr ? std::string(q->standard_name) : std::string();
}

std::vector<output::Variable> choose(const std::vector<std::string>& wanted,
                                     const std::vector<output::Variable>& existing,
                                     const std::string& stream) {
  std::vector<output::Variable> chosen;
  std::vector<std::string> names;
  for (const auto& variable : existing) names.push_back(variable.name);
  if (wanted.empty()) {
    for (const auto& variable : existing) chosen.push_back(described(variable));
    return chosen;
  }
  for (const std::string& name : wanted) {
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) {
      const std::string nearest = nearest_word(name, names);
      throw Error(ExitCode::usage,
                  fmt::format("output.{}: there is no variable '{}' in this run; {}.", stream, name,
                              nearest.empty() ? fmt::format("it has {}", fmt::join(names, ", "))
                                              : fmt::format("did you mean '{}'?", nearest)));
    }
    chosen.push_back(described(existing[static_cast<std::size_t>(found - names.begin())]));
  }
  return chosen;
}

std::vector<std::string> names_of(const std::vector<output::Variable>& variables) {
  std::vector<std::string> names;
  for (const output::Variable& variable : variables) names.push_back(variable.name);
  return names;
}

}  // namespace pileus::model
