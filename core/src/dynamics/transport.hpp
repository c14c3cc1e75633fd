// What the core integrates itself: position, vorticity and shape of the parcels in the flow they
// induce.
#pragma once
#include <array>
#include <vector>

#include "dynamics/parcel_motion.hpp"
#include "mesh/flow_solver.hpp"
#include "mesh/sharpening.hpp"

namespace pileus::dynamics {

template <int D>
class Transport final : public ParcelMotion<D> {
 public:
  /// `sharpening` is the strength β of mesh::Sharpening, 0 for none. A parcel that a step makes
  /// longer than `aspect_limit` times its width is blunted to that.
  Transport(const mesh::Grid<D>& grid, const mesh::FlowOptions& flow, double coriolis,
            const LowStorageScheme& scheme, ShapeIntegrator shape, double sharpening,
            ReferenceProfile reference, double aspect_limit = 100);

  /// Deposits the state and solves for its flow.
  const mesh::FlowSummary& evaluate(parcels::Store& store, BuoyancySource& source,
                                    const std::vector<std::size_t>& tile_begin,
                                    const MeanWind& wind, double time, PhaseTimes& times) override;
  void evaluate_velocity(const parcels::Store& store, const std::vector<std::size_t>& tile_begin,
                         const MeanWind& wind, PhaseTimes& times) override;
  void begin_step(parcels::Store& store, MeanWind& wind, double dt, PhaseTimes& times) override;
  /// Also settles the net vorticity.
  void finish_step(parcels::Store& store, BuoyancySource& source,
                   const std::vector<std::size_t>& tile_begin, MeanWind& wind, double time,
                   double dt, PhaseTimes& times) override;
  /// This and the first stage prepare the flow for being interpolated, so that it is no longer the
  /// evaluated one.
  void probe(parcels::Store& store, PhaseTimes& times) override;

  const double* deposited() override { return deposited_.data(); }
  /// The flow's, which the next evaluate() finds anew.
  std::span<double> room_on_mesh() override { return {flow_.data(), flow_.size()}; }
  std::size_t allocated_bytes() const override;

 private:
  using Base = ParcelMotion<D>;
  using Base::deposit_state, Base::deposit_vorticity, Base::reserve, Base::stage_job;
  using Base::deposited_, Base::flow_, Base::summary_, Base::broken_shapes_;
  using Base::grid_, Base::scheme_;

  void stage(parcels::Store& store, MeanWind& wind, std::size_t s, double dt, bool evaluate_only,
             PhaseTimes& times);
  void sharpen_flow(PhaseTimes& times);
  void settle_net_vorticity(parcels::Store& store);

  double coriolis_;
  mesh::FlowSolver<D> solver_;
  mesh::Sharpening<D> sharpen_deposited_, sharpen_flow_;
  std::array<double, StageJob<D>::vorticity_components> net_vorticity_{};         // at the start
  std::array<double, StageJob<D>::vorticity_components> net_vorticity_change_{};  // due so far
  std::array<double, StageJob<D>::vorticity_components> net_vorticity_increment_{};
  bool flow_is_sharp_ = false;
};

}  // namespace pileus::dynamics
