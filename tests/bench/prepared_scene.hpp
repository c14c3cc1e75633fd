// A scene made ready for stepping without the loop, its outputs and its checkpoints.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "coupling/operator_entry.hpp"
#include "coupling/operator_sequence.hpp"
#include "host/search.hpp"
#include "model/operator_physics.hpp"
#include "model/plan_run.hpp"
#include "model/simulation.hpp"
#include "planner/tripwire.hpp"
#include "scene/read_scene.hpp"

namespace pileus::bench {

/// The scene of a file with overrides (key=value), its operators, and a simulation at its initial
/// state with the flow evaluated. Throws Error as a run of the scene would.
class PreparedScene {
 public:
  PreparedScene(const std::string& path, const std::vector<std::string>& overrides)
      : scene_(read(path, overrides)),
        planned_(model::plan_run(scene_, load(path))),
        sequence_(std::move(planned_.operators), options()),
        physics_(sequence_, planner::Tripwires(planned_.plan)),
        simulation_(model::make_simulation(scene_, sequence_.required_scalars(), physics_,
                                           sequence_.required_items())) {
    sequence_.bind(simulation_->store(), simulation_->plugin_grid(), &simulation_->mesh_access());
    simulation_->initialise(scene_);
    sequence_.init({0, 0.0, 0.0});
    simulation_->evaluate();
  }

  const coupling::OperatorSequence& sequence() const { return sequence_; }
  const scene::Scene& scene() const { return scene_; }
  model::Simulation& simulation() { return *simulation_; }

 private:
  static scene::Scene read(const std::string& path, const std::vector<std::string>& overrides) {
    scene::Problems problems;
    scene::Scene scene = scene::read_scene(path, overrides, problems);
    problems.throw_if_any();
    return scene;
  }
  std::vector<coupling::OperatorEntry> load(const std::string& path) const {
    scene::Problems problems;
    auto operators = coupling::load_operators(
        scene_, host::default_search_path(std::filesystem::path(path).parent_path()), problems);
    problems.throw_if_any();
    return operators;
  }
  coupling::SequenceOptions options() const {
    coupling::SequenceOptions options;
    options.coupling = scene_.coupling;
    options.seed = scene_.seed;
    for (const auto& [name, field] : scene_.initial.scalars) options.initial.push_back(name);
    return options;
  }

  scene::Scene scene_;
  model::PlannedRun planned_;
  coupling::OperatorSequence sequence_;
  model::OperatorPhysics physics_;
  std::unique_ptr<model::Simulation> simulation_;
};

}  // namespace pileus::bench
