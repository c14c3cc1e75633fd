// Mesh fields in the order of files: z slowest, x fastest, without halo levels.
#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "mesh/grid.hpp"
#include "output/netcdf_form.hpp"

namespace pileus::output {

/// The axes of gridded fields, slowest first: z, y, x (2D: z, x). Horizontal axes are periodic and
/// list each node once; z lists both walls.
template <int D>
std::vector<Axis> node_axes(const mesh::Grid<D>& grid) {
  constexpr std::array<const char*, 3> names = {"x", D == 3 ? "y" : "z", "z"};
  std::vector<Axis> axes;
  for (int d = D - 1; d >= 0; --d) {
    const bool is_height = d == mesh::Grid<D>::vertical;
    Axis axis{
        {names[static_cast<std::size_t>(d)], "m", is_height ? "height" : "horizontal distance", ""},
        {},
        is_height ? "up" : ""};
    const int nodes = grid.cells[d] + (is_height ? 1 : 0);
    for (int i = 0; i < nodes; ++i) axis.values.push_back(grid.lower[d] + i * grid.spacing[d]);
    axes.push_back(std::move(axis));
  }
  return axes;
}

/// The axes of quantities of the ground, slowest first: y_cell, x_cell (2D: x_cell), the centres of
/// the columns of cells.
template <int D>
std::vector<Axis> ground_axes(const mesh::Grid<D>& grid) {
  std::vector<Axis> axes;
  for (int d = D - 2; d >= 0; --d) {
    const auto axis_number = static_cast<std::size_t>(d);
    Axis axis{
        {d == 0 ? "x_cell" : "y_cell", "m", "horizontal distance of the centre of a cell", ""}, {}};
    for (int i = 0; i < grid.cells[axis_number]; ++i)
      axis.values.push_back(grid.lower[axis_number] + (i + 0.5) * grid.spacing[axis_number]);
    axes.push_back(std::move(axis));
  }
  return axes;
}

/// Copies component `component` of `width` interleaved values per node (mesh/grid.hpp) into file
/// order; `values` gets n_x·n_y·(n_z + 1) entries.
template <int D>
void copy_nodes(const mesh::Grid<D>& grid, const double* nodes, int width, int component,
                std::vector<double>& values) {
  const std::size_t columns = grid.columns();
  values.resize(columns * static_cast<std::size_t>(grid.nz() + 1));
  for (std::size_t column = 0; column < columns; ++column) {
    const double* at = nodes + grid.node(column, 0) * static_cast<std::size_t>(width) + component;
    for (std::size_t k = 0; k <= static_cast<std::size_t>(grid.nz()); ++k)
      values[k * columns + column] = at[k * static_cast<std::size_t>(width)];
  }
}

}  // namespace pileus::output
