// Parcels in flows that are given, against closed forms: rotation, shear, strain, and a flow that
// takes back what it did.
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <vector>

#include "dynamics/prescribed_transport.hpp"
#include "parcels/lattice.hpp"
#include "parcels/upkeep.hpp"

namespace pileus::dynamics {
namespace {

/// Velocity and gradient as functions of place and time, in the order of FlowSamples.
template <int D>
class Given final : public VelocityField<D> {
 public:
  static constexpr std::size_t entries = D + StageJob<D>::gradient_components;
  using Function = std::function<std::array<double, entries>(const std::array<double, D>&, double)>;
  Given(Function function, bool steady) : function_(std::move(function)), steady_(steady) {}

  void match_threads() override {}
  bool steady() const override { return steady_; }
  void sample(double time, std::size_t count, const std::array<const double*, D>& position,
              const FlowSamples<D>& out) override {
    for (std::size_t i = 0; i < count; ++i) {
      std::array<double, D> at;
      for (std::size_t d = 0; d < D; ++d) at[d] = position[d][i];
      const auto flow = function_(at, time);
      for (std::size_t d = 0; d < D; ++d) out.velocity[d][i] = flow[d];
      for (std::size_t c = 0; c < out.gradient.size(); ++c) out.gradient[c][i] = flow[D + c];
    }
  }

 private:
  Function function_;
  bool steady_;
};

class Stored final : public BuoyancySource {
 public:
  const double* buoyancy(parcels::Store& store, double) override { return store.scalar(0); }
};

template <int D>
struct World {
  World(const mesh::Grid<D>& mesh_grid, typename Given<D>::Function flow,
        ShapeIntegrator shape = ShapeIntegrator::exponential, bool steady = true)
      : grid(mesh_grid),
        store(D, {{"buoyancy", "m s-2", parcels::Nature::intensive, "", 0, 0, 0}}),
        transport(grid, std::make_unique<Given<D>>(std::move(flow), steady), carpenter_kennedy_4(),
                  shape, {}),
        upkeep(grid, transport.deposit().tiling(), 0, parcels::SplitCriterion<D>::never()) {
    parcels::fill_lattice<D>(store, grid, {.per_cell = D == 3 ? 8 : 9, .jitter = 0.5, .seed = 3});
    upkeep.reorder(store, transport.offsets(), times);
    for (int d = 0; d < D; ++d)
      start.emplace_back(store.position(d), store.position(d) + store.size());
  }
  void run(int steps, double dt) {
    for (int n = 0; n < steps; ++n) {
      transport.evaluate(store, source, upkeep.tile_begin(), wind, time, times);
      transport.begin_step(store, wind, dt, times);
      transport.finish_step(store, source, upkeep.tile_begin(), wind, time, dt, times);
      time += dt;
    }
  }
  double from_centre(int d, std::size_t p) const {
    const auto i = static_cast<std::size_t>(d);
    return start[i][p] - (grid.lower[i] + 0.5 * grid.extent[i]);
  }

