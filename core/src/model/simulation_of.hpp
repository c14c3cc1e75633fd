// The simulation of one dimension: composes mesh, parcels and dynamics into a step.
#pragma once
#include <memory>

#include "dynamics/prescribed_transport.hpp"
#include "model/gridded_fields.hpp"
#include "model/mesh_access_of.hpp"
#include "model/simulation.hpp"

namespace pileus::model {

template <int D>
class SimulationOf final : public Simulation {
 public:
  SimulationOf(const scene::Scene& scene, std::vector<parcels::Scalar> scalars, Physics& physics,
               parcels::ItemDeclaration items);

  void initialise(const scene::Scene& scene) override;
  void save(output::NamedData& data) const override;
  void restore(const output::NamedData& data) override;

  void evaluate() override;
  dynamics::TimeStep allowed_step() override;
  void begin_step(double until) override;
  StepReport finish_step() override;
  void probe() override { transport_->probe(*store_, times_); }

  const double* velocity(int direction) const override { return transport_->velocity(direction); }
  const double* buoyancy() const override { return buoyancy_.last; }
  double reference_buoyancy(double z) const override { return transport_->reference()(z); }
  const mesh::FlowSummary& flow_summary() const override { return flow_summary_; }

  int dimension() const override { return D; }
  double domain_volume() const override { return grid_.domain_volume(); }
  double cell_volume() const override { return grid_.cell_volume(); }
  double bottom() const override { return grid_.bottom(); }
  double height() const override { return grid_.extent[D - 1]; }
  pileus_grid plugin_grid() const override { return coupling::abi_grid(grid_); }
  coupling::MeshAccess& mesh_access() override { return *mesh_access_; }
  std::vector<output::Axis> axes() const override;
  std::vector<output::Axis> ground_axes() const override;
  std::size_t node_count() const override {
    return grid_.columns() * static_cast<std::size_t>(grid_.nz() + 1);
  }
  void grid(const std::vector<std::string>& names,
            std::vector<std::vector<double>>& values) override {
    gridded().grid(names, values);
  }
  std::vector<output::Variable> grid_fields() const override { return gridded().list(); }
  parcels::VolumeError volume_error() const override;
  double grid_kinetic_energy() const override;
  std::size_t allocated_bytes() const override;
  std::size_t broken_shapes() const override {
    return broken_before_ + transport_->broken_shapes();
  }

 private:
  /// Remembers the buoyancy the transport last saw, for diagnostics of the evaluated state.
  struct TracedBuoyancy final : dynamics::BuoyancySource {
    explicit TracedBuoyancy(Physics& p) : physics(p) {}
    const double* buoyancy(parcels::Store& store, double time) override {
      return last = within_a_step ? physics.buoyancy_of_stage(store, time)
                                  : physics.buoyancy(store, time);
    }
    Physics& physics;
    bool within_a_step = false;
    const double* last = nullptr;
  };

  void build_transport(std::array<bool, 2> zero_wall_vorticity);
  std::unique_ptr<dynamics::ParcelMotion<D>> induced_transport() const;
  std::unique_ptr<dynamics::PrescribedTransport<D>> prescribed_transport() const;
  void warn_of_divergence() const;
  double aspect_limit() const;
  std::array<bool, 2> walls_without_vorticity() const;
  GriddedFields<D> gridded() const;
  void place_parcels(const scene::Scene& scene);
  dynamics::TimeStep step_allowed_by_flow();
  void require_finite() const;
  void account_for_variance(VarianceBudget::Sink sink);
  std::vector<double> corners() const;

  mesh::Grid<D> grid_;
  scene::Scene scene_;
  dynamics::TimeStepControl step_control_;
  dynamics::ReferenceProfile reference_;
  TracedBuoyancy buoyancy_;
  std::array<bool, 2> zero_wall_vorticity_{false, false};
  std::unique_ptr<dynamics::ParcelMotion<D>> transport_;
  dynamics::PrescribedTransport<D>* given_ = nullptr;  // the same, where the flow is prescribed
  parcels::Tiling<D> tiling_;
  parcels::Upkeep<D> upkeep_;
  parcels::VolumeCorrection<D> correction_;
  std::vector<std::size_t> tile_begin_;
  std::unique_ptr<MeshAccessOf<D>> mesh_access_;
  std::size_t broken_before_ = 0;  // shapes, until the run was last interrupted
  mesh::FlowSummary flow_summary_;
  dynamics::TimeStep allowed_{0, ""};
};

}  // namespace pileus::model
