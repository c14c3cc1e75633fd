// Numbers that describe a state: energies, extrema, budgets, clouds.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "model/exact_comparison.hpp"
#include "model/gridded_measures.hpp"
#include "model/histogram.hpp"
#include "model/item_measures.hpp"
#include "model/potential_energy.hpp"
#include "model/simulation.hpp"
#include "model/slab_series.hpp"
#include "model/soundness.hpp"
#include "model/water_path.hpp"
#include "output/summary.hpp"
#include "scene/scene.hpp"

namespace pileus::model {

struct DiagnosticInfo {
  std::string name, units, long_name;
  /// An inviscid, adiabatic run conserves it: its relative change is an error measure.
  bool conserved = false;
};

/// Computes all diagnostics of a scene for one evaluated state. All means are over the domain's
/// volume; sums run in an order independent of the number of threads.
class Diagnostics {
 public:
  /// `surface`: of the run's operators; it has to outlive this. `changed` names the quantities that
  /// operators may change, `budgets` the totals that the run keeps books of, `slabs` the statistics
  /// of slabs, null where none are wanted; these have to outlive this, too.
  Diagnostics(const scene::Scene& scene, const Simulation& simulation,
              const coupling::SurfaceFields& surface, const std::vector<std::string>& changed,
              const std::vector<std::string>& budgets, const SlabStatistics* slabs = nullptr);

  const std::vector<DiagnosticInfo>& list() const { return list_; }
  int index(const std::string& name) const;  // −1: there is none of that name

  /// Part that depends on the evaluated state; call before begin_step().
  void observe_state(Simulation& simulation);
  /// Part that needs the parcels' velocity; call after begin_step() or probe().
  void observe_velocity(Simulation& simulation);
  /// Part that is read off the slabs; after `slabs` has measured the state.
  void observe_slabs(const Simulation& simulation);
  /// What became of the budgets, in their order at construction.
  void observe_budgets(const std::vector<output::BudgetSummary>& budgets);
  /// One value per entry of list(), of the state last observed.
  const std::vector<double>& values() const { return values_; }

  /// What later states are compared with and averaged with, for a run that continues at `time` (s).
  void save(output::NamedData& data, double time) const {
    soundness_.save(data);
    if (slab_series_) slab_series_->save(data, time);
  }
  void restore(const output::NamedData& data) {
    soundness_.restore(data);
    if (slab_series_) slab_series_->restore(data);
  }

 private:
  int add(std::string name, std::string units, std::string long_name, bool conserved = false);
  void set(int index, double value) {
    if (index >= 0) values_[static_cast<std::size_t>(index)] = value;
  }
  void observe_parcels(Simulation& simulation);
  void observe_scalars(const Simulation& simulation);
  void observe_cloud(const Simulation& simulation);
  void observe_surface();
  void add_scalars(const parcels::Store& store);
  void add_water(const scene::Scene& scene, const Simulation& simulation);
  void add_gridded_measures(const scene::Scene& scene, const Simulation& simulation);
  void observe_gridded_measures(Simulation& simulation);
  void add_slab_series();

  struct ModeEntries {
    Mode mode;
    std::vector<int> entries;
  };
  struct ScalarEntries {
    int scalar, mean, low, high;
    bool water = false;  // part of the budget of that name
  };
  struct SurfaceEntries {
    int mean, high;
  };

  std::vector<DiagnosticInfo> list_;
  std::vector<double> values_;
  PotentialEnergy potential_energy_;
  Soundness soundness_;
  std::vector<int> soundness_entries_;
  ItemMeasures item_measures_;
  std::vector<int> item_entries_;
  std::vector<ExactComparison> exact_;
  std::vector<std::vector<int>> exact_entries_;
  std::vector<ModeEntries> modes_;
  std::vector<std::pair<scene::FrontControl, int>> fronts_;
  std::vector<std::pair<scene::MirrorControl, int>> mirrors_;
  NodeField field_;
  std::vector<Histogram> histograms_;
  std::vector<std::vector<int>> histogram_entries_;
  std::vector<int> variance_entries_;
  std::vector<ScalarEntries> scalars_;
  std::optional<SlabSeries> slab_series_;
  std::vector<int> slab_entries_;
  const coupling::SurfaceFields& surface_;
  std::vector<SurfaceEntries> surface_entries_;
  std::vector<int> budget_entries_;
  std::optional<WaterPath> water_path_;  // of moist scenes
  double cloud_threshold_;
  int liquid_scalar_ = -1, water_scalar_ = -1, rain_scalar_ = -1;
  int kinetic_, grid_kinetic_, potential_, available_, total_, mechanical_, enstrophy_, volume_,
      mean_buoyancy_, min_buoyancy_, max_buoyancy_, max_speed_, max_vertical_velocity_,
      min_vertical_velocity_, max_vorticity_, volume_error_rms_, volume_error_max_, parcels_;
  std::vector<int> mean_wind_, mean_vorticity_;
  int total_water_ = -1, mean_liquid_ = -1, max_liquid_ = -1, cloud_fraction_ = -1,
      cloud_mean_liquid_ = -1, cloud_liquid_deviation_ = -1, cloud_mean_water_ = -1,
      cloud_water_deviation_ = -1, liquid_path_ = -1, rain_path_ = -1;
};

}  // namespace pileus::model
