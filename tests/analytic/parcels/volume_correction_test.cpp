// How fast the volume correction converges, against the method's table (dossier 9.3): 32² cells of
// a unit box, four circles per cell jittered by a quarter cell, mean over five seeds.
#include <gtest/gtest.h>

#include <cmath>

#include "parcels/correction.hpp"
#include "parcels/lattice.hpp"
#include "parcels/upkeep.hpp"

namespace pileus::parcels {
namespace {

/// Mean |V/V_cell − 1| over the nodes before (iterations = 0) or after the correction.
double mean_error(int iterations) {
  const mesh::Grid<2> grid({32, 32}, {0, 0}, {1, 1});
  double sum = 0;
  std::size_t nodes = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    Store store(2, {});
    fill_lattice<2>(store, grid, {.per_cell = 4, .jitter = 0.5, .seed = seed});
    Deposit<2> deposit(grid);
    SupportOffsets<2> offsets;
    Upkeep<2> upkeep(grid, deposit.tiling(), 0, SplitCriterion<2>::make(grid, 4, 2.89));
    PhaseTimes times;
    upkeep.reorder(store, offsets, times);
    offsets.update(store);
    CorrectionControl control;
    control.iterations = iterations;
    if (iterations > 0)
      VolumeCorrection<2>(grid, control).run(store, offsets, upkeep.tile_begin(), deposit);
    AlignedArray<double> volume(grid.nodes());
    deposit.volume(store, offsets, upkeep.tile_begin(), volume.data());
    for (std::size_t c = 0; c < grid.columns(); ++c)
      for (int k = 0; k <= grid.nz(); ++k, ++nodes)
        sum += std::abs(volume[grid.node(c, k)] / grid.cell_volume() - 1);
  }
  return sum / static_cast<double>(nodes);
}

// Acceptance 13: the table within ±20 %.
TEST(VolumeCorrection, ConvergesAsTabulated) {
  EXPECT_NEAR(mean_error(0) / 9.5e-2, 1, 0.2);
  EXPECT_NEAR(mean_error(1) / 1.6e-2, 1, 0.2);
  EXPECT_NEAR(mean_error(2) / 3.5e-3, 1, 0.2);
  EXPECT_NEAR(mean_error(3) / 9.1e-4, 1, 0.2);
}
// Geometric convergence by a factor of three to five an iteration: the far end of the table within
// a factor of the seeds' scatter.
TEST(VolumeCorrection, ConvergesGeometrically) {
  const double five = mean_error(5), ten = mean_error(10);
  EXPECT_LT(five, 8.0e-5 * 2);
  EXPECT_LT(ten, 3.9e-7 * 3);
  EXPECT_GT(std::pow(five / ten, 0.2), 2.5);
}

}  // namespace
}  // namespace pileus::parcels
