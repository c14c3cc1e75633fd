// The table of vector kernels of dynamics/, filled once per instruction set.
#pragma once
#include <cstddef>

#include "parcels/kernel_grid.hpp"

namespace pileus::dynamics {

/// How the shape matrix is advanced over a stage.
enum class ShapeIntegrator {
  exponential,  // B ← E B Eᵀ, E = exp(B_s Δt Z): commutator-free Lie-group form (Bazavov 2020)
  runge_kutta,  // dB/dt = S B + B Sᵀ as one more variable of the Runge–Kutta scheme
};

/// One low-storage stage for parcels [begin, end), begin a multiple of 8:
///   k ← A k + f(y),  y ← y + B Δt k
/// with y = position, vorticity, shape and f interpolated from the flow at the support points.
template <int D>
struct StageJob {
  static constexpr int vorticity_components = D == 3 ? 3 : 1;
  static constexpr int shape_components = D == 3 ? 6 : 3;
  /// Stored increments of the shape: the velocity gradient without w_z (exponential), or dB.
  static constexpr int gradient_components = D == 3 ? 8 : 3;

  parcels::KernelGrid<D> grid;
  const double* flow;                    // nodes × FlowRecord<D>::width
  const double* offset[D == 3 ? 6 : 2];  // support offsets; null: computed from the shapes
  double* position[D];
  double* vorticity[vorticity_components];
  double* shape[shape_components];
  const double* size_volume;  // of the ellipsoids
  double* position_increment[D];
  double* vorticity_increment[vorticity_components];
  double* shape_increment[gradient_components];
  double keep;          // A of the stage
  double advance;       // B Δt of the stage; 0 with `evaluate_only`
  bool first;           // increments hold nothing yet
  bool last;            // restore det B = (V/V₁)² at the end
  bool evaluate_only;   // k ← f, y untouched (diagnostics)
  double aspect_limit;  // of the longest half-axis to the others after the last stage
  ShapeIntegrator shape_integrator;
  std::size_t begin, end;
  std::size_t broken;  // out: parcels whose shape went beyond that and was blunted
};

/// The same stage with the flow given at the parcels instead of on the mesh: element p − begin of
/// each array belongs to parcel p, with room up to the next multiple of 8. The gradient is row by
/// row without w_z (2D: u_x, u_z, w_x). Vorticity is left alone; `flow` and `offset` are not used.
template <int D>
struct GivenStageJob : StageJob<D> {
  const double* velocity[D];
  const double* gradient[StageJob<D>::gradient_components];
};

/// Blunts the shapes of parcels [begin, end), begin a multiple of 8, that the last stage would:
/// those longer than the limit or not positive definite. Others are left as they are.
template <int D>
struct ShapeJob {
  double* shape[StageJob<D>::shape_components];
  const double* size_volume;  // of the ellipsoids
  double aspect_limit;        // of the longest half-axis to the others
  std::size_t begin, end;
  std::size_t broken;  // out: parcels whose shape went beyond that and was blunted
};

struct Kernels {
  void (*stage_3d)(StageJob<3>&);
  void (*stage_2d)(StageJob<2>&);
  void (*given_stage_3d)(GivenStageJob<3>&);
  void (*given_stage_2d)(GivenStageJob<2>&);
  void (*blunt_shapes_3d)(ShapeJob<3>&);
  void (*blunt_shapes_2d)(ShapeJob<2>&);
};

const Kernels& kernels();

}  // namespace pileus::dynamics

namespace pileus::baseline {
extern const dynamics::Kernels dynamics_kernels;
}
namespace pileus::avx2 {
extern const dynamics::Kernels dynamics_kernels;
}
namespace pileus::avx512 {
extern const dynamics::Kernels dynamics_kernels;
}
