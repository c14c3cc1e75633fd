// Vorticity inversion of one horizontal wavenumber in 3D.
#pragma once
#include "mesh/flow_options.hpp"
#include "mesh/grid.hpp"
#include "mesh/vertical_basis.hpp"

namespace pileus::mesh {

/// Columns a mode comes with (vorticity ξ, η, ζ) and leaves with.
namespace mode_slot {
inline constexpr int input_count = 3;
inline constexpr int u = 0, v = 1, w = 2, u_y = 3, v_y = 4, w_y = 5, xi = 6, eta = 7;
inline constexpr int count = 8;
}  // namespace mode_slot

/// One pair of conjugate wavenumbers (k, l) and (−k, −l), both packed (mode_columns.hpp).
struct Mode3D {
  double k = 0, l = 0;     // rad/m
  double scale = 1;        // normalisation of the transforms times the horizontal filter
  int end_functions = -1;  // index into the vertical basis
};

class ModeInversion3D {
 public:
  ModeInversion3D(const Grid<3>& grid, const FlowOptions& options,
                  const std::vector<double>& squared_wavenumbers);

  const VerticalBasis& basis() const { return basis_; }
  /// Doubles of working memory solve() and solve_mean() need.
  std::size_t work_doubles() const;

  /// From the packed vorticity columns [input_count][levels] of a mode and of its conjugate to the
  /// packed columns [count][levels] of velocity, y-derivatives and solenoidal vorticity of both.
  void solve(const Mode3D& mode, const double* in, const double* in_conjugate, double* out,
             double* out_conjugate, double* work) const;

  /// The same for the horizontal mean, which is not filtered: u_z = η, v_z = −ξ, no vertical
  /// velocity, vertical mean equal to `wind` (m/s). The mean of ζ vanishes in a periodic box
  /// whatever was deposited.
  void solve_mean(double scale, std::array<double, 2> wind, const double* in, double* out,
                  double* work) const;

 private:
  struct Columns;
  void project_and_invert(const Mode3D& mode, const Columns& c) const;
  void integrate_mean(const double* vorticity, double sign, double wind, double* series,
                      double* velocity) const;

  int nz_, levels_;
  bool filter_;
  VerticalBasis basis_;
  ColumnMatrix derivative_;
};

}  // namespace pileus::mesh
