// One pass over the initial state: between which values every quantity starts.
#pragma once
#include <map>
#include <string>

#include "scene/scene.hpp"

namespace pileus::planner {

struct Extrema {
  double low = 0, high = 0;
  bool exact = true;  // false: the parcels start elsewhere than where the field was sampled
  scene::Location where;
};

/// Extrema over the parcels of every scalar the scene's initial state sets, in the field's units.
///
/// Parcels on the regular lattice start with exactly the sampled values. Scattered ones
/// (parcels.jitter) are moved before they get their values: then the extrema are an estimate.
///
/// Errors  Error(ExitCode::usage) for a field that is not finite somewhere
std::map<std::string, Extrema> survey_initial_state(const scene::Scene& scene);

}  // namespace pileus::planner
