// Whole steps of the transport: rest, a uniform wind, the budget of the net vorticity, and the same
// bits for any number of threads.
#include <gtest/gtest.h>
#include <omp.h>

#include <cstring>

#include "../../unit/parcels/parcel_cloud.hpp"
#include "dynamics/transport.hpp"
#include "parcels/lattice.hpp"
#include "parcels/upkeep.hpp"

namespace pileus::dynamics {
namespace {

/// Buoyancy as the stored first scalar.
class Stored final : public BuoyancySource {
 public:
  const double* buoyancy(parcels::Store& store, double) override { return store.scalar(0); }
};

template <int D>
struct World {
  World(const mesh::Grid<D>& mesh_grid, double coriolis, ShapeIntegrator shape, double jitter)
      : grid(mesh_grid),
        store(D, {{"buoyancy", "m s-2", parcels::Nature::intensive, "", 0, 0, 0}}),
        transport(grid, {}, coriolis, carpenter_kennedy_4(), shape, 3.0 / 64, {}),
        upkeep(grid, transport.deposit().tiling(), 0,
               parcels::SplitCriterion<D>::make(grid, 4, 2.89)) {
    parcels::fill_lattice<D>(store, grid,
                             {.per_cell = D == 3 ? 8 : 9, .jitter = jitter, .seed = 3});
    upkeep.reorder(store, transport.offsets(), times);
  }
  void step(double dt) {
    transport.evaluate(store, source, upkeep.tile_begin(), wind, time, times);
    transport.begin_step(store, wind, dt, times);
    transport.finish_step(store, source, upkeep.tile_begin(), wind, time, dt, times);
    time += dt;
  }
  double mean(const double* value) const {
    long double sum = 0, volume = 0;
    for (std::size_t p = 0; p < store.size(); ++p) {
      sum += static_cast<long double>(store.volume()[p]) * value[p];
      volume += store.volume()[p];
    }
    return static_cast<double>(sum / volume);
  }

