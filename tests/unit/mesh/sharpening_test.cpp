// The compensation of the window of deposit and interpolation, mode by mode.
#include "mesh/sharpening.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace pileus::mesh {
namespace {

// ⟨f(1−f)⟩ of two parcels at 1/4 and 3/4 is 3/16, of three 19/108; it tends to 1/6, the mean over
// all f (the window's derivation).
TEST(Sharpening, MeanProducts) {
  EXPECT_DOUBLE_EQ(lattice_mean_product(2), 3.0 / 16);
  EXPECT_DOUBLE_EQ(lattice_mean_product(3), (2 * 5.0 / 36 + 0.25) / 3);
  EXPECT_NEAR(lattice_mean_product(1000), 1.0 / 6, 1e-6);
}

// A horizontal mode is an eigenfunction with the factor s = 1 + β(1 − cos 2κΔ) per direction, one
// at the grid scale; entries outside the range stay as they are.
TEST(Sharpening, HorizontalModes) {
  const Grid<3> grid({12, 8, 3}, {0, 0, 0}, {12, 8, 3});
  constexpr double beta = 3.0 / 64;
  for (const auto& [m, n] : {std::pair{1, 0}, std::pair{2, 3}, std::pair{6, 4}, std::pair{0, 0}}) {
    std::vector<double> records(grid.nodes() * 8);
    const auto mode = [&, m = m, n = n](int i, int j) {
      return std::cos(2 * std::numbers::pi * (m * i / 12.0 + n * j / 8.0) + 0.3);
    };
    for (int j = 0; j < 8; ++j)
      for (int i = 0; i < 12; ++i)
        for (int k = -1; k <= 4; ++k)
          for (std::size_t f = 0; f < 8; ++f)
            records[grid.node(grid.column(i, j), k) * 8 + f] = mode(i, j);
    Sharpening<3> sharpening(grid, 8, 1, 5, beta);
    sharpening.apply(records.data());
    const double factor = (1 + beta * (1 - std::cos(4 * std::numbers::pi * m / 12))) *
                          (1 + beta * (1 - std::cos(4 * std::numbers::pi * n / 8)));
    for (int j = 0; j < 8; ++j)
      for (int i = 0; i < 12; ++i)
        for (int k = 0; k <= 3; ++k) {
          const double* node = &records[grid.node(grid.column(i, j), k) * 8];
          // Five additions of terms below 1.2 in each of two directions.
          EXPECT_NEAR(node[1], factor * mode(i, j), 1e-14);
          EXPECT_EQ(node[0], mode(i, j));
          EXPECT_EQ(node[5], mode(i, j));
        }
  }
}

// With the window of the lattice, √t, the product differs from one only to fourth order in κΔ.
TEST(Sharpening, CompensatesTheWindowToFourthOrder) {
  const double beta = 0.25 * lattice_mean_product(2);
  const auto defect = [&](double kappa) {
    const double window = std::sqrt(1 - 2 * lattice_mean_product(2) * (1 - std::cos(kappa)));
    return std::abs(window * (1 + beta * (1 - std::cos(2 * kappa))) - 1);
  };
  const double order = std::log2(defect(0.2) / defect(0.1));
  EXPECT_NEAR(order, 4, 0.05);
}

// A linear profile is not curved, so nothing is added to it, walls and continuations included.
TEST(Sharpening, LinearProfilesStay) {
  const Grid<2> grid({5, 7}, {0, 0}, {5, 7});
  std::vector<double> records(grid.nodes() * 4);
  for (std::size_t c = 0; c < grid.columns(); ++c)
    for (int k = -1; k <= 8; ++k)
      for (std::size_t f = 0; f < 4; ++f) records[grid.node(c, k) * 4 + f] = 3.0 * k - 1;
  Sharpening<2> sharpening(grid, 4, 0, 4, 0.05);
  sharpening.apply(records.data());
  for (std::size_t c = 0; c < grid.columns(); ++c)
    for (int k = -1; k <= 8; ++k) EXPECT_NEAR(records[grid.node(c, k) * 4], 3.0 * k - 1, 1e-14);
}

TEST(Sharpening, SameBitsForAnyNumberOfThreads) {
  const Grid<3> grid({7, 9, 5}, {0, 0, 0}, {1, 1, 1});
  std::vector<double> start(grid.nodes() * 16);
  for (std::size_t n = 0; n < start.size(); ++n) start[n] = std::sin(1.7 * static_cast<double>(n));
  std::vector<double> first;
  for (const int threads : {1, 2, 3}) {
    omp_set_num_threads(threads);
    std::vector<double> records = start;
    Sharpening<3> sharpening(grid, 16, 0, 16, 3.0 / 64);
    sharpening.apply(records.data());
    if (first.empty()) first = records;
    EXPECT_EQ(records, first);
  }
}

TEST(Sharpening, StrengthZeroDoesNothing) {
  const Grid<3> grid({3, 2, 1}, {0, 0, 0}, {1, 1, 1});
  std::vector<double> records(grid.nodes() * 8, 1.5);
  Sharpening<3> sharpening(grid, 8, 0, 8, 0);
  EXPECT_FALSE(sharpening.active());
  sharpening.apply(records.data());
  EXPECT_EQ(records, std::vector<double>(records.size(), 1.5));
}

}  // namespace
}  // namespace pileus::mesh