  mesh::Grid<D> grid;
  parcels::Store store;
  PrescribedTransport<D> transport;
  parcels::Upkeep<D> upkeep;
  std::vector<std::vector<double>> start;
  Stored source;
  PhaseTimes times;
  MeanWind wind;
  double time = 0;
};

const mesh::Grid<2> plane({12, 12}, {-1, -1}, {2, 2});
const mesh::Grid<3> space({6, 5, 4}, {-1, -1, -1}, {2, 2, 2});

/// Whether a disc of this radius around the centre contains the parcel at the start.
bool starts_within(const World<2>& world, std::size_t p, double radius) {
  return std::hypot(world.from_centre(0, p), world.from_centre(1, p)) < radius;
}

// u = −Ω z, w = Ω x turns everything by Ω t: the place, and the shape B → R B Rᵀ.
TEST(PrescribedTransport, SolidBodyRotationTurnsPlaceAndShape) {
  const double omega = 1.5;
  const auto rotation = [&](const std::array<double, 2>& x, double) {
    return std::array<double, 5>{-omega * x[1], omega * x[0], 0, -omega, omega};
  };
  for (const ShapeIntegrator shape : {ShapeIntegrator::exponential, ShapeIntegrator::runge_kutta}) {
    World<2> world(plane, rotation, shape);
    const double area = world.store.volume()[0];
    const double a2 = area / M_PI * 2, b2 = area / M_PI / 2;  // λ = 2, lying along x
    for (std::size_t p = 0; p < world.store.size(); ++p) {
      world.store.shape(0)[p] = a2;
      world.store.shape(1)[p] = 0;
      world.store.shape(2)[p] = b2;
    }
    constexpr int steps = 64;
    const double dt = 0.01, angle = omega * steps * dt;
    world.run(steps, dt);
    const double c = std::cos(angle), s = std::sin(angle);
    // The scheme's error per radian is at most (Ω Δt)⁴/120 relative, here 4e-10.
    const double tolerance = 1e-9;
    for (std::size_t p = 0; p < world.store.size(); ++p) {
      if (!starts_within(world, p, 0.95)) continue;
      const double x = world.from_centre(0, p), z = world.from_centre(1, p);
      EXPECT_NEAR(world.store.position(0)[p], c * x - s * z, tolerance);
      EXPECT_NEAR(world.store.position(1)[p], s * x + c * z, tolerance);
      EXPECT_NEAR(world.store.shape(0)[p], c * c * a2 + s * s * b2, tolerance);
      EXPECT_NEAR(world.store.shape(1)[p], c * s * (a2 - b2), tolerance);
      EXPECT_NEAR(world.store.shape(2)[p], s * s * a2 + c * c * b2, tolerance);
    }
    EXPECT_EQ(world.transport.broken_shapes(), 0u);
  }
}

// u = γ z moves by γ z t exactly, and shears a circle of radius r to r² [[1 + γ²t², γt], [γt, 1]].
TEST(PrescribedTransport, ShearStretchesAsItMust) {
  const double gamma = 0.8;
  World<2> world(plane, [&](const std::array<double, 2>& x, double) {
    return std::array<double, 5>{gamma * x[1], 0, 0, gamma, 0};
  });
  world.run(10, 0.25);
  const double g = gamma * 2.5, r2 = world.store.volume()[0] / M_PI;
  for (std::size_t p = 0; p < world.store.size(); ++p) {
    const double moved = world.store.position(0)[p] - world.start[0][p];
    const double turns = (moved - g * world.start[1][p]) / 2;  // the domain is 2 wide
    EXPECT_NEAR(turns, std::round(turns), 1e-13);
    EXPECT_EQ(world.store.position(1)[p], world.start[1][p]);
    EXPECT_NEAR(world.store.shape(0)[p] / r2, 1 + g * g, 1e-12);
    EXPECT_NEAR(world.store.shape(1)[p] / r2, g, 1e-12);
    EXPECT_NEAR(world.store.shape(2)[p] / r2, 1, 1e-12);
  }
}

// u = (a x, b y, −(a + b) z): B = r² diag(e^{2at}, e^{2bt}, e^{−2(a+b)t}), exact for the
// exponential integrator, whose gradient is constant here.
TEST(PrescribedTransport, StrainInSpace) {
  const double a = 0.4, b = -0.1;
  World<3> world(space, [&](const std::array<double, 3>& x, double) {
    return std::array<double, 11>{a * x[0], b * x[1], -(a + b) * x[2], a, 0, 0, 0, b, 0, 0, 0};
  });
  constexpr int diagonal[3] = {0, 3, 5};
  double start[3];  // the same for all, shaped like the cells
  for (int d = 0; d < 3; ++d) start[d] = world.store.shape(diagonal[d])[0];
  world.run(20, 0.05);
  const double due[3] = {std::exp(2 * a), std::exp(2 * b), std::exp(-2 * (a + b))};
  for (std::size_t p = 0; p < world.store.size(); ++p) {
    for (int d = 0; d < 3; ++d) {
      EXPECT_NEAR(world.store.shape(diagonal[d])[p] / start[d], due[d], 1e-11);
      const double x = world.start[static_cast<std::size_t>(d)][p] * std::sqrt(due[d]);
      // (0.4 · 0.05)⁴/120 per unit of time.
      if (std::abs(x) >= 1) continue;
      EXPECT_NEAR(world.store.position(d)[p], x, 2e-9);
    }
  }
}

/// A vortex that turns one way and back: u(x, t) = −u(x, T − t), T = 4.
std::array<double, 5> back_and_forth(const std::array<double, 2>& x, double t) {
  const double k = M_PI, f = 0.3 * std::cos(M_PI * t / 4);
  const double sx = std::sin(k * x[0]), cx = std::cos(k * x[0]);
  const double sz = std::sin(k * (x[1] + 1) / 2), cz = std::cos(k * (x[1] + 1) / 2);
  // ψ = sin(k x) sin(k (z + 1)/2)/k, u = −ψ_z, w = ψ_x
  return {-f * 0.5 * sx * cz, f * cx * sz, -f * 0.5 * k * cx * cz, f * 0.25 * k * sx * sz,
          -f * k * sx * sz};
}

double largest_return_error(int steps) {
  World<2> world(plane, back_and_forth, ShapeIntegrator::exponential, false);
  const double r2 = world.store.volume()[0] / M_PI;
  world.run(steps / 2, 4.0 / steps);
  double moved = 0, error = 0;
  for (std::size_t p = 0; p < world.store.size(); ++p)
    moved = std::max(moved, std::abs(world.store.position(1)[p] - world.start[1][p]));
  EXPECT_GT(moved, 0.3);
  world.run(steps / 2, 4.0 / steps);
  for (std::size_t p = 0; p < world.store.size(); ++p) {
    for (int d = 0; d < 2; ++d) {
      const double e = world.store.position(d)[p] - world.start[static_cast<std::size_t>(d)][p];
      error = std::max(error, std::abs(d == 0 ? e - 2 * std::round(e / 2) : e));
    }
    error = std::max({error, std::abs(world.store.shape(0)[p] / r2 - 1),
                      std::abs(world.store.shape(1)[p] / r2)});
  }
  return error;
}

// Places and shapes come back, up to the scheme's error of the fourth order.
TEST(PrescribedTransport, WhatIsDoneIsUndone) {
  const double coarse = largest_return_error(40), fine = largest_return_error(80);
  EXPECT_LT(coarse, 1e-4);
  EXPECT_GT(std::log2(coarse / fine), 3.7) << coarse << " " << fine;
}

// The summary is that of the flow at the nodes: |w| = f at x = ±1, z = 0, the strain rate largest
// where the two shears add up.
TEST(PrescribedTransport, SummaryAndMeshHoldTheFlow) {
  World<2> world(plane, back_and_forth, ShapeIntegrator::exponential, false);
  const mesh::FlowSummary& summary = world.transport.evaluate(
      world.store, world.source, world.upkeep.tile_begin(), world.wind, 0, world.times);
  EXPECT_NEAR(summary.speed[1], 0.3, 1e-12);
  EXPECT_NEAR(summary.speed[0], 0.15, 1e-12);
  EXPECT_NEAR(summary.vorticity, 0.3 * 1.25 * M_PI, 1e-12);
  EXPECT_NEAR(summary.strain, 0.3 * 0.5 * M_PI, 1e-12);
  const double* record =
      world.transport.flow() + plane.node(plane.column(9, 0), 3) * mesh::FlowRecord<2>::width;
  const auto due = back_and_forth({plane.lower[0] + 9 * plane.spacing[0], -0.5}, 0);
  for (std::size_t c = 0; c < 5; ++c) EXPECT_EQ(record[c], due[c]);
  // The lattice fills the cells evenly, to the jitter's error.
  EXPECT_NEAR(world.transport.deposited()[plane.node(5, 6) * mesh::DepositRecord<2>::width],
              plane.cell_volume(), 0.5 * plane.cell_volume());
}

TEST(PrescribedTransport, SameBitsOnAnyThreads) {
  std::vector<std::vector<double>> ends;
  for (const int threads : {1, 2, 3}) {
    omp_set_num_threads(threads);
    World<2> world(plane, back_and_forth, ShapeIntegrator::exponential, false);
    world.run(5, 0.1);
    std::vector<double>& end = ends.emplace_back();
    for (int c = 0; c < world.store.column_count(); ++c)
      end.insert(end.end(), world.store.column(c), world.store.column(c) + world.store.size());
  }
  omp_set_num_threads(2);
  EXPECT_EQ(ends[1], ends[0]);
  EXPECT_EQ(ends[2], ends[0]);
}

}  // namespace
}  // namespace pileus::dynamics
