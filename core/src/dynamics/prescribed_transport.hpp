// Parcels in a flow that is given: each is moved by the velocity at its centre and deformed by the
// velocity gradient there. Nothing is inverted, vorticity and buoyancy do nothing.
#pragma once
#include <memory>
#include <vector>

#include "dynamics/parcel_motion.hpp"
#include "dynamics/velocity_field.hpp"

namespace pileus::dynamics {

template <int D>
class PrescribedTransport final : public ParcelMotion<D> {
 public:
  PrescribedTransport(const mesh::Grid<D>& grid, std::unique_ptr<VelocityField<D>> velocity,
                      const LowStorageScheme& scheme, ShapeIntegrator shape,
                      ReferenceProfile reference, double aspect_limit = 100);

  /// Runs the closures and samples the flow at the nodes of the mesh, for limits of the step and
  /// for output. `store`, buoyancy and `tile_begin` have to stay valid while deposited() may be
  /// called.
  const mesh::FlowSummary& evaluate(parcels::Store& store, BuoyancySource& source,
                                    const std::vector<std::size_t>& tile_begin,
                                    const MeanWind& wind, double time, PhaseTimes& times) override;
  /// The flow does not depend on the parcels: flow() stays that of the last evaluate().
  void evaluate_velocity(const parcels::Store&, const std::vector<std::size_t>&, const MeanWind&,
                         PhaseTimes&) override {}
  /// Extrema of the flow at another time; null where it does not change. Valid until the next call.
  const mesh::FlowSummary* summary_at(double time, PhaseTimes& times);
  void begin_step(parcels::Store& store, MeanWind& wind, double dt, PhaseTimes& times) override;
  void finish_step(parcels::Store& store, BuoyancySource& source,
                   const std::vector<std::size_t>& tile_begin, MeanWind& wind, double time,
                   double dt, PhaseTimes& times) override;
  void probe(parcels::Store& store, PhaseTimes& times) override;

  /// Deposited when somebody asks for the first time since evaluate().
  const double* deposited() override;
  std::size_t allocated_bytes() const override;

 private:
  using Base = ParcelMotion<D>;
  using Base::deposit_state, Base::reserve, Base::stage_job;
  using Base::deposited_, Base::flow_, Base::summary_, Base::broken_shapes_;
  using Base::grid_, Base::scheme_;

  /// One thread's positions and samples of up to `room` points.
  struct Scratch {
    explicit Scratch(std::size_t room);
    std::size_t room;
    AlignedArray<double> memory;
    std::array<double*, D> position;
    FlowSamples<D> samples;
  };

  void match_threads();
  void stage(parcels::Store& store, std::size_t s, double time, double dt, bool evaluate_only,
             PhaseTimes& times);
  mesh::FlowSummary sample_nodes(double time, bool keep);
  void sample_column(double time, std::size_t column, bool keep, Scratch& scratch);

  std::unique_ptr<VelocityField<D>> velocity_;
  std::vector<Scratch> scratch_;  // per thread
  std::vector<mesh::FlowSummary> column_summary_;
  mesh::FlowSummary ahead_;  // of summary_at()
  bool nodes_are_sampled_ = false;
  double time_ = 0;  // of evaluate()
  parcels::Store* store_ = nullptr;
  const double* buoyancy_ = nullptr;
  const std::vector<std::size_t>* tile_begin_ = nullptr;
  bool is_deposited_ = false;
};

}  // namespace pileus::dynamics
