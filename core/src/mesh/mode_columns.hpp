// Columns of a mode and of its conjugate, between the packed form of LineTransform and complex
// columns.
//
// Levels travel through the horizontal transforms in pairs, F_p = f_{2p} + i f_{2p+1}. The column
// of wavenumber (k, l) and that of (−k, −l) together hold the complex amplitudes of all levels:
// f̂_{2p} = (F_p(k) + F_p(−k)*)/2 and f̂_{2p+1} = (F_p(k) − F_p(−k)*)/(2i).
#pragma once
#include <cstddef>

namespace pileus::mesh {

/// Number of levels a column has in the horizontal transforms: n_z + 1 rounded up to even.
inline int packed_levels(int nz) {
  return (nz + 2) / 2 * 2;
}

/// Real and imaginary parts of the amplitudes at `levels` levels (even), times `scale`, from the
/// packed columns `a` of a mode and `b` of its conjugate (the same column where they coincide).
[[gnu::always_inline]] inline void unpack_mode(const double* __restrict a,
                                               const double* __restrict b, int levels, double scale,
                                               double* __restrict real,
                                               double* __restrict imaginary) {
  const double half = 0.5 * scale;
  for (int k = 0; k < levels; k += 2) {
    real[k] = half * (a[k] + b[k]);
    real[k + 1] = half * (a[k + 1] + b[k + 1]);
    imaginary[k] = half * (a[k + 1] - b[k + 1]);
    imaginary[k + 1] = half * (b[k] - a[k]);
  }
}

/// The inverse of unpack_mode with scale 1. `a` and `b` may be the same column.
[[gnu::always_inline]] inline void pack_mode(const double* __restrict real,
                                             const double* __restrict imaginary, int levels,
                                             double* a, double* b) {
  for (int k = 0; k < levels; k += 2) {
    const double r0 = real[k], r1 = real[k + 1], i0 = imaginary[k], i1 = imaginary[k + 1];
    b[k] = r0 + i1;
    b[k + 1] = r1 - i0;
    a[k] = r0 - i1;
    a[k + 1] = r1 + i0;
  }
}

}  // namespace pileus::mesh
