// One run's state and how it advances by a step; knows nothing of files or of the clock on the
// wall.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "base/phase_timer.hpp"
#include "coupling/operator_sequence.hpp"
#include "dynamics/parcel_motion.hpp"
#include "dynamics/time_step.hpp"
#include "mesh/grid.hpp"
#include "model/variance_budget.hpp"
#include "output/checkpoint.hpp"
#include "output/netcdf_form.hpp"
#include "parcels/correction.hpp"
#include "parcels/store.hpp"
#include "parcels/upkeep.hpp"
#include "scene/scene.hpp"

namespace pileus::model {

/// What happens to the parcels besides transport: the planned operators.
class Physics : public dynamics::BuoyancySource {
 public:
  /// The buoyancy within a step, where nothing but the flow will be looked at.
  virtual const double* buoyancy_of_stage(parcels::Store& store, double time) = 0;
  /// Operators before the stages of step number `step` of length `dt` from `time`; whether any ran.
  virtual bool apply_before(parcels::Store& store, double time, double dt, std::uint64_t step) = 0;
  /// Operators after the stages.
  virtual void apply_after(parcels::Store& store, double time, double dt, std::uint64_t step) = 0;
  /// Parcels were merged, split and reordered.
  virtual void population_changed() = 0;
  /// Whether an operator may turn air at the ground about the vertical, as uneven drag does.
  virtual bool turns_air_at_the_ground() const = 0;
  /// Largest step the operators allow (s), infinity when they do not care.
  virtual double largest_step() = 0;
};

/// What a finished step did.
struct StepReport {
  double dt = 0;
  parcels::UpkeepCounts upkeep;
};

/// Dimension-blind face of a simulation. The cycle is: evaluate(); begin_step(until);
/// finish_step(); evaluate(); … where evaluate() gives the flow of the present state, and
/// velocity() is valid between begin_step() (or probe()) and finish_step().
class Simulation {
 public:
  virtual ~Simulation() = default;

  /// Places the parcels and gives them the scene's initial fields.
  virtual void initialise(const scene::Scene& scene) = 0;
  /// Everything beside the store's columns that the continuation depends on.
  virtual void save(output::NamedData& data) const = 0;
  /// After the store has been read: takes up where save() left.
  virtual void restore(const output::NamedData& data) = 0;

  /// Flow of the present state. Throws Error (numerical) when the state is no longer finite.
  virtual void evaluate() = 0;
  /// The step the flow and the operators allow; after evaluate().
  virtual dynamics::TimeStep allowed_step() = 0;
  /// Takes the first stage of the step that ends at `until` (s).
  virtual void begin_step(double until) = 0;
  virtual StepReport finish_step() = 0;
  virtual void probe() = 0;

  /// Velocity component of every parcel at the evaluated state (m s⁻¹).
  virtual const double* velocity(int direction) const = 0;
  /// Buoyancy of every parcel at the evaluated state (m s⁻²).
  virtual const double* buoyancy() const = 0;
  virtual double reference_buoyancy(double z) const = 0;
  virtual const mesh::FlowSummary& flow_summary() const = 0;

  virtual int dimension() const = 0;
  virtual double domain_volume() const = 0;
  virtual double cell_volume() const = 0;
  virtual double bottom() const = 0;  // m
  virtual double height() const = 0;  // m
  /// The mesh as plugins see it.
  virtual pileus_grid plugin_grid() const = 0;
  /// The mesh as operators use it; between finish_step's stages and evaluate().
  virtual coupling::MeshAccess& mesh_access() = 0;
  virtual std::vector<output::Axis> axes() const = 0;
  virtual std::vector<output::Axis> ground_axes() const = 0;
  /// Nodes in file order (z slowest, x fastest): horizontal count times n_z + 1.
  virtual std::size_t node_count() const = 0;
  /// Gridded fields of the evaluated state in file order: "volume", velocity and vorticity
  /// components, "buoyancy", or the volume-weighted mean of any scalar of the store. Several at
  /// once need fewer passes over the parcels.
  virtual void grid(const std::vector<std::string>& names,
                    std::vector<std::vector<double>>& values) = 0;
  /// One of them.
  void grid_field(const std::string& name, std::vector<double>& values) {
    std::vector<std::vector<double>> one(1);
    one.front().swap(values);
    grid({name}, one);
    values.swap(one.front());
  }
  /// Names grid() knows.
  virtual std::vector<output::Variable> grid_fields() const = 0;
  /// Volume fraction error of the evaluated state, over all nodes.
  virtual parcels::VolumeError volume_error() const = 0;
  /// Sum over the nodes with the quadrature's weights (half at walls) of volume × value², halved
  /// and divided by the domain volume: kinetic energy on the grid.
  virtual double grid_kinetic_energy() const = 0;
  virtual std::size_t allocated_bytes() const = 0;
  virtual std::size_t broken_shapes() const = 0;

  parcels::Store& store() { return *store_; }
  const parcels::Store& store() const { return *store_; }
  double time() const { return time_; }
  std::uint64_t step() const { return step_; }
  double last_dt() const { return dt_; }
  const dynamics::MeanWind& mean_wind() const { return wind_; }
  const VarianceBudget& variance_budget() const { return *variance_budget_; }
  PhaseTimes& times() { return times_; }
  void set_clock(double time, std::uint64_t step, double dt) {
    time_ = time;
    step_ = step;
    dt_ = dt;
  }

 protected:
  std::unique_ptr<parcels::Store> store_;
  std::unique_ptr<VarianceBudget> variance_budget_;
  double time_ = 0, dt_ = 0, until_ = 0;
  std::uint64_t step_ = 0;
  dynamics::MeanWind wind_;
  PhaseTimes times_;
};

/// A simulation of the scene's dimension with the given parcel scalars, items and physics, still
/// empty. `physics` must outlive it.
std::unique_ptr<Simulation> make_simulation(const scene::Scene& scene,
                                            std::vector<parcels::Scalar> scalars, Physics& physics,
                                            parcels::ItemDeclaration items = {});

}  // namespace pileus::model
