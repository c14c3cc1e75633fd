// How long a step may be.
#pragma once
#include <array>
#include <optional>
#include <string_view>

#include "mesh/flow_options.hpp"
#include "mesh/grid.hpp"

namespace pileus::dynamics {

struct TimeStepControl {
  double alpha = 0.25;          // Δt ≤ alpha / largest √|∇b|, alpha / f
  double strain_alpha = 0.5;    // Δt ≤ strain_alpha / largest strain rate
  double courant = 1.0;         // Δt ≤ courant · Δ/|u| in every direction
  double largest = 0;           // s; cap, needed by a fluid at rest. Must be positive
  std::optional<double> fixed;  // s; replaces all limits
};

struct TimeStep {
  double seconds;
  std::string_view limiter;  // "strain", "stratification", "advection", "rotation", "cap", "fixed"
};

/// The step allowed by the flow. The strain and stratification limits have the form of the method's
/// authors, who use one factor for both; the advective one keeps a parcel from crossing more than
/// `courant` cells in a step, and the rotational one resolves the inertial period 2π/f.
template <int D>
TimeStep choose_time_step(const TimeStepControl& control, const mesh::Grid<D>& grid,
                          const mesh::FlowSummary& flow, double coriolis);

}  // namespace pileus::dynamics
