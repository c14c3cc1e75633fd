#include "dynamics/time_step.hpp"

#include <cmath>

namespace pileus::dynamics {

template <int D>
TimeStep choose_time_step(const TimeStepControl& control, const mesh::Grid<D>& grid,
                          const mesh::FlowSummary& flow, double coriolis) {
  if (control.fixed) return {*control.fixed, "fixed"};
  TimeStep step{control.largest, "cap"};
  const auto limit = [&](double rate, double factor, std::string_view name) {
    // Multiplied out, so that a rate of zero needs no special case.
    if (rate * step.seconds > factor) step = {factor / rate, name};
  };
  limit(flow.strain, control.strain_alpha, "strain");
  limit(std::sqrt(flow.buoyancy_gradient), control.alpha, "stratification");
  for (int d = 0; d < D; ++d)
    limit(flow.speed[static_cast<std::size_t>(d)] * grid.inverse_spacing[d], control.courant,
          "advection");
  limit(std::abs(coriolis), control.alpha, "rotation");
  return step;
}

template TimeStep choose_time_step<2>(const TimeStepControl&, const mesh::Grid<2>&,
                                      const mesh::FlowSummary&, double);
template TimeStep choose_time_step<3>(const TimeStepControl&, const mesh::Grid<3>&,
                                      const mesh::FlowSummary&, double);

}  // namespace pileus::dynamics
