// Costs of a scene's parts on this machine, from a few steps of the scene itself.
#pragma once
#include <string>
#include <vector>

#include "base/progress.hpp"

namespace pileus::model {

/// Steps taken to measure: the first warms up caches and is cheap beside the rest.
inline constexpr int measured_steps = 5;

/// Runs the first steps of a scene without output, in a folder that is removed again, and enters
/// what its parts cost into the file of Costs::default_path().
///
/// Errors  those of run; Error(ExitCode::file) if there is no place for the file
void measure_costs(const std::string& scene_path, const std::vector<std::string>& overrides,
                   Progress& progress);

}  // namespace pileus::model
