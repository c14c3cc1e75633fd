// Which limit binds, and the reference profile at, between and beyond its table.
#include "dynamics/time_step.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "dynamics/reference_profile.hpp"

namespace pileus::dynamics {
namespace {

const mesh::Grid<3> grid({10, 10, 10}, {0, 0, 0}, {10, 20, 5});

TimeStep chosen(const mesh::FlowSummary& flow, double coriolis = 0) {
  TimeStepControl control;
  control.alpha = 0.2;
  control.strain_alpha = 0.3;
  control.largest = 100;
  return choose_time_step<3>(control, grid, flow, coriolis);
}

// Dossier 6.2: α_s/γ_max, α_b/N_max; a fluid at rest is capped.
TEST(TimeStep, TheTightestLimitWins) {
  EXPECT_EQ(chosen({}).limiter, "cap");
  EXPECT_EQ(chosen({}).seconds, 100);
  mesh::FlowSummary flow;
  flow.strain = 1;
  EXPECT_EQ(chosen(flow).limiter, "strain");
  EXPECT_DOUBLE_EQ(chosen(flow).seconds, 0.3);
  flow.buoyancy_gradient = 4;
  EXPECT_EQ(chosen(flow).limiter, "stratification");
  EXPECT_DOUBLE_EQ(chosen(flow).seconds, 0.1);
  flow.speed = {0, 0, 10};  // Δz = 0.5: a cell in 0.05 s
  EXPECT_EQ(chosen(flow).limiter, "advection");
  EXPECT_DOUBLE_EQ(chosen(flow).seconds, 0.05);
  EXPECT_EQ(chosen(flow, -8).limiter, "rotation");
  EXPECT_DOUBLE_EQ(chosen(flow, -8).seconds, 0.025);
  TimeStepControl fixed;
  fixed.fixed = 7;
  EXPECT_EQ(choose_time_step<3>(fixed, grid, flow, 0).seconds, 7);
  EXPECT_EQ(choose_time_step<3>(fixed, grid, flow, 0).limiter, "fixed");
}

TEST(ReferenceProfile, IsLinearBetweenAndBeyondItsPoints) {
  EXPECT_TRUE(ReferenceProfile().is_zero());
  EXPECT_EQ(ReferenceProfile()(3), 0);
  EXPECT_TRUE(ReferenceProfile(0, 1, 5, [](double) { return 0.0; }).is_zero());
  const ReferenceProfile line(-1, 3, 9, [](double z) { return 2 - 0.5 * z; });
  for (const double z : {-5.0, -1.0, -0.9, 0.0, 1.3, 2.999, 3.0, 8.0}) {
    EXPECT_NEAR(line(z), 2 - 0.5 * z, 1e-14) << z;
    EXPECT_NEAR(line.gradient(z), -0.5, 1e-14) << z;
  }
  const ReferenceProfile bent(0, 2, 3, [](double z) { return z <= 1 ? z : 3 * z - 2; });
  EXPECT_DOUBLE_EQ(bent(0.25), 0.25);
  EXPECT_DOUBLE_EQ(bent(1.5), 2.5);
  EXPECT_DOUBLE_EQ(bent.gradient(0), 1);
  EXPECT_DOUBLE_EQ(bent.gradient(1), 2);
  EXPECT_DOUBLE_EQ(bent.gradient(2), 3);
}

TEST(ReferenceProfile, AnyHeightIsSafe) {
  const ReferenceProfile line(0, 1, 3, [](double z) { return 1 + z; });
  const double inf = std::numeric_limits<double>::infinity();
  for (const double z : {1e30, -1e30, 1e10, -1e10})
    EXPECT_NEAR(line(z), 1 + z, 1e-12 * std::abs(z));
  for (const double z : {inf, -inf, std::numeric_limits<double>::quiet_NaN()})
    EXPECT_FALSE(std::isfinite(line(z)));
}

}  // namespace
}  // namespace pileus::dynamics
