// Dense linear operators on columns: sine and cosine transforms, vertical derivatives.
//
// A matrix product beats fast transforms here. FFTW's DST-I and DCT-I (logical length 2(n ± 1))
// cost 130 ns for 13 levels and 400 ns for 65 on the machine these lines were written on; the
// product below costs 3 and 40 ns, wins up to about 500 levels, takes every n_z alike and lets any
// linear operation along z be one matrix.
#pragma once
#include <cstddef>
#include <functional>

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
  /// element(row, column), rows and columns 0 … n_z. Columns of zeros at either end are skipped.
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
  int first_ = 0, last_ = 0;       // columns that are not all zero: [first_, last_)
  AlignedArray<double> elements_;  // column by column, rows padded with zeros
};

}  // namespace pileus::mesh
