// The table of ways to advance shape matrices that the experiment compares, filled once per
// instruction set.
#pragma once
#include <array>
#include <cstddef>

namespace pileus::study {

/// How a shape matrix is advanced in a velocity gradient that changes with time.
enum class ShapeIntegrator {
  rk3,           // Williamson's scheme on dB/dt = S B + B Sᵀ
  rk4,           // Carpenter and Kennedy's
  exponential3,  // B ← E B Eᵀ in every stage of Williamson's scheme
  exponential4,  // in every stage of Carpenter and Kennedy's; what the model does
  midpoint,      // one exponential of the gradient in the middle of the step
  count_
};
inline constexpr std::size_t shape_integrator_count =
    static_cast<std::size_t>(ShapeIntegrator::count_);

/// Structure of arrays over `count` cases, a multiple of eight. The gradient is linear in time
/// between `start` (t = 0) and `end` (t = duration), row by row; shapes are xx, xy, xz, yy, yz, zz.
struct ShapeJob {
  const double* shape[6];
  const double* start[9];
  const double* end[9];
  double* result[6];
  std::size_t count;
  double duration;
  int steps;  // equal ones, from 0 to `duration`
};

using ShapeKernels = std::array<void (*)(const ShapeJob&), shape_integrator_count>;

/// The kernels of this machine's instruction set.
const ShapeKernels& shape_kernels();

}  // namespace pileus::study

namespace pileus::baseline {
extern const study::ShapeKernels shape_kernels;
}
namespace pileus::avx2 {
extern const study::ShapeKernels shape_kernels;
}
namespace pileus::avx512 {
extern const study::ShapeKernels shape_kernels;
}
