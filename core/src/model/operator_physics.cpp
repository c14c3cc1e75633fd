#include "model/operator_physics.hpp"

namespace pileus::model {

const double* OperatorPhysics::buoyancy(parcels::Store& store, double time) {
  if (buoyancy_scalar_ < 0) buoyancy_scalar_ = store.find_scalar(coupling::buoyancy_name);
  if (!sequence_.empty()) sequence_.diagnose({step_, time, dt_});
  return store.scalar(buoyancy_scalar_);
}

bool OperatorPhysics::apply_before(parcels::Store&, double time, double dt, std::uint64_t step) {
  step_ = step;
  dt_ = dt;
  if (!sequence_.splits_around_transport()) return false;
  sequence_.apply_before_transport({step, time, dt});
  return true;
}

void OperatorPhysics::apply_after(parcels::Store&, double time, double dt, std::uint64_t step) {
  if (!sequence_.empty()) sequence_.apply_after_transport({step, time, dt});
}

}  // namespace pileus::model
