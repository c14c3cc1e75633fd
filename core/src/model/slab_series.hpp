// Numbers over time that are read off the slabs: inversion, entrainment, clouds, turbulence, and
// what a scene asks of a profile.
#pragma once
#include <array>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "coupling/surface_fields.hpp"
#include "dynamics/reference_profile.hpp"
#include "model/running_mean.hpp"
#include "model/slab_statistics.hpp"
#include "output/named_data.hpp"
#include "scene/scene.hpp"

namespace pileus::model {

class SlabSeries {
 public:
  /// `surface` and `slabs` have to outlive this. Throws Error (usage) with line and nearest word
  /// for a variable that no slab profile of this run has.
  SlabSeries(const scene::Scene& scene, const Simulation& simulation,
             const coupling::SurfaceFields& surface, const SlabStatistics& slabs);

  /// The same refusals before there is a simulation: of what a scene asks of profiles that parcels
  /// with the quantities of `store` do not have, or of heights where there are no levels.
  static void check(const scene::Scene& scene, const parcels::Store& store);
  /// Throws Error (usage) with the line of a slab value whose name another diagnostic has.
  void refuse_taken(const std::function<bool(const std::string& name)>& is_taken) const;

  /// Name, units, long name.
  const std::vector<std::array<std::string, 3>>& outputs() const { return outputs_; }
  /// Of the state `slabs` has measured last, which is that of the simulation.
  std::vector<double> observe(const Simulation& simulation);

  /// What a run that continues at `time` (s) has to know.
  void save(output::NamedData& data, double time) const;
  void restore(const output::NamedData& data);

 private:
  struct Asked {
    scene::SlabValueControl control;
    int profile;
    double low, high;  // m
  };

  void list_flow();
  void list_cloud();
  void list_asked(const scene::Scene& scene);
  static Asked asked(const scene::SlabValueControl& control, const scene::Domain& domain,
                     const SlabStatistics& slabs);
  void observe_flow(std::vector<double>& values);
  void observe_cloud(const Simulation& simulation, std::vector<double>& values);
  void observe_asked(double time, std::vector<double>& values);
  double largest(const char* name);
  double turbulent_kinetic_energy();
  double mean_surface_flux() const;

  const coupling::SurfaceFields& surface_;
  const SlabStatistics& slabs_;
  dynamics::ReferenceProfile density_;  // kg m-3
  double bottom_;                       // m
  int surface_flux_, buoyancy_flux_, heat_;
  std::vector<std::array<std::string, 3>> outputs_;
  std::vector<Asked> asked_;
  std::map<double, RunningMean> means_;  // by the time from which they run
  std::vector<double> profile_, moments_;
};

}  // namespace pileus::model
