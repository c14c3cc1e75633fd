// From a scene and its loaded operators to the plan and the operators that stay.
#pragma once
#include <string>
#include <vector>

#include "coupling/operator_entry.hpp"
#include "planner/plan.hpp"
#include "scene/scene.hpp"

namespace pileus::model {

struct PlannedRun {
  planner::Plan plan;
  std::vector<coupling::OperatorEntry> operators;  // those present, their effects set
};

/// Judges the scene's effects and keeps the operators that are called for.
///
/// Rules are those of schemas/effects.yaml and of a file lib<name>.effects.yaml beside a plugin.
/// Errors  Error(ExitCode::usage) for effects nobody knows or provides, rules that cannot be read,
///         contradictions between the operators that stay, and values of slabs that the run has not
PlannedRun plan_run(const scene::Scene& scene, std::vector<coupling::OperatorEntry> operators);

/// Reads a scene, loads its operators and plans it.
/// Errors  as plan_run; Error(ExitCode::usage) with every mistake of the scene
planner::Plan plan_scene(const std::string& path, const std::vector<std::string>& overrides);

}  // namespace pileus::model
