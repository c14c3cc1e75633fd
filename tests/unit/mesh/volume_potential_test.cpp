// The potential that evens out volumes, and derivatives of plain fields.
#include "mesh/volume_potential.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "base/aligned_array.hpp"
#include "base/error.hpp"
#include "mesh/derivatives.hpp"
#include "sampled_flow.hpp"

namespace pileus::mesh::test {
namespace {

constexpr double pi = std::numbers::pi;

template <int D, class F>
AlignedArray<double> sampled(const Grid<D>& grid, F&& f) {
  AlignedArray<double> field(grid.nodes());
  field.fill(std::numeric_limits<double>::quiet_NaN());
  for (int j = 0; j < grid.ny(); ++j)
    for (int i = 0; i < grid.nx(); ++i)
      for (int k = 0; k <= grid.nz(); ++k)
        field[grid.node(grid.column(i, j), k)] = f(position(grid, i, j, k));
  return field;
}

template <int D, class Exact>
double largest_error(const Grid<D>& grid, const AlignedArray<double>& records, int width, int first,
                     int last, Exact&& exact) {
  double largest = 0;
  for (int j = 0; j < grid.ny(); ++j)
    for (int i = 0; i < grid.nx(); ++i)
      for (int k = first; k <= last; ++k) {
        const auto expected = exact(position(grid, i, j, k));
        for (std::size_t c = 0; c < expected.size(); ++c) {
          const double error = std::abs(
              records[grid.node(grid.column(i, j), k) * std::size_t(width) + c] - expected[c]);
          largest = error > largest || std::isnan(error) ? error : largest;
        }
      }
  return largest;
}

TEST(VolumePotential, NeumannModeIsExact) {
  // χ = −cos kx sin ly cos mz/(k² + l² + m²), halo included (χ is even about the walls). The
  // compact solvers of the peers reach 2e-7 on 32×?×128.
  const double k = 2 * pi / 3, l = 4 * pi / 5, m = 3 * pi / 2;
  const Grid<3> grid({16, 15, 12}, {0, 0, 0}, {3, 5, 2});
  VolumePotential<3> potential(grid);
  const auto phi = sampled(grid, [&](const Point<3>& x) {
    return std::cos(k * x[0]) * std::sin(l * x[1]) * std::cos(m * x[2]);
  });
  AlignedArray<double> gradient(4 * grid.nodes());
  AlignedArray<double> potential_room(potential.room_needed());
  potential.solve(phi.data(), gradient.data(), potential_room.data());
  const double inverse = -1 / (k * k + l * l + m * m);
  EXPECT_LT(largest_error(grid, gradient, 4, -1, 13,
                          [&](const Point<3>& x) {
                            const double cx = std::cos(k * x[0]), sx = std::sin(k * x[0]);
                            const double cy = std::cos(l * x[1]), sy = std::sin(l * x[1]);
                            const double cz = std::cos(m * x[2]), sz = std::sin(m * x[2]);
                            return std::array{-k * inverse * sx * sy * cz,
                                              l * inverse * cx * cy * cz,
                                              -m * inverse * cx * sy * sz, 0.0};
                          }),
            1e-15);
}

TEST(VolumePotential, HorizontalMeanIsSolvedOrRemoved) {
  const double m = 2 * pi / 2;
  const Grid<2> grid({6, 20}, {0, 0}, {3, 2});
  const auto phi = sampled(grid, [&](const Point<2>& x) { return 0.1 + std::cos(m * x[1]); });
  AlignedArray<double> gradient(2 * grid.nodes());
  VolumePotential<2> all(grid);
  AlignedArray<double> all_room(all.room_needed());
  all.solve(phi.data(), gradient.data(), all_room.data());
  EXPECT_LT(largest_error(grid, gradient, 2, -1, 21,
                          [&](const Point<2>& x) {
                            return std::array{0.0, std::sin(m * x[1]) / m};
                          }),
            1e-15);
  VolumePotential<2> part(grid, VolumePotential<2>::HorizontalMean::remove);
  AlignedArray<double> part_room(part.room_needed());
  part.solve(phi.data(), gradient.data(), part_room.data());
  EXPECT_LT(largest_error(grid, gradient, 2, -1, 21,
                          [](const Point<2>&) {
                            return std::array{0.0, 0.0};
                          }),
            1e-16);
}

TEST(VolumePotential, DivergenceGivesBackWhatIsResolved) {
  // A quadratic in z has Neumann-compatible curvature nowhere: the cosine series converges with
  // third order in the gradient, m⁻² coefficients divided by m.
  double error[2];
  for (int n = 0; n < 2; ++n) {
    const Grid<2> grid({4, 16 << n}, {0, 0}, {1, 1});
    VolumePotential<2> potential(grid);
    const auto phi = sampled(grid, [](const Point<2>& x) { return x[1] * x[1] - 1.0 / 3; });
    AlignedArray<double> gradient(2 * grid.nodes());
    AlignedArray<double> potential_room(potential.room_needed());
    potential.solve(phi.data(), gradient.data(), potential_room.data());
    error[n] = largest_error(grid, gradient, 2, 0, grid.nz(), [](const Point<2>& x) {
      return std::array{0.0, (x[1] * x[1] * x[1] - x[1]) / 3};
    });
  }
  EXPECT_GT(convergence_order(error[0], error[1]), 1.9);
}

TEST(VolumePotential, WorksOnOddAndDegenerateGrids) {
  for (const auto& cells : {std::array{7, 5, 9}, {1, 4, 3}, {4, 1, 3}, {2, 2, 1}, {1, 1, 17}}) {
    const Grid<3> grid(cells, {0, 0, 0}, {1, 2, 3});
    VolumePotential<3> potential(grid);
    const double m = pi / 3;
    const auto phi = sampled(grid, [&](const Point<3>& x) { return std::cos(m * x[2]); });
    AlignedArray<double> gradient(4 * grid.nodes());
    AlignedArray<double> potential_room(potential.room_needed());
    potential.solve(phi.data(), gradient.data(), potential_room.data());
    EXPECT_LT(largest_error(grid, gradient, 4, 0, cells[2],
                            [&](const Point<3>& x) {
                              return std::array{0.0, 0.0, std::sin(m * x[2]) / m, 0.0};
                            }),
              5e-15);
  }
}

TEST(Derivatives, HorizontalIsSpectral) {
  // cos 4x → −4 sin 4x on 64 points (two-sided; EPIC's own test compares one-sidedly).
  const Grid<3> grid({64, 16, 2}, {-pi, -pi, 0}, {2 * pi, 2 * pi, 1});
  for (int axis = 0; axis < 2; ++axis) {
    auto field =
        sampled(grid, [&](const Point<3>& x) { return std::cos(4 * x[std::size_t(axis)]); });
    for (std::size_t column = 0; column < grid.columns(); ++column)
      field[grid.node(column, -1)] = field[grid.node(column, 3)] = field[grid.node(column, 0)];
    AlignedArray<double> out(grid.nodes());
    horizontal_derivative(grid, axis, field.data(), out.data());
    EXPECT_LT(largest_error(grid, out, 1, -1, 3,
                            [&](const Point<3>& x) {
                              return std::array{-4 * std::sin(4 * x[std::size_t(axis)])};
                            }),
              1e-13);
  }
  EXPECT_THROW(horizontal_derivative(grid, 2, nullptr, nullptr), Error);
}

TEST(Derivatives, CurlOfASolvedFlowIsItsVorticity) {
  // The curl of a flow linear in z on top of resolved waves: all derivatives are exact.
  const Grid<3> grid({8, 9, 5}, {0, 0, 0}, {2 * pi, 2 * pi, 1});
  AlignedArray<double> velocity(3 * grid.nodes()), vorticity(3 * grid.nodes());
  for (int j = 0; j < grid.ny(); ++j)
    for (int i = 0; i < grid.nx(); ++i)
      for (int k = 0; k <= grid.nz(); ++k) {
        const Point<3> x = position(grid, i, j, k);
        double* u = velocity.data() + 3 * grid.node(grid.column(i, j), k);
        u[0] = x[2] * std::sin(x[1]);
        u[1] = x[2] * std::cos(2 * x[0]);
        u[2] = std::sin(x[0]) * std::cos(x[1]);
      }
  for (const auto kind : {VerticalDerivative::centred, VerticalDerivative::compact}) {
    curl(grid, kind, velocity.data(), vorticity.data());
    EXPECT_LT(largest_error(grid, vorticity, 3, 0, 5,
                            [](const Point<3>& x) {
                              return std::array{
                                  -std::sin(x[0]) * std::sin(x[1]) - std::cos(2 * x[0]),
                                  std::sin(x[1]) - std::cos(x[0]) * std::cos(x[1]),
                                  x[2] * (-2 * std::sin(2 * x[0]) - std::cos(x[1]))};
                            }),
              2e-14);
  }
  const Grid<2> plane({8, 5}, {0, 0}, {2 * pi, 1});
  AlignedArray<double> flow(2 * plane.nodes()), zeta(plane.nodes());
  for (int i = 0; i < 8; ++i)
    for (int k = 0; k <= 5; ++k) {
      const Point<2> x = position(plane, i, 0, k);
      flow[2 * plane.node(std::size_t(i), k)] = x[1] * std::cos(x[0]);
      flow[2 * plane.node(std::size_t(i), k) + 1] = std::sin(2 * x[0]);
    }
  curl(plane, VerticalDerivative::compact, flow.data(), zeta.data());
  EXPECT_LT(largest_error(plane, zeta, 1, 0, 5,
                          [](const Point<2>& x) {
                            return std::array{2 * std::cos(2 * x[0]) - std::cos(x[0])};
                          }),
            2e-14);
}

}  // namespace
}  // namespace pileus::mesh::test
