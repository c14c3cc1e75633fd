// The stage kernels on random input: three instruction sets alike, the same bits for any ranges,
// the transpose of the deposit, and no harm from values that are not numbers.
#include <gtest/gtest.h>

#include <limits>

#include "../../unit/dynamics/stage_fixture.hpp"

namespace pileus::dynamics {
namespace {

using testing::Stage;
using testing::stage_tables;

template <int D>
mesh::Grid<D> box();
template <>
mesh::Grid<3> box<3>() {
  return {{12, 10, 7}, {-1, 0, 2}, {1.2, 1, 0.7}};
}
template <>
mesh::Grid<2> box<2>() {
  return {{12, 7}, {-1, 2}, {1.2, 0.7}};
}

/// A stage of a step through a random flow, increments of an earlier stage included.
template <int D>
std::vector<double> random_stage(const Kernels& table, ShapeIntegrator shape, std::size_t chunk,
                                 bool first, bool last) {
  Stage<D> stage(box<D>(), 1003, 3, 11);
  testing::Random random(12);
  for (std::size_t i = 0; i < stage.flow.size(); ++i)
    stage.flow[i] = testing::uniform(random, -1, 1);
  for (auto& a : stage.increment)
    for (std::size_t p = 0; p < a.size(); ++p) a[p] = testing::uniform(random, -1, 1);
  stage.update_offsets();
  stage.job.evaluate_only = false;
  stage.job.first = first;
  stage.job.last = last;
  stage.job.keep = -0.7;
  stage.job.advance = 0.3;
  stage.job.shape_integrator = shape;
  stage.run(table, chunk);
  EXPECT_EQ(stage.broken, 0u);
  return stage.everything();
}

template <int D>
void expect_agreement() {
  for (const auto shape : {ShapeIntegrator::exponential, ShapeIntegrator::runge_kutta})
    for (const bool first : {true, false})
      for (const bool last : {true, false}) {
        if (last && shape == ShapeIntegrator::runge_kutta) continue;  // 0.3 may break shapes
        const auto reference =
            random_stage<D>(baseline::dynamics_kernels, shape, 1u << 30, first, last);
        for (const auto* table : stage_tables()) {
          const auto whole = random_stage<D>(*table, shape, 1u << 30, first, last);
          double largest = 0;
          for (std::size_t i = 0; i < whole.size(); ++i)
            largest = std::max(largest, std::abs(whole[i] - reference[i]));
          EXPECT_LT(largest, 1e-13);
          for (const std::size_t chunk : {8ul, 16ul, 504ul, 1000ul}) {
            const auto cut = random_stage<D>(*table, shape, chunk, first, last);
            EXPECT_EQ(std::memcmp(cut.data(), whole.data(), whole.size() * sizeof(double)), 0)
                << chunk;
          }
        }
      }
}
TEST(StageProperty, InstructionSetsAgreeInSpace) {
  expect_agreement<3>();
}
TEST(StageProperty, InstructionSetsAgreeInThePlane) {
  expect_agreement<2>();
}

// A parcel's result must not depend on which lane of a vector it sits in, nor on its neighbours.
TEST(StageProperty, NeighboursInMemoryDoNotMatter) {
  for (const auto* table : stage_tables()) {
    Stage<3> forward(box<3>(), 203, 3, 13), backward(box<3>(), 203, 3, 13);
    testing::Random random(14);
    for (std::size_t i = 0; i < forward.flow.size(); ++i)
      forward.flow[i] = backward.flow[i] = testing::uniform(random, -1, 1) * (i % 7 == 0 ? 30 : 1);
    std::vector<std::uint32_t> reversed(203);
    for (std::uint32_t p = 0; p < 203; ++p) reversed[p] = 202 - p;
    AlignedArray<double> spare;
    backward.store.gather(reversed, spare);
    for (auto* stage : {&forward, &backward}) {
      stage->update_offsets();
      stage->job.evaluate_only = stage->job.last = false;
      stage->job.advance = 0.2;
      stage->run(*table);
    }
    for (int c = 0; c < forward.store.state_columns(); ++c)
      for (std::size_t p = 0; p < 203; ++p)
        EXPECT_EQ(forward.store.column(c)[p], backward.store.column(c)[202 - p]);
  }
}

// Interpolation is the transpose of the deposit: Σ V_p (f interpolated) = Σ c_g V_g f_g, when
// beyond the walls f is the mirror image that the folding of the deposit stands for.
template <int D>
void expect_transpose() {
  Stage<D> stage(box<D>(), 3000, 4, 15);
  testing::Random random(16);
  const auto& grid = stage.grid;
  constexpr std::size_t width = Stage<D>::width;
  for (std::size_t i = 0; i < stage.flow.size(); ++i)
    stage.flow[i] = testing::uniform(random, -1, 1);
  for (std::size_t c = 0; c < grid.columns(); ++c)
    for (std::size_t f = 0; f < width; ++f) {
      stage.flow[grid.node(c, -1) * width + f] = stage.flow[grid.node(c, 1) * width + f];
      stage.flow[grid.node(c, grid.nz() + 1) * width + f] =
          stage.flow[grid.node(c, grid.nz() - 1) * width + f];
    }
  stage.update_offsets();
  stage.run(kernels());
  parcels::Deposit<D> deposit(grid);
  // All parcels in the first tile's range: the others are strays of it.
  std::vector<std::size_t> tile_begin(deposit.tiling().tiles().size() + 1, 3000);
  tile_begin[0] = 0;
  AlignedArray<double> volume(grid.nodes());
  deposit.volume(stage.store, stage.offsets, tile_begin, volume.data());
  for (int f = 0; f < D; ++f) {
    double parcels_sum = 0, mesh_sum = 0, scale = 0;
    for (std::size_t p = 0; p < 3000; ++p)
      parcels_sum += stage.store.volume()[p] * stage.increment[static_cast<std::size_t>(f)][p];
    for (std::size_t c = 0; c < grid.columns(); ++c)
      for (int k = 0; k <= grid.nz(); ++k) {
        const double weight = (k == 0 || k == grid.nz() ? 0.5 : 1) * volume[grid.node(c, k)];
        mesh_sum += weight * stage.flow[grid.node(c, k) * width + static_cast<std::size_t>(f)];
        scale += weight;
      }
    EXPECT_NEAR(parcels_sum, mesh_sum, 1e-13 * scale);
  }
}
TEST(StageProperty, InterpolationIsTheTransposeOfTheDeposit) {
  expect_transpose<3>();
  expect_transpose<2>();
}

template <int D>
void survive(const Kernels& table, ShapeIntegrator shape) {
  constexpr double inf = std::numeric_limits<double>::infinity();
  constexpr double hostile[] = {
      std::numeric_limits<double>::quiet_NaN(), inf, -inf, 0.0, -1.0, 1e300, -1e300, 1e30};
  testing::Random random(17);
  for (int draw = 0; draw < 50; ++draw) {
    Stage<D> stage(box<D>(), 203, 3, 18);
    stage.fill_flow([](const auto& x, int f) { return x[0] * f; });
    for (std::size_t p = 0; p < 203; p += 2)
      stage.store.column(static_cast<int>(random() % unsigned(stage.store.state_columns())))[p] =
          hostile[random() % std::size(hostile)];
    stage.job.evaluate_only = false;
    stage.job.advance = 0.1;
    stage.job.shape_integrator = shape;
    stage.update_offsets();
    stage.run(table);
    stage.update_offsets();
    stage.run(table);
    for (std::size_t p = 1; p < 203; p += 2)
      for (int d = 0; d < D; ++d) EXPECT_TRUE(std::isfinite(stage.store.position(d)[p]));
  }
}
TEST(StageProperty, SurvivesValuesThatAreNotNumbers) {
  for (const auto* table : stage_tables())
    for (const auto shape : {ShapeIntegrator::exponential, ShapeIntegrator::runge_kutta}) {
      survive<3>(*table, shape);
      survive<2>(*table, shape);
    }
}

}  // namespace
}  // namespace pileus::dynamics
