// Exchange with the ground through the host: what the parcels get is what went through the ground,
// the momentum of the domain changes by the stress and by nothing else, and water stays positive.
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <numeric>

#include "../../unit/coupling/sampled_mesh.hpp"

namespace pileus::testing {
namespace {

constexpr const char* surface = "org.pileus.surface_fluxes";
const mesh::Grid<3> box({8, 6, 10}, {0, 0, 0}, {400, 300, 500});
const mesh::Grid<2> plane({12, 10}, {0, 0}, {600, 500});

/// A uniform wind.
NodeFunction wind(double u, double v) {
  return [=](std::string_view name, std::size_t) {
    return name == "x_velocity" ? u : name == "y_velocity" ? v : 0.0;
  };
}

template <int D>
struct Air : MeshRun<D> {
  Air(const mesh::Grid<D>& on, const Settings& settings, std::vector<std::string> initial,
      NodeFunction flow = wind(0, 0))
      : MeshRun<D>(on, surface, settings, std::move(initial), std::move(flow)) {
    this->fill(6000, 1.5, 3);
    this->bind();
  }
  void set(const char* name, double value) {
    std::fill_n(this->values(name), this->store.size(), value);
  }
  double total(const double* x) const { return static_cast<double>(amount(this->store, x).first); }
  const std::vector<double>& ground(const char* name) {
    return this->sequence->surface().values(
        static_cast<std::size_t>(this->sequence->surface().find(name)));
  }
};

double area(const mesh::Grid<3>& g) {
  return g.domain_volume() / 500;
}

TEST(SurfaceFluxes, HeatIsTheFluxTimesAreaAndTime) {
  Air<3> air(box, {{"heat_flux", "0.1 K m/s"}, {"moisture_flux", "5e-5 m/s"}},
             {"liquid_water_potential_temperature", "total_water_mass_fraction"});
  const char* const theta = "liquid_water_potential_temperature";
  air.set(theta, 300);
  air.set("total_water_mass_fraction", 0.01);
  const double heat = air.total(air.values(theta)),
               water = air.total(air.values("total_water_mass_fraction"));
  for (std::uint64_t n = 0; n < 100; ++n) air.step(5.0, n);
  EXPECT_NEAR(air.total(air.values(theta)) - heat, 0.1 * area(box) * 500, 1e-10 * heat * 1e-2);
  EXPECT_NEAR((air.total(air.values(theta)) - heat) / (0.1 * area(box) * 500), 1, 1e-10);
  EXPECT_NEAR(
      (air.total(air.values("total_water_mass_fraction")) - water) / (5e-5 * area(box) * 500), 1,
      1e-10);
  for (const auto& budget : air.sequence->ledger().operators.front().budgets) {
    EXPECT_NEAR(budget.defect(), 0, 1e-11 * std::abs(budget.source)) << budget.budget;
  }
  // g/θ_00 (Q (1 + 0.608 q) + 0.608 θ E) of the first level, at the start.
  EXPECT_NEAR(air.ground("surface_buoyancy_flux")[0],
              9.81 / 300 * (0.1 * (1 + 0.608 * 0.01) + 0.608 * 300 * 5e-5), 2e-5);
  EXPECT_EQ(air.ground("surface_heat_flux")[7], 0.1);
}

/// Linear in time from 0 to 1 over 100 s, any steps; in the plane; as buoyancy.
TEST(SurfaceFluxes, SeriesAreExactWhateverTheSteps) {
  Air<2> air(plane, {{"heat_flux", "{time: [0 s, 100 s], value: [0 K m/s, 1 K m/s]}"}},
             {"buoyancy"});
  air.set("buoyancy", 0);
  air.sequence->apply_after_transport({0, 0, 30});
  air.sequence->apply_after_transport({1, 30, 50});
  air.sequence->apply_after_transport({2, 80, 60});
  EXPECT_NEAR(air.total(air.values("buoyancy")), 9.81 / 300 * (50 + 40) * 600, 1e-10);
}

TEST(SurfaceFluxes, MapsMultiplyAndKeepTheirPlace) {
  Air<3> air(box, {{"buoyancy_flux", "3e-3 m2 s-3"}}, {"liquid_water_buoyancy"});
  const auto map =
      static_cast<std::size_t>(air.sequence->surface().find("relative_surface_heat_flux"));
  std::vector<double> factors(48, 0.0);
  factors[8 * 2 + 3] = 48;
  air.sequence->surface().values(map) = factors;
  air.set("liquid_water_buoyancy", 0);
  air.step(10);
  const double* b = air.values("liquid_water_buoyancy");
  EXPECT_NEAR(air.total(b), 3e-3 * 10 * area(box), 1e-9);
  for (std::size_t p = 0; p < air.store.size(); ++p) {
    const double dx = std::abs(air.store.position(0)[p] - 175);
    const double dy = std::abs(air.store.position(1)[p] - 125);
    const bool reached = dx < 50 && dy < 50 && air.store.position(2)[p] < 50;
    EXPECT_EQ(b[p] != 0, reached) << dx << " " << dy;
  }
}

/// Dew that the air cannot give is cut and owed, and comes when there is water again.
TEST(SurfaceFluxes, WaterStaysPositiveAndIsOwed) {
  Air<3> air(box, {{"moisture_flux", "-1e-4 m/s"}},
             {"air_potential_temperature", "specific_humidity"});
  air.set("air_potential_temperature", 300);
  air.set("specific_humidity", 1e-4);
  const char* const q = "specific_humidity";
  const double before = air.total(air.values(q));
  for (std::uint64_t n = 0; n < 20; ++n) air.step(10, n);
  for (std::size_t p = 0; p < air.store.size(); ++p) ASSERT_GE(air.values(q)[p], 0);
  const auto& owed = air.ground("surface_moisture_owed");
  const double open = std::accumulate(owed.begin(), owed.end(), 0.0) * 2500;
  EXPECT_LT(open, 0);
  const double asked = -1e-4 * 200 * area(box);
  EXPECT_NEAR(air.total(air.values(q)) - before, asked - open, 1e-12 * before);
  EXPECT_GT(air.sequence->ledger().operators.front().repairs, 0u);
  air.set(q, 0.02);
  air.sequence->population_changed();
  const double full = air.total(air.values(q));
  air.step(10, 20);
  EXPECT_NEAR(air.total(air.values(q)) - full, -1e-4 * 10 * area(box) + open, 1e-10 * full);
  for (const double d : air.ground("surface_moisture_owed")) EXPECT_EQ(d, 0);
}

/// A uniform wind over a fixed C_D: H d<u>/dt = −C_D U u and the vorticity that holds the rest of
/// the momentum at z < d has the integral 2τ/d · area, so that the wind above is as before.
void expect_drag_up_to(int cells) {
  const double depth = 50 * cells;
  const double coefficient = 1.5e-3, speed = std::hypot(6.0, -2.5);
  Air<3> air(box,
             {{"momentum", "bulk"},
              {"momentum_coefficient", "1.5e-3"},
              {"coefficient_height", "50 m"},
              {"roughness_length", "0.01 m"},
              {"stress_depth_in_cells", std::to_string(cells)}},
             {"buoyancy"}, wind(6, -2.5));
  air.mesh.mean_wind = {6, -2.5};
  for (int c = 0; c < 3; ++c) std::fill_n(air.store.vorticity(c), air.store.size(), 0.0);
  air.sequence->population_changed();
  const double dt = 20;
  air.step(dt);
  const double tau_x = coefficient * speed * 6, tau_y = coefficient * speed * -2.5;
  EXPECT_NEAR(air.mesh.mean_wind[0] - 6, -tau_x * dt / 500, 1e-13);
  EXPECT_NEAR(air.mesh.mean_wind[1] + 2.5, -tau_y * dt / 500, 1e-13);
  EXPECT_NEAR(air.total(air.store.vorticity(1)), dt * 2 * tau_x / depth * area(box), 1e-9);
  EXPECT_NEAR(air.total(air.store.vorticity(0)), -dt * 2 * tau_y / depth * area(box), 1e-9);
  EXPECT_EQ(air.total(air.store.vorticity(2)), 0);
  for (std::size_t p = 0; p < air.store.size(); ++p)
    ASSERT_EQ(air.store.vorticity(1)[p] != 0, air.store.position(2)[p] < depth);
  EXPECT_NEAR(air.ground("surface_friction_velocity")[0], std::sqrt(coefficient) * speed, 1e-12);
}
TEST(SurfaceFluxes, DragTakesTheStressFromTheWind) {
  expect_drag_up_to(1);
}
TEST(SurfaceFluxes, DragMayReachOverSeveralCells) {
  expect_drag_up_to(3);
}

/// Uneven drag turns air about the vertical, by nothing in sum.
TEST(SurfaceFluxes, UnevenDragTurnsButNotInSum) {
  const auto gusts = [](std::string_view name, std::size_t node) {
    const double phase = static_cast<double>(node / 13 % 8) * 0.785;
    return name == "x_velocity"   ? 5 + std::cos(phase)
           : name == "y_velocity" ? std::sin(phase + static_cast<double>(node / 104))
                                  : 0.0;
  };
  for (const char* stress : {"local", "plane_mean"}) {
    Air<3> air(box,
               {{"momentum", "monin_obukhov"}, {"roughness_length", "0.1 m"}, {"stress", stress}},
               {"buoyancy"}, gusts);
    std::fill_n(air.store.vorticity(2), air.store.size(), 0.0);
    air.step(10);
    const auto [sum, magnitude] = amount(air.store, air.store.vorticity(2));
    EXPECT_GT(static_cast<double>(magnitude), 0);
    EXPECT_NEAR(static_cast<double>(sum / magnitude), 0, 1e-13) << stress;
  }
}

/// In the plane the one component of the vorticity is −∂u/∂z there.
TEST(SurfaceFluxes, DragInThePlane) {
  Air<2> air(plane, {{"momentum", "friction_velocity"}, {"friction_velocity", "0.3 m/s"}},
             {"buoyancy"}, wind(4, 0));
  air.mesh.mean_wind = {4, 0};
  std::fill_n(air.store.vorticity(0), air.store.size(), 0.0);
  air.sequence->population_changed();
  air.step(10);
  EXPECT_NEAR(air.mesh.mean_wind[0], 4 - 0.09 * 10 / 500, 1e-14);
  EXPECT_NEAR(air.total(air.store.vorticity(0)), -10 * 2 * 0.09 / 50 * 600, 1e-10);
}

/// A sea of a given temperature: the fluxes are those of the exchange with the air at z_1 = h.
TEST(SurfaceFluxes, BulkFluxesOfASea) {
  for (const char* momentum : {"none", "bulk"})
    for (const char* stress : {"local", "plane_mean"}) {
      Air<3> air(box,
                 {{"scalar_flux", "bulk"},
                  {"momentum", momentum},
                  {"stress", stress},
                  {"surface_potential_temperature", "298.5 K"},
                  {"surface_humidity", "0.0217"},
                  {"roughness_length", "2e-4 m"}},
                 {"liquid_water_potential_temperature", "total_water_mass_fraction"}, wind(8, 0));
      air.set("liquid_water_potential_temperature", 297.9);
      air.set("total_water_mass_fraction", 0.016);
      air.sequence->population_changed();
      air.step(1);
      const double scale = std::pow(std::log(1e5) / std::log(2.5e5), 2) * 8;
      for (const double q : air.ground("surface_heat_flux"))
        EXPECT_NEAR(q, 0.001094 * scale * 0.6, 1e-12);
      for (const double q : air.ground("surface_moisture_flux"))
        EXPECT_NEAR(q, 0.001133 * scale * 0.0057, 1e-12);
    }
}

TEST(SurfaceFluxes, SameBitsForAnyNumberOfThreads) {
  const int before = omp_get_max_threads();
  std::vector<std::vector<double>> first;
  for (const int threads : {1, 2, 3}) {
    omp_set_num_threads(threads);
    Air<3> air(box,
               {{"scalar_flux", "monin_obukhov"},
                {"momentum", "monin_obukhov"},
                {"roughness", "charnock"},
                {"surface_potential_temperature", "302 K"}},
               {"liquid_water_potential_temperature"}, wind(5, 1));
    air.set("liquid_water_potential_temperature", 300);
    air.sequence->population_changed();
    for (std::uint64_t n = 0; n < 3; ++n) air.step(2, n);
    std::vector<std::vector<double>> now;
    for (int c = 0; c < air.store.column_count(); ++c)
      now.emplace_back(air.store.column(c), air.store.column(c) + air.store.size());
    if (first.empty()) first = now;
    EXPECT_EQ(first, now) << threads << " threads";
  }
  omp_set_num_threads(before);
}

/// α (h²/2B)^{1/3}: the time in which the ground's force of buoyancy moves a parcel by a cell.
/// Unless a scene says how often it is called in a step, the operator is called up to 64 times.
TEST(SurfaceFluxes, LimitsTheStep) {
  Air<3> air(box, {{"heat_flux", "0.24 K m/s"}}, {"buoyancy"});
  air.set("buoyancy", 0);
  air.step(1);
  EXPECT_NEAR(air.sequence->dt_limit() / coupling::most_substeps,
              0.5 * std::cbrt(2500 / (2 * 7.848e-3)), 1e-9);
}

/// A coefficient of the height of the roughness would be adjusted to nothing, one of a height below
/// it to anything, as squares hide the sign of the logarithm. No step is needed to see that.
TEST(SurfaceFluxes, BulkCoefficientsAreOfAHeightAboveTheRoughness) {
  const auto failure = [](Settings settings, const char* height, const char* roughness) {
    settings.emplace_back("coefficient_height", height);
    settings.emplace_back("roughness_length", roughness);
    try {
      Air<3> air(box, settings, {"liquid_water_potential_temperature"});
    } catch (const std::exception& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  for (const Settings& bulk : {Settings{{"momentum", "bulk"}}, Settings{{"scalar_flux", "bulk"}}}) {
    for (const char* roughness : {"20 m", "30 m"})
      EXPECT_NE(failure(bulk, "20 m", roughness).find("below coefficient_height"),
                std::string::npos);
    EXPECT_EQ(failure(bulk, "20 m", "19 m"), "");
  }
  EXPECT_EQ(failure({{"momentum", "monin_obukhov"}}, "20 m", "20 m"), "");
}

TEST(SurfaceFluxes, WhatCannotBeIsSaid) {
  const auto failure = [](const Settings& settings, const char* carried) {
    try {
      Air<3> air(box, settings, {carried});
      air.step(1);
    } catch (const std::exception& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(failure({{"moisture_flux", "1e-4 m/s"}}, "buoyancy").find("carry no water"),
            std::string::npos);
  EXPECT_NE(failure({{"buoyancy_flux", "1e-3 m2 s-3"}}, "air_potential_temperature")
                .find("state heat_flux"),
            std::string::npos);
  EXPECT_NE(failure({{"roughness_length", "30 m"}}, "buoyancy").find("below half the height"),
            std::string::npos);
}

}  // namespace
}  // namespace pileus::testing
