// The displacement field that evens out the volume fraction.
#pragma once
#include <vector>

#include "mesh/column_matrix.hpp"
#include "mesh/grid.hpp"
#include "mesh/line_transform.hpp"
#include "mesh/thread_scratch.hpp"

namespace pileus::mesh {

/// Solves ∇²χ = φ with ∂χ/∂z = 0 on the walls and returns ∇χ. Fourier in the horizontal, cosines
/// in z, whose derivative vanishes at the walls as χ's does.
template <int D>
class VolumePotential {
 public:
  /// What becomes of the horizontal mean of φ. Removing it leaves a level that is over-full
  /// everywhere as it is (the 3D model of Frey, Dritschel & Böing 2023 does so).
  enum class HorizontalMean { solve, remove };

  /// Doubles per node of the result: ∂x, ∂y, ∂z, 0 in 3D; ∂x, ∂z in 2D.
  static constexpr int width = D == 3 ? 4 : 2;

  explicit VolumePotential(const Grid<D>& grid, HorizontalMean mean = HorizontalMean::solve);

  /// `phi`: V/V_cell − 1 per node, levels 0 … n_z read; its domain mean has no effect.
  /// `gradient`: ∇χ (m², a displacement per unit of φ's relaxation) as [node*width + axis] at all
  /// levels; beyond the walls the horizontal components are even and the vertical one is odd.
  /// `room`: doubles to work in, room_needed() of them on a cache line.
  void solve(const double* phi, double* gradient, double* room);
  std::size_t room_needed() const;

  std::size_t allocated_bytes() const { return scratch_.allocated_bytes(); }

 private:
  struct Piece;
  void transform_row(const double* phi, std::size_t task);
  void solve_strip(int i);
  void solve_mode(int i, int j, const double* in, const double* in_conjugate, double* out,
                  double* out_conjugate, double* work) const;
  void finish_row(std::size_t task, double* gradient);
  void fill_halo(std::size_t column, double* gradient) const;

  Grid<D> grid_;
  HorizontalMean mean_;
  int block_, blocks_, levels_;  // levels per piece of a row, pieces, levels of a packed column
  ColumnMatrix cosine_analysis_, cosine_synthesis_, sine_synthesis_;
  AlignedArray<double> wavenumber_;
  LineTransform x_in_, x_out_, y_in_, y_out_;
  double* phi_ = nullptr;       // in the room: [j][i][levels], transformed along x
  double* gradient_ = nullptr;  // in the room: [j][i][axis][levels]
  ThreadScratch scratch_;
};

extern template class VolumePotential<2>;
extern template class VolumePotential<3>;

}  // namespace pileus::mesh
