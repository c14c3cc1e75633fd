// Available potential energy in the form the scene chooses.
#pragma once
#include <memory>
#include <vector>

#include "model/simulation.hpp"
#include "scene/formula.hpp"
#include "scene/scene.hpp"

namespace pileus::model {

class PotentialEnergy {
 public:
  explicit PotentialEnergy(const scene::Scene& scene);

  /// Domain mean of the available potential energy of the evaluated state (m² s⁻²):
  /// linear: (b − N² z)²/(2 N²); formula: the scene's function of b and z; otherwise potential
  /// energy less that of the same parcels stacked by buoyancy.
  double available(const Simulation& simulation);

 private:
  double density_mean(const Simulation& simulation);
  double above_sorted(const Simulation& simulation);

  scene::EnergyControl control_;
  std::vector<scene::Formula> formula_;              // one per thread: evaluating changes a formula
  std::vector<double> layer_volume_, layer_height_;  // of the sorted state
};

}  // namespace pileus::model
