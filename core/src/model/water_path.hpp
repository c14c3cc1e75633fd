// Water above the ground per area: what the scene calls a column, weighted by its density.
#pragma once
#include <vector>

#include "dynamics/reference_profile.hpp"
#include "model/simulation.hpp"
#include "scene/scene.hpp"

namespace pileus::model {

/// (1/A) Σ V ρ(z) q over the parcels whose centre lies between two heights, A the horizontal area
/// of the domain (in two dimensions its width): kg m⁻² for a mass fraction q.
class WaterPath {
 public:
  /// Tabulates the density. Throws Error (usage) if it is not a function of z alone.
  WaterPath(const scene::Scene& scene, const Simulation& simulation);

  /// `quantity`: one mass fraction per parcel of the store.
  double measure(const Simulation& simulation, const double* quantity) const;

 private:
  dynamics::ReferenceProfile density_;  // kg m-3
  double bottom_, top_;                 // m
};

}  // namespace pileus::model
