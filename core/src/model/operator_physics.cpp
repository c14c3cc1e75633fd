#include "model/operator_physics.hpp"

#include <fmt/format.h>

#include "base/error.hpp"

namespace pileus::model {

const double* OperatorPhysics::buoyancy(parcels::Store& store, double time) {
  if (buoyancy_scalar_ < 0) buoyancy_scalar_ = store.find_scalar(coupling::buoyancy_name);
  watch(store, time);
  if (!sequence_.empty()) sequence_.diagnose({step_, time, dt_});
  return store.scalar(buoyancy_scalar_);
}

const double* OperatorPhysics::buoyancy_of_stage(parcels::Store& store, double time) {
  watch(store, time);
  if (!sequence_.empty()) sequence_.diagnose_stage({step_, time, dt_});
  return store.scalar(buoyancy_scalar_);
}

bool OperatorPhysics::apply_before(parcels::Store& store, double time, double dt,
                                   std::uint64_t step) {
  step_ = step;
  dt_ = dt;
  if (!sequence_.splits_around_transport()) return false;
  watch(store, time);
  sequence_.apply_before_transport({step, time, dt}, [&] { watch_again(store, time); });
  tripwires_.values_changed();
  return true;
}

void OperatorPhysics::apply_after(parcels::Store& store, double time, double dt,
                                  std::uint64_t step) {
  if (sequence_.empty()) return;
  watch(store, time + dt);
  sequence_.apply_after_transport({step, time, dt}, [&] { watch_again(store, time + dt); });
  if (!sequence_.order().empty()) tripwires_.values_changed();
}

void OperatorPhysics::population_changed() {
  sequence_.population_changed();
  tripwires_.values_changed();
}

/// Comes before every call of an operator: what an effect that was left out would have done until
/// now is nothing, so that switching it on here continues the run that had it on from the start.
void OperatorPhysics::watch(const parcels::Store& store, double time) {
  while (!tripwires_.empty()) {
    const auto trip = tripwires_.check(store);
    if (!trip) return;
    const std::string because =
        fmt::format("parcel {}: {} is {:.9g}, called for above {:.9g}", trip->uid, trip->quantity,
                    trip->number, trip->threshold);
    if (trip->stop)
      throw Error(
          ExitCode::numerical,
          fmt::format("The effect '{}' was left out and is called for at t = {:.6g} s, step "
                      "{} ({}). {}",
                      trip->effect, time, step_, because,
                      trip->was_watched
                          ? "The scene wants the run to stop here; 'on_trip: activate' "
                            "would switch it on."
                          : "A bound of the planner does not hold, which is a fault of a "
                            "rule or of an operator's declarations; switch the effect on "
                            "under 'effects', and please report it."));
    sequence_.activate(trip->effect);
    tripwires_.disarm(trip->effect);
    activations_.push_back({trip->effect, time, step_, because});
  }
}

void OperatorPhysics::watch_again(const parcels::Store& store, double time) {
  tripwires_.values_changed();
  watch(store, time);
}

void OperatorPhysics::restore(std::vector<Activation> activations) {
  activations_ = std::move(activations);
  for (const Activation& one : activations_) {
    sequence_.activate(one.effect);
    tripwires_.disarm(one.effect);
  }
}

}  // namespace pileus::model
