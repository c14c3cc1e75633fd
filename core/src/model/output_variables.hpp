// Which variables a stream writes, and what is known of them.
#pragma once
#include <string>
#include <vector>

#include "output/netcdf_form.hpp"

namespace pileus::model {

/// Fills in what the register of quantities knows about a variable.
output::Variable described(output::Variable variable);
std::string standard_name_of(const std::string& name);

/// The wanted variables out of those that exist, in the wanted order; all when none is named.
/// Throws Error (usage) for one that does not exist, with the nearest that does.
std::vector<output::Variable> choose(const std::vector<std::string>& wanted,
                                     const std::vector<output::Variable>& existing,
                                     const std::string& stream);

std::vector<std::string> names_of(const std::vector<output::Variable>& variables);

}  // namespace pileus::model
