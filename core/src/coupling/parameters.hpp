// From the raw values of a scene's operator block to the values a plugin receives.
#pragma once
#include <vector>

#include "host/parameter_values.hpp"
#include "scene/parameters.hpp"
#include "scene/problems.hpp"
#include "scene/scene.hpp"

namespace pileus::coupling {

/// A plugin's parameters as the scene layer validates and documents them.
std::vector<scene::ParameterDeclaration> declared_parameters(const host::OperatorTable& table);

/// Checks an operator's block against the declarations and converts it; every mistake is added to
/// `problems` with its place, and what is wrong keeps its default.
host::ParameterValues read_parameters(const scene::OperatorBlock& block,
                                      const host::OperatorTable& table, const scene::Scene& scene,
                                      scene::Problems& problems);

}  // namespace pileus::coupling
