// The table of vector kernels of parcels/, filled once per instruction set and chosen at run time.
#pragma once
#include <cstddef>
#include <cstdint>

#include "parcels/kernel_grid.hpp"

namespace pileus::parcels {

/// Parcels [begin, end) to be added to the mesh, and where they may write.
template <int D>
struct DepositJob {
  KernelGrid<D> grid;
  const double* position[D];
  const double* shape[D == 3 ? 6 : 3];
  const double* offset[D == 3 ? 6 : 2];  // support-point offsets; null: computed from the shapes
  const double* volume;
  const double* value[7];  // per-volume quantities; value_count of them
  int value_count;
  int reference_value;  // value less intercept + slope·z; −1: none
  double reference_intercept, reference_slope;
  double* field;  // nodes × width, sums are added here
  std::size_t begin, end;
  /// Base cells the tile may touch: cell (index − first) mod n must be below `count`.
  std::int32_t tile_first[2], tile_count[2];
  /// Out: indices of parcels that reach further; they have not been deposited.
  std::uint32_t* strays;
  std::size_t stray_count;
};

/// Interpolation of gridded records of 8 (2D: 4) doubles to the parcels' support points.
template <int D>
struct InterpolateJob {
  KernelGrid<D> grid;
  const double* position[D];
  const double* shape[D == 3 ? 6 : 3];
  const double* offset[D == 3 ? 6 : 2];  // null: computed from the shapes
  const double* field;                   // nodes × record, levels beyond the walls included
  double* value[8];                      // out: values 0 … value_count − 1 of the record
  int value_count;
  std::size_t begin, end;
};

/// Displacement of parcel centres by a gridded vector field (Laplace volume correction).
template <int D>
struct DisplaceJob {
  KernelGrid<D> grid;
  double* position[D];
  const double* gradient;  // nodes × (3D: 4, 2D: 2)
  std::size_t begin, end;
};

/// Displacement against the volume excess inside a cell (gradient volume correction).
template <int D>
struct CompressJob {
  KernelGrid<D> grid;
  double* position[D];
  const double* excess;  // nodes, V/V_cell − 1
  double spacing[D];
  double prefactor, limit;
  std::size_t begin, end;
};

struct Kernels {
  /// Support-point offsets of parcels [begin, end) from their shape matrices.
  void (*support_offsets_3d)(const double* const* shape, double* const* offset, std::size_t begin,
                             std::size_t end);
  void (*support_offsets_2d)(const double* const* shape, double* const* offset, std::size_t begin,
                             std::size_t end);
  /// Adds volume and volume-weighted values to records of 8 (3D) or 4 (2D) doubles.
  void (*deposit_3d)(DepositJob<3>&);
  void (*deposit_2d)(DepositJob<2>&);
  /// Adds the volume alone to one double per node.
  void (*deposit_volume_3d)(DepositJob<3>&);
  void (*deposit_volume_2d)(DepositJob<2>&);
  void (*interpolate_3d)(const InterpolateJob<3>&);
  void (*interpolate_2d)(const InterpolateJob<2>&);
  void (*displace_3d)(const DisplaceJob<3>&);
  void (*displace_2d)(const DisplaceJob<2>&);
  void (*compress_3d)(const CompressJob<3>&);
  void (*compress_2d)(const CompressJob<2>&);
  /// Squared semi-axes of parcels [begin, end): longest into `longest`, its ratio to the shortest
  /// (both squared) into `ratio`.
  void (*axis_ratios_3d)(const double* const* shape, double* longest, double* ratio,
                         std::size_t begin, std::size_t end);
  void (*axis_ratios_2d)(const double* const* shape, double* longest, double* ratio,
                         std::size_t begin, std::size_t end);
  const char* instruction_set;
};

/// The widest set this processor runs; PILEUS_INSTRUCTION_SET=baseline|avx2|avx512 asks for a
/// narrower one.
const Kernels& kernels();

/// Name of the instruction set in use, shared by every kernel table: "baseline", "avx2", "avx512".
const char* chosen_instruction_set();

}  // namespace pileus::parcels

namespace pileus::baseline {
extern const parcels::Kernels parcel_kernels;
}
namespace pileus::avx2 {
extern const parcels::Kernels parcel_kernels;
}
namespace pileus::avx512 {
extern const parcels::Kernels parcel_kernels;
}
