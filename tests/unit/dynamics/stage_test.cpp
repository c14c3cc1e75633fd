// The stage kernel: what it interpolates, and whole steps in flows whose solution is known.
#include <gtest/gtest.h>

#include "parcels/ellipsoid.hpp"
#include "stage_fixture.hpp"

namespace pileus::dynamics {
namespace {

using testing::Stage;
using testing::stage_tables;

// Dossier 3.5: constants exact to 1e-15, for any shape, everywhere.
TEST(StageKernel, ConstantsAreExact) {
  for (const auto* table : stage_tables()) {
    Stage<3> space({{7, 5, 9}, {0, 0, 0}, {1, 1, 1}}, 500, 10, 1);
    space.fill_flow([](const auto&, int f) { return 1.0 + f; });
    space.update_offsets();
    space.run(*table);
    const int record[] = {0, 1, 2, 11, 12, 13, 3, 4, 5, 6, 7, 8, 9, 10};
    for (std::size_t c = 0; c < std::size(record); ++c)
      for (std::size_t p = 0; p < 500; ++p)
        EXPECT_NEAR(space.increment[c][p], 1.0 + record[c], 1e-15 * (1 + record[c]) * 4);
    Stage<2> plane({{7, 9}, {0, 0}, {1, 1}}, 500, 10, 1);
    plane.fill_flow([](const auto&, int f) { return 1.0 + f; });
    plane.update_offsets();
    plane.run(*table);
    const int record_2[] = {0, 1, 5, 2, 3, 4};
    for (std::size_t c = 0; c < std::size(record_2); ++c)
      for (std::size_t p = 0; p < 500; ++p)
        EXPECT_NEAR(plane.increment[c][p], 1.0 + record_2[c], 4e-15 * (1 + record_2[c]));
  }
}

// Dossier 3.5: linear fields exact for any shape: the mean of a linear function over the support
// points is its value at the centre. Away from the seam, where a linear field jumps; across the
// walls as far as the halo level reaches.
TEST(StageKernel, LinearFieldsAreExact) {
  const double slope[3] = {0.7, -1.3, 0.4};
  for (const auto* table : stage_tables()) {
    Stage<3> stage({{16, 16, 8}, {-1, -1, -1}, {2, 2, 1}}, 600, 3, 2);
    for (std::size_t p = 0; p < stage.store.size(); ++p)
      for (int d = 0; d < 2; ++d) stage.store.position(d)[p] *= 0.5;
    stage.fill_flow([&](const auto& x, int f) {
      return 2 + f * (slope[0] * x[0] + slope[1] * x[1] + slope[2] * x[2]);
    });
    stage.update_offsets();
    stage.run(*table);
    for (std::size_t p = 0; p < stage.store.size(); ++p) {
      double value = 0;
      for (int d = 0; d < 3; ++d) value += slope[d] * stage.store.position(d)[p];
      EXPECT_NEAR(stage.increment[1][p], 2 + value, 1e-14);
      EXPECT_NEAR(stage.increment[5][p], 2 + 13 * value, 2e-13);
    }
  }
}

// Any quadratic is off by (c²/10)∇²φ (3D) or (b²/8)∇²φ (2D) less than the mean over the ellipsoid
// (dossier 3.1) plus the tent's own part; here against the plain sum over support points.
TEST(StageKernel, RandomFieldsAgainstThePlainSum) {
  for (const auto* table : stage_tables()) {
    Stage<3> stage({{7, 5, 9}, {0, 0, 0}, {1, 2, 1.5}}, 700, 4, 3);
    testing::Random random(4);
    for (std::size_t i = 0; i < stage.flow.size(); ++i)
      stage.flow[i] = testing::uniform(random, -1, 1);
    stage.update_offsets();
    stage.run(*table);
    for (std::size_t p = 0; p < stage.store.size(); ++p) {
      double u = 0, last = 0;
      for (const auto& x : testing::support_points<3>(stage.store, p))
        for (const auto& [node, w] : testing::weights_around<3>(stage.grid, x)) {
          u += 0.25 * w * stage.flow[node * 16];
          last += 0.25 * w * stage.flow[node * 16 + 13];
        }
      EXPECT_NEAR(stage.increment[0][p], u, 1e-12);
      EXPECT_NEAR(stage.increment[5][p], last, 1e-12);
    }
    Stage<2> plane({{7, 9}, {0, 0}, {1, 1.5}}, 700, 4, 3);
    for (std::size_t i = 0; i < plane.flow.size(); ++i)
      plane.flow[i] = testing::uniform(random, -1, 1);
    plane.update_offsets();
    plane.run(*table);
    for (std::size_t p = 0; p < plane.store.size(); ++p) {
      double w_x = 0;
      for (const auto& x : testing::support_points<2>(plane.store, p))
        for (const auto& [node, w] : testing::weights_around<2>(plane.grid, x))
          w_x += 0.5 * w * plane.flow[node * 8 + 4];
      EXPECT_NEAR(plane.increment[5][p], w_x, 1e-12);
    }
  }
}

TEST(StageKernel, EvaluatingLeavesTheStateAlone) {
  Stage<3> stage({{7, 5, 9}, {0, 0, 0}, {1, 1, 1}}, 501, 4, 5);
  stage.fill_flow([](const auto& x, int f) { return x[2] + f; });
  stage.update_offsets();
  std::vector<double> before;
  for (int c = 0; c < stage.store.state_columns(); ++c)
    before.insert(before.end(), stage.store.column(c), stage.store.column(c) + 501);
  for (const auto* table : stage_tables()) {
    stage.run(*table);
    const auto after = stage.everything();
    EXPECT_EQ(std::memcmp(before.data(), after.data(), before.size() * sizeof(double)), 0);
  }
}

/// Steps of a scheme in a steady flow on the mesh.
template <int D>
void advance(Stage<D>& stage, const LowStorageScheme& scheme, double dt, int steps,
             ShapeIntegrator shape, const Kernels& table) {
  stage.job.evaluate_only = false;
  stage.job.shape_integrator = shape;
  for (int step = 0; step < steps; ++step)
    for (std::size_t s = 0; s < scheme.stages(); ++s) {
      stage.job.keep = scheme.a[s];
      stage.job.advance = scheme.b[s] * dt;
      stage.job.first = s == 0;
      stage.job.last = s + 1 == scheme.stages();
      stage.update_offsets();
      stage.run(table);
    }
}

// Shear u = γ z, v = δ z, linear on the mesh, so the kernels are exact in space: x(t) = x + γ z t,
// B(t) = E B Eᵀ with E = I + t S, S² = 0. The polynomial is exact for nilpotent S; dB/dt by
// Runge–Kutta is a polynomial of degree two in t, exact for order ≥ 3 up to rounding.
TEST(StageKernel, ShearIsExact) {
  const double gamma = 0.8, delta = -0.5, dt = 0.25;
  const int steps = 6;
  for (const auto* table : stage_tables())
    for (const auto shape : {ShapeIntegrator::exponential, ShapeIntegrator::runge_kutta})
      for (const auto* scheme : {&williamson_3(), &carpenter_kennedy_4()}) {
        Stage<3> stage({{4, 4, 8}, {0, 0, 0}, {100, 100, 4}}, 203, 2, 6);
        for (std::size_t p = 0; p < 203; ++p) {
          stage.store.position(2)[p] = 1.5 + 1.0 / 203 * static_cast<double>(p);
          stage.store.volume()[p] = 0.05;
          testing::Random random(p);
          testing::put_shape<3>(stage.store, p,
                                testing::random_shape_of_volume<3>(random, 0.05, 2));
        }
        stage.fill_flow([&](const auto& x, int f) {
          using R = mesh::FlowRecord<3>;
          return f == R::u                    ? gamma * x[2]
                 : f == R::v                  ? delta * x[2]
                 : f == R::u_z                ? gamma
                 : f == R::v_z                ? delta
                 : f >= R::tendency && f < 14 ? 0.1 * (f - 10)
                                              : 0.0;
        });
        const parcels::Store start = [&] {
          parcels::Store copy(3, {});
          copy.resize(203);
          for (int c = 0; c < copy.column_count(); ++c)
            std::copy(stage.store.column(c), stage.store.column(c) + 203, copy.column(c));
          return copy;
        }();
        advance(stage, *scheme, dt, steps, shape, *table);
        const double t = dt * steps;
        Eigen::Matrix3d e = Eigen::Matrix3d::Identity();
        e(0, 2) = gamma * t;
        e(1, 2) = delta * t;
        for (std::size_t p = 0; p < 203; ++p) {
          const double z = start.position(2)[p];
          EXPECT_NEAR(stage.store.position(0)[p], start.position(0)[p] + gamma * z * t, 1e-11);
          EXPECT_NEAR(stage.store.position(1)[p], start.position(1)[p] + delta * z * t, 1e-11);
          EXPECT_NEAR(stage.store.position(2)[p], z, 1e-15);
          for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(stage.store.vorticity(c)[p], start.vorticity(c)[p] + 0.1 * (c + 1) * t,
                        1e-11);
          const Eigen::Matrix3d b = testing::get_shape<3>(start, p), exact = e * b * e.transpose();
          EXPECT_LT((testing::get_shape<3>(stage.store, p) - exact).norm(), 1e-11 * exact.norm());
        }
        EXPECT_EQ(stage.broken, 0u);
      }
}

// In the plane the circle of dossier 2.4 (iii): λ = 4 exactly at γt = 1.5.
TEST(StageKernel, AShearedCircleReachesAspectRatioFour) {
  for (const auto* table : stage_tables())
    for (const auto shape : {ShapeIntegrator::exponential, ShapeIntegrator::runge_kutta}) {
      Stage<2> stage({{4, 8}, {0, 0}, {100, 4}}, 11, 1, 7);
      for (std::size_t p = 0; p < 11; ++p) {
        stage.store.position(1)[p] = 2;
        stage.store.volume()[p] = 0.05 * std::numbers::pi;
        testing::put_shape<2>(stage.store, p, 0.05 * Eigen::Matrix2d::Identity());
      }
      stage.fill_flow([](const auto& x, int f) {
        return f == mesh::FlowRecord<2>::u ? x[1] : f == mesh::FlowRecord<2>::u_z ? 1.0 : 0.0;
      });
      advance(stage, carpenter_kennedy_4(), 0.15, 10, shape, *table);
      for (std::size_t p = 0; p < 11; ++p) {
        const auto axes = baseline::principal_axes(baseline::Symmetric2<double>{
            stage.store.shape(0)[p], stage.store.shape(1)[p], stage.store.shape(2)[p]});
        EXPECT_NEAR(std::sqrt(axes.a2 / axes.b2), 4, 1e-11);
        EXPECT_NEAR(axes.a2 * axes.b2, 0.05 * 0.05, 1e-16);
      }
    }
}

// The last stage restores det B = (3V/4π)² whatever happened before; shapes that are no longer
// positive definite are blunted, spheres where nothing is left to tell a direction, and counted,
// once each, none beyond the end of the range.
TEST(StageKernel, ClosesShapesAndResetsBrokenOnes) {
  const std::size_t count = 29;
  for (const auto* table : stage_tables()) {
    Stage<3> stage({{4, 4, 4}, {0, 0, 0}, {1, 1, 1}}, count, 2, 8);
    for (std::size_t p = 0; p < count; ++p) {
      const double factor = p % 4 == 1 ? 1.02 : p % 4 == 2 ? 3.0 : 1.0;
      for (int c = 0; c < 6; ++c) stage.store.shape(c)[p] *= factor;
      if (p % 4 == 3) stage.store.shape(5)[p] *= -1;
      if (p == 4) stage.store.shape(1)[p] = std::numeric_limits<double>::quiet_NaN();
    }
    stage.update_offsets();
    stage.job.evaluate_only = false;
    stage.job.first = stage.job.last = true;
    stage.job.advance = 0.1;
    stage.run(*table);
    EXPECT_EQ(stage.broken, 7u + 1u);
    for (std::size_t p = 0; p < count; ++p) {
      const double target = testing::squared_axes_product<3>(stage.store.volume()[p]);
      const auto b = testing::get_shape<3>(stage.store, p);
      // The determinant of a shape as flat as the limit, 100, is known to 1e-16·100².
      EXPECT_NEAR(b.determinant() / target, 1, p % 4 == 3 ? 1e-11 : 1e-13) << p;
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(b);
      EXPECT_GT(axes.eigenvalues()(0), 0.9999e-4 * axes.eigenvalues()(2)) << p;
      if (p == 4) {
        EXPECT_LT((b - std::cbrt(target) * Eigen::Matrix3d::Identity()).norm(), 1e-15);
      }
    }
  }
}

// Whoever else deforms parcels leaves healthy ones alone: to the bit, whatever lies beside them.
TEST(StageKernel, BluntsBrokenShapesAndNoOthers) {
  const std::size_t count = 29;
  for (const auto* table : stage_tables()) {
    Stage<3> stage({{4, 4, 4}, {0, 0, 0}, {1, 1, 1}}, count, 2, 8);
    for (int c = 0; c < 6; ++c) stage.store.shape(c)[2] *= 1.02;  // a determinant that is off
    for (std::size_t p = 3; p < count; p += 4) stage.store.shape(5)[p] *= -1;
    std::vector<Eigen::Matrix3d> before;
    for (std::size_t p = 0; p < count; ++p) before.push_back(testing::get_shape<3>(stage.store, p));
    ShapeJob<3> job{};
    for (int c = 0; c < 6; ++c) job.shape[c] = stage.store.shape(c);
    job.size_volume = stage.store.size_volume();
    job.aspect_limit = 100;
    job.end = count;
    table->blunt_shapes_3d(job);
    EXPECT_EQ(job.broken, 7u);
    for (std::size_t p = 0; p < count; ++p) {
      const auto b = testing::get_shape<3>(stage.store, p);
      const double target = testing::squared_axes_product<3>(stage.store.volume()[p]);
      if (p % 4 == 3)
        EXPECT_NEAR(b.determinant() / target, 1, 1e-11) << p;
      else
        EXPECT_EQ(b, before[p]) << p;
    }
  }
}

// Steps far too long stretch parcels by e^20 and more: whatever comes, the shape is positive
// definite, encloses its volume and is at most as thin as the limit (scenes reference 9, case 7).
template <int D>
void expect_blunt_after(const mesh::Grid<D>& grid, double strain, double spread) {
  for (const auto* table : stage_tables()) {
    Stage<D> stage(grid, 1000, spread, 8);
    testing::Random random(3);
    for (std::size_t i = 0; i < stage.flow.size(); ++i)
      stage.flow[i] = strain * testing::uniform(random, -1, 1);
    stage.update_offsets();
    stage.job.evaluate_only = false;
    stage.job.first = stage.job.last = true;
    stage.job.advance = 1;
    stage.run(*table);
    for (std::size_t p = 0; p < stage.store.size(); ++p) {
      const Eigen::Matrix<double, D, D> b = testing::get_shape<D>(stage.store, p);
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, D, D>> axes(b);
      // Needles are at most 100 times as long as wide, discs 100²/√8 times; a needle's determinant
      // is known to 1e-16·100⁴.
      const double thinnest = D == 3 ? 8e-8 : 1e-4;
      ASSERT_GT(axes.eigenvalues()(0), 0.99 * thinnest * axes.eigenvalues()(D - 1)) << p;
      ASSERT_NEAR(b.determinant() / testing::squared_axes_product<D>(stage.store.volume()[p]), 1,
                  1e-7)
          << p;
    }
  }
}
TEST(StageKernel, BluntsWhatAStepStretchesBeyondMeasure) {
  for (const double strain : {1.0, 5.0, 20.0, 200.0}) {
    SCOPED_TRACE(strain);
    expect_blunt_after<3>({{4, 4, 4}, {0, 0, 0}, {1, 1, 1}}, strain, 2);
    expect_blunt_after<2>({{4, 4}, {0, 0}, {1, 1}}, strain, 2);
  }
}

}  // namespace
}  // namespace pileus::dynamics
