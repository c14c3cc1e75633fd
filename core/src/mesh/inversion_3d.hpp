// From deposited vorticity to velocity and its gradient on all levels, 3D.
#pragma once
#include <vector>

#include "mesh/line_transform.hpp"
#include "mesh/mode_inversion_3d.hpp"
#include "mesh/thread_scratch.hpp"

namespace pileus::mesh {

/// Three sweeps over the mesh, each in pieces that stay in the cache: rows forward along x; strips
/// of a wavenumber k and its conjugate forward along y, through all their columns and back along
/// y; rows back along x into the flow records. Modes at the Nyquist wavenumber of an even count
/// have no derivative on the mesh and hence no flow; the filter would leave 2e-16 of them.
class Inversion3D {
 public:
  Inversion3D(const Grid<3>& grid, const FlowOptions& options);

  /// Fills velocity and velocity gradient of the flow records at all levels; the tendency is left
  /// alone. Extrema of the summary, if there is one, are updated.
  void solve(const double* deposited, std::array<double, 2> wind, double* flow,
             FlowSummary* summary);

  std::size_t allocated_bytes() const;

 private:
  struct Strip;
  struct Row;
  void transform_row(const double* deposited, int j);
  void solve_strip(int i, std::array<double, 2> wind);
  void solve_mode(int i, int j, std::array<double, 2> wind, const Strip& strip);
  void finish_row(int j, double* flow, FlowSummary* summary);
  FlowSummary column_extrema(const double* slots, const double* derivatives) const;
  void write_record(const double* slots, const double* derivatives, double* record) const;

  Grid<3> grid_;
  FlowOptions options_;
  int levels_;                 // of a packed column
  std::vector<double> k_, l_;  // rad/m, for differentiation
  std::vector<double> filter_k_, filter_l_;
  std::vector<int> end_functions_;  // of mode (i, j), −1 where there are none
  ModeInversion3D modes_;
  LineTransform x_in_, x_out_, x_derivative_, y_in_, y_out_;
  AlignedArray<double> vorticity_;  // [j][i][input_count][levels], transformed along x
  AlignedArray<double> flow_;       // [j][i][count][levels], transformed along x
  std::vector<FlowSummary> row_summary_;
  ThreadScratch scratch_;
};

}  // namespace pileus::mesh
