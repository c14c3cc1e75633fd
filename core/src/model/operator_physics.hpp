// The operators of a run as the simulation sees them, and the watch over what was left out.
#pragma once
#include <string>
#include <vector>

#include "coupling/operator_sequence.hpp"
#include "model/simulation.hpp"
#include "planner/tripwire.hpp"

namespace pileus::model {

/// An effect that was switched on while the run went on.
struct Activation {
  std::string effect;
  double time = 0;  // s
  std::uint64_t step = 0;
  std::string because;  // one sentence
};

class OperatorPhysics final : public Physics {
 public:
  /// `sequence` must outlive this.
  OperatorPhysics(coupling::OperatorSequence& sequence, planner::Tripwires tripwires)
      : sequence_(sequence), tripwires_(std::move(tripwires)) {}

  /// Throws Error (numerical) when an effect that was left out is called for and not to be
  /// switched on.
  const double* buoyancy(parcels::Store& store, double time) override;
  const double* buoyancy_of_stage(parcels::Store& store, double time) override;
  bool apply_before(parcels::Store& store, double time, double dt, std::uint64_t step) override;
  void apply_after(parcels::Store& store, double time, double dt, std::uint64_t step) override;
  void population_changed() override;
  /// The number of the step to come, for a run that does not start at step 0.
  void resume_at(std::uint64_t step) { step_ = step; }
  bool turns_air_at_the_ground() const override {
    return coupling::writes_at_the_ground(sequence_.operators(), "z_vorticity");
  }
  double largest_step() override { return sequence_.dt_limit(); }

  /// Effects switched on since the start of the run, those of earlier legs included.
  const std::vector<Activation>& activations() const { return activations_; }
  /// Takes over activations from a checkpoint: their effects are on.
  void restore(std::vector<Activation> activations);
  const planner::Tripwires& tripwires() const { return tripwires_; }

 private:
  void watch(const parcels::Store& store, double time);
  /// After an operator has written.
  void watch_again(const parcels::Store& store, double time);

  coupling::OperatorSequence& sequence_;
  planner::Tripwires tripwires_;
  std::vector<Activation> activations_;
  std::uint64_t step_ = 0;
  double dt_ = 0;
  int buoyancy_scalar_ = -1;
};

}  // namespace pileus::model
