// Where results come from: versions, seeds, the resolved scene.
#pragma once
#include "base/version.hpp"
#include "output/provenance.hpp"
#include "output/summary.hpp"
#include "planner/plan.hpp"
#include "scene/scene.hpp"

namespace pileus::model {

/// What every file of a run of this scene says about its origin, the plan included.
output::Provenance run_provenance(const scene::Scene& scene, const planner::Plan& plan);

/// The scene's seeds by name.
std::map<std::string, std::uint64_t> run_seeds(const scene::Scene& scene);

/// Fills in versions, commit, compiler, libraries and seeds.
void describe_origin(const scene::Scene& scene, output::Summary& summary);

}  // namespace pileus::model
