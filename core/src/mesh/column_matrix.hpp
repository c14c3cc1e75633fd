// Dense linear operators on columns: sine and cosine transforms, vertical derivatives.
//
// A matrix product beats fast transforms at the heights in use. Measured with AVX-512 on a Zen 5
// core, per column: product 6, 21, 75, 295, 1190 ns for 12, 32, 64, 128, 256 cells; FFTW's DST-I
// (RODFT00, estimate mode) 94, 105, 186, 439, 938 ns. It also takes every n_z alike, where DST-I
// and DCT-I of length n_z ± 1 want smooth n_z, and lets any linear operation along z be one matrix.
#pragma once
#include <cstddef>
#include <functional>
#include <vector>

#include "base/aligned_array.hpp"

namespace pileus::mesh {

/// Length of a column buffer: levels 0 … n_z padded to whole 64-byte vectors.
inline std::size_t column_pitch(int nz) {
  return (std::size_t(nz) + 8) / 8 * 8;
}

/// A square matrix over the levels 0 … n_z.
class ColumnMatrix {
 public:
  ColumnMatrix() = default;
  /// element(row, column), rows and columns 0 … n_z. Leading and trailing columns that are zero in
  /// a group of eight rows are skipped, so that a banded matrix costs little more than its band.
  ColumnMatrix(int nz, const std::function<double(int, int)>& element);

  /// out_c = M in_c for `count` columns (an even number), column c at [c*column_pitch(nz)].
  /// Padding of `out` is set to zero; padding of `in` is not read. `in` and `out` are 64-byte
  /// aligned and do not overlap.
  void apply(const double* in, double* out, int count) const;

  int nz() const { return nz_; }
  double operator()(int row, int column) const {
    return elements_[std::size_t(column) * column_pitch(nz_) + std::size_t(row)];
  }

 private:
  int nz_ = 0;
  std::vector<int> first_, last_;  // columns [first, last) that eight rows need
  AlignedArray<double> elements_;  // column by column, rows padded with zeros
};

}  // namespace pileus::mesh