  mesh::Grid<D> grid;
  parcels::Store store;
  Transport<D> transport;
  parcels::Upkeep<D> upkeep;
  Stored source;
  PhaseTimes times;
  MeanWind wind;
  double time = 0;
};

const mesh::Grid<3> space({20, 10, 6}, {0, 0, 0}, {2, 1, 0.6});

// Nothing happens to a fluid at rest, bit by bit.
TEST(Transport, RestStaysRest) {
  World<3> world(space, 0, ShapeIntegrator::exponential, 0.5);
  const std::vector<double> x(world.store.position(0), world.store.position(0) + 9600);
  for (int step = 0; step < 3; ++step) world.step(1);
  for (std::size_t p = 0; p < x.size(); ++p) {
    EXPECT_EQ(world.store.position(0)[p], x[p]);
    EXPECT_EQ(world.store.vorticity(0)[p], 0);
  }
  EXPECT_EQ(world.transport.broken_shapes(), 0u);
}

// A uniform wind carries every parcel by U t around the periodic domain, shapes untouched; with
// rotation it turns inertially: U(t) = U (cos ft, −sin ft), displacement U (sin ft, cos ft − 1)/f.
TEST(Transport, UniformWindAndInertialOscillation) {
  for (const double f : {0.0, 2.0}) {
    World<3> world(space, f, ShapeIntegrator::exponential, 0.5);
    world.wind.velocity = {1.5, 0};
    std::vector<double> x(world.store.position(0), world.store.position(0) + 9600),
        y(world.store.position(1), world.store.position(1) + 9600);
    constexpr int steps = 16;
    const double dt = 0.05, t = steps * dt;
    for (int step = 0; step < steps; ++step) world.step(dt);
    const double due_x = f == 0 ? 1.5 * t : 1.5 * std::sin(f * t) / f;
    const double due_y = f == 0 ? 0.0 : 1.5 * (std::cos(f * t) - 1) / f;
    // Fourth order: (f Δt)⁴ = 1e-4 per period of phase, with the scheme's constant of some 1e-3.
    const double tolerance = f == 0 ? 1e-12 : 1e-6;
    for (std::size_t p = 0; p < x.size(); ++p) {
      const double dx = (world.store.position(0)[p] - x[p] - due_x) / 2,
                   dy = world.store.position(1)[p] - y[p] - due_y;
      EXPECT_NEAR(dx, std::round(dx), tolerance);
      EXPECT_NEAR(dy, std::round(dy), tolerance);
    }
    EXPECT_NEAR(world.wind.velocity[0], 1.5 * std::cos(f * t), tolerance);
    EXPECT_NEAR(world.wind.velocity[1], -1.5 * std::sin(f * t), tolerance);
  }
}

/// A stirred state: vorticity and buoyancy of a few waves.
template <int D>
void stir(World<D>& world) {
  const double two_pi = 2 * std::numbers::pi;
  for (std::size_t p = 0; p < world.store.size(); ++p) {
    const double x = world.store.position(0)[p], z = world.store.position(D - 1)[p];
    const double y = D == 3 ? world.store.position(1)[p] : 0;
    for (int c = 0; c < world.store.vorticity_components(); ++c)
      world.store.vorticity(c)[p] = std::sin(two_pi * (x / 2 + y * c) + c) * std::cos(5 * z + c);
    world.store.scalar(0)[p] = std::sin(two_pi * x / 2) * std::cos(3 * z);
  }
}

// With ζ zero in the mean and no rotation the mean horizontal vorticity changes only by the walls'
// flux of ζ u_h (dossier 5.4); in the plane not at all when ∂b/∂x has no mean.
TEST(Transport, MeanVorticityOfThePlaneIsConserved) {
  World<2> world(mesh::Grid<2>({40, 10}, {0, 0}, {2, 0.5}), 0, ShapeIntegrator::exponential, 0.5);
  stir(world);
  const double before = world.mean(world.store.vorticity(0));
  for (int step = 0; step < 5; ++step) world.step(0.02);
  EXPECT_NEAR(world.mean(world.store.vorticity(0)), before, 1e-14);
}

// Conserved bitwise on every parcel: buoyancy and volume are never touched by transport; shapes
// enclose the volume after every step.
TEST(Transport, AttributesAreCarriedUnchanged) {
  for (const auto shape : {ShapeIntegrator::exponential, ShapeIntegrator::runge_kutta}) {
    World<3> world(space, 0, shape, 0.5);
    stir(world);
    const std::vector<double> b(world.store.scalar(0), world.store.scalar(0) + 9600),
        v(world.store.volume(), world.store.volume() + 9600);
    for (int step = 0; step < 3; ++step) world.step(0.05);
    for (std::size_t p = 0; p < b.size(); ++p) {
      EXPECT_EQ(world.store.scalar(0)[p], b[p]);
      EXPECT_EQ(world.store.volume()[p], v[p]);
      EXPECT_NEAR(testing::get_shape<3>(world.store, p).determinant() /
                      testing::squared_axes_product<3>(v[p]),
                  1, 1e-12);
      EXPECT_GE(world.store.position(2)[p], 0);
      EXPECT_LE(world.store.position(2)[p], 0.6);
    }
    EXPECT_EQ(world.transport.broken_shapes(), 0u);
  }
}

template <int D>
void expect_same_bits(const mesh::Grid<D>& grid) {
  const int before = omp_get_max_threads();
  std::vector<double> first;
  for (const int threads : {1, 2, 3}) {
    omp_set_num_threads(threads);
    World<D> world(grid, 0.3, ShapeIntegrator::exponential, 0.5);
    stir(world);
    for (int step = 0; step < 3; ++step) world.step(0.05);
    std::vector<double> state;
    for (int c = 0; c < world.store.state_columns(); ++c)
      state.insert(state.end(), world.store.column(c), world.store.column(c) + world.store.size());
    if (first.empty()) first = state;
    EXPECT_EQ(std::memcmp(state.data(), first.data(), state.size() * sizeof(double)), 0) << threads;
  }
  omp_set_num_threads(before);
}
TEST(Transport, SameBitsForAnyNumberOfThreads) {
  expect_same_bits<3>(space);
  expect_same_bits<2>(mesh::Grid<2>({40, 10}, {0, 0}, {2, 0.5}));
}

}  // namespace
}  // namespace pileus::dynamics
