#include "mesh/column_matrix.hpp"

#include <algorithm>

#include "mesh/vector_clones.hpp"

namespace pileus::mesh {

namespace {

// GCC splits this type where the registers are narrower.
using Vector [[gnu::vector_size(64), gnu::aligned(64)]] = double;
constexpr int lanes = 8;

struct Product {
  const double* matrix;
  std::size_t pitch;
  const int *first, *last;  // of every eight rows
};

/// Rows [row, row + 8·Blocks) of `Columns` products; each sum runs over the columns in order.
template <int Columns, int Blocks>
[[gnu::always_inline]] inline void multiply_block(const Product& m, std::size_t row,
                                                  const double* in, double* out) {
  Vector sum[Columns][Blocks] = {};
  const std::size_t group = row / lanes;
  const int first = std::min(m.first[group], m.first[group + Blocks - 1]);
  const int last = std::max(m.last[group], m.last[group + Blocks - 1]);
  for (int k = first; k < last; ++k) {
    const auto* elements =
        reinterpret_cast<const Vector*>(m.matrix + std::size_t(k) * m.pitch + row);
    for (int c = 0; c < Columns; ++c) {
      const double x = in[std::size_t(c) * m.pitch + std::size_t(k)];
      for (int b = 0; b < Blocks; ++b) sum[c][b] += elements[b] * x;
    }
  }
  for (int c = 0; c < Columns; ++c)
    for (int b = 0; b < Blocks; ++b)
      *reinterpret_cast<Vector*>(out + std::size_t(c) * m.pitch + row + std::size_t(b) * lanes) =
          sum[c][b];
}

template <int Columns>
[[gnu::always_inline]] inline void multiply_columns(const Product& m, const double* in,
                                                    double* out) {
  std::size_t row = 0;
  for (; row + 2 * lanes <= m.pitch; row += 2 * lanes) multiply_block<Columns, 2>(m, row, in, out);
  if (row < m.pitch) multiply_block<Columns, 1>(m, row, in, out);
}

PILEUS_VECTOR_CLONES
void multiply(const Product& m, const double* in, double* out, int count) {
  int c = 0;
  for (; c + 4 <= count; c += 4)
    multiply_columns<4>(m, in + std::size_t(c) * m.pitch, out + std::size_t(c) * m.pitch);
  if (c < count)
    multiply_columns<2>(m, in + std::size_t(c) * m.pitch, out + std::size_t(c) * m.pitch);
}

}  // namespace

ColumnMatrix::ColumnMatrix(int nz, const std::function<double(int, int)>& element)
    : nz_(nz), elements_(std::size_t(nz + 1) * column_pitch(nz)) {
  elements_.fill(0);
  for (int column = 0; column <= nz; ++column)
    for (int row = 0; row <= nz; ++row)
      elements_[std::size_t(column) * column_pitch(nz) + std::size_t(row)] = element(row, column);
  for (int begin = 0; begin <= nz; begin += lanes) {
    int first = nz + 1, last = 0;
    for (int column = 0; column <= nz; ++column)
      for (int row = begin; row < std::min(begin + lanes, nz + 1); ++row)
        if ((*this)(row, column) != 0) {
          first = std::min(first, column);
          last = column + 1;
        }
    first_.push_back(std::min(first, last));
    last_.push_back(last);
  }
}

void ColumnMatrix::apply(const double* in, double* out, int count) const {
  multiply({elements_.data(), column_pitch(nz_), first_.data(), last_.data()}, in, out, count);
}

}  // namespace pileus::mesh
