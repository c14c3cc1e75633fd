#include "mesh/derivatives.hpp"

#include <algorithm>
#include <array>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "mesh/line_transform.hpp"
#include "mesh/mode_columns.hpp"
#include "mesh/thread_scratch.hpp"

namespace pileus::mesh {

namespace {

/// One component of a vector field as a field of its own, and back.
template <int Width>
void take(const double* from, std::size_t nodes, int component, double* to) {
  for (std::size_t node = 0; node < nodes; ++node) to[node] = from[node * Width + component];
}

template <int D>
void add_vertical_derivative(const Grid<D>& grid, const ColumnMatrix& derivative,
                             const double* field, double sign, double* out, int width) {
  const std::size_t p = column_pitch(grid.nz());
  ThreadScratch scratch(4 * p);
  parallel_chunks(
      grid.columns(),
      [&](std::size_t begin, std::size_t end) {
        double *in = scratch.mine(), *result = in + 2 * p;
        for (std::size_t column = begin; column < end; ++column) {
          std::copy_n(field + grid.node(column, 0), grid.nz() + 1, in);
          derivative.apply(in, result, 2);
          for (int k = 0; k <= grid.nz(); ++k)
            out[grid.node(column, k) * std::size_t(width)] += sign * result[k];
        }
      },
      64);
}

template <int D>
void add_horizontal_derivative(const Grid<D>& grid, int axis, const double* field, double sign,
                               double* out, int width, double* spare) {
  horizontal_derivative(grid, axis, field, spare);
  for (std::size_t node = 0; node < grid.nodes(); ++node)
    out[node * std::size_t(width)] += sign * spare[node];
}

template <int D>
void extrapolate(const Grid<D>& grid, double* field, int width) {
  const int nz = grid.nz();
  for (std::size_t column = 0; column < grid.columns(); ++column)
    for (int c = 0; c < width; ++c) {
      const auto at = [&](int k) -> double& {
        return field[grid.node(column, k) * std::size_t(width) + std::size_t(c)];
      };
      at(-1) = 2 * at(0) - at(1);
      at(nz + 1) = 2 * at(nz) - at(nz - 1);
    }
}

}  // namespace

template <int D>
void horizontal_derivative(const Grid<D>& grid, int axis, const double* field, double* out) {
  if (axis < 0 || axis >= D - 1)
    throw Error(ExitCode::usage, "A horizontal derivative needs a horizontal axis.");
  const int levels = (grid.levels() + 1) / 2 * 2;
  const int length = grid.cells[axis], lines = int(grid.columns()) / length;
  const LineTransform transform(length, levels / 2);
  ThreadScratch scratch(2 * aligned_doubles(transform.doubles()));
  parallel_tasks(std::size_t(lines), [&](std::size_t line) {
    double* values = scratch.mine();
    double* spectrum = values + aligned_doubles(transform.doubles());
    const auto column = [&](int m) {
      return axis == 0 ? grid.column(m, int(line)) : grid.column(int(line), m);
    };
    for (int m = 0; m < length; ++m)
      std::copy_n(field + grid.node(column(m), -1), grid.levels(), values + m * levels);
    transform.forward(values, spectrum);
    for (int m = 0; m < length; ++m) {
      const double k = derivative_wavenumber(m, length, grid.extent[axis]) / length;
      for (int z = 0; z < levels; z += 2) {
        double* value = spectrum + m * levels + z;
        const double real = value[0];
        value[0] = -k * value[1];
        value[1] = k * real;
      }
    }
    transform.backward(spectrum, values);
    for (int m = 0; m < length; ++m)
      std::copy_n(values + m * levels, grid.levels(), out + grid.node(column(m), -1));
  });
}

template <int D>
void curl(const Grid<D>& grid, VerticalDerivative kind, const double* velocity, double* vorticity) {
  constexpr int width = D == 3 ? 3 : 1;
  const ColumnMatrix derivative = vertical_derivative(kind, grid.nz(), grid.spacing[D - 1]);
  AlignedArray<double> component(grid.nodes()), spare(grid.nodes());
  for (std::size_t column = 0; column < grid.columns(); ++column)
    std::fill_n(vorticity + grid.node(column, -1) * width, grid.levels() * width, 0.0);
  const auto load = [&](int c) {
    take<D>(velocity, grid.nodes(), c, component.data());
    extrapolate(grid, component.data(), 1);  // the halo is transformed along with the rest
  };
  const auto add_x = [&](double sign, int c) {
    add_horizontal_derivative(grid, 0, component.data(), sign, vorticity + c, width, spare.data());
  };
  const auto add_z = [&](double sign, int c) {
    add_vertical_derivative(grid, derivative, component.data(), sign, vorticity + c, width);
  };
  if constexpr (D == 3) {
    const auto add_y = [&](double sign, int c) {
      add_horizontal_derivative(grid, 1, component.data(), sign, vorticity + c, width,
                                spare.data());
    };
    load(0);
    add_z(1, 1);
    add_y(-1, 2);
    load(1);
    add_z(-1, 0);
    add_x(1, 2);
    load(2);
    add_y(1, 0);
    add_x(-1, 1);
  } else {
    load(0);
    add_z(-1, 0);
    load(1);
    add_x(1, 0);
  }
  extrapolate(grid, vorticity, width);
}

template void horizontal_derivative(const Grid<2>&, int, const double*, double*);
template void horizontal_derivative(const Grid<3>&, int, const double*, double*);
template void curl(const Grid<2>&, VerticalDerivative, const double*, double*);
template void curl(const Grid<3>&, VerticalDerivative, const double*, double*);

}  // namespace pileus::mesh
