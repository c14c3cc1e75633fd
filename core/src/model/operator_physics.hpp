// The operators of a run as the simulation sees them.
#pragma once
#include "coupling/operator_sequence.hpp"
#include "model/simulation.hpp"

namespace pileus::model {

class OperatorPhysics final : public Physics {
 public:
  /// `sequence` must outlive this.
  explicit OperatorPhysics(coupling::OperatorSequence& sequence) : sequence_(sequence) {}

  const double* buoyancy(parcels::Store& store, double time) override;
  bool apply_before(parcels::Store& store, double time, double dt, std::uint64_t step) override;
  void apply_after(parcels::Store& store, double time, double dt, std::uint64_t step) override;
  void population_changed() override { sequence_.population_changed(); }
  /// The number of the step to come, for a run that does not start at step 0.
  void resume_at(std::uint64_t step) { step_ = step; }
  double largest_step() override { return sequence_.dt_limit(); }

 private:
  coupling::OperatorSequence& sequence_;
  std::uint64_t step_ = 0;
  double dt_ = 0;
  int buoyancy_scalar_ = -1;
};

}  // namespace pileus::model
