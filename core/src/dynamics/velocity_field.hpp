// A velocity given as a function of place and time.
#pragma once
#include <array>
#include <cstddef>

#include "dynamics/kernels.hpp"

namespace pileus::dynamics {

/// Where samples of a flow go: velocity (m s⁻¹) by direction and its gradient (s⁻¹) row by row
/// without w_z, in 2D u_x, u_z, w_x.
template <int D>
struct FlowSamples {
  std::array<double*, D> velocity;
  std::array<double*, StageJob<D>::gradient_components> gradient;
};

template <int D>
class VelocityField {
 public:
  virtual ~VelocityField() = default;
  /// Makes ready for as many threads as OpenMP may start now; called by one thread.
  virtual void match_threads() = 0;
  /// Samples at `count` points (m) and a time (s); called by many threads at once. Throws Error
  /// (numerical) naming the first place where the velocity is not finite.
  virtual void sample(double time, std::size_t count, const std::array<const double*, D>& position,
                      const FlowSamples<D>& out) = 0;
  /// Whether time has no part in it.
  virtual bool steady() const = 0;
};

}  // namespace pileus::dynamics
