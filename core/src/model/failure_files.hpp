// What a failed run leaves behind for whoever looks into it.
#pragma once
#include <filesystem>
#include <string>

#include "base/error.hpp"
#include "model/simulation.hpp"

namespace pileus::model {

/// Writes failure-<operator>-<step>.h5 for a failed operator (the inputs of its call), else
/// failure-state-<step>.h5 (all parcels), into `folder`; returns the path.
std::string write_failure(const std::filesystem::path& folder, const Error& error,
                          const Simulation& simulation, const std::string& scene);

}  // namespace pileus::model
