// Large-scale forcing through the operator: budgets of trade-wind cumulus, the mean wind's
// equations and the sponge. The relations are derived in the plugin's README.
#include <gtest/gtest.h>
#include <omp.h>

#include <array>
#include <cmath>

#include "../../unit/coupling/sampled_mesh.hpp"

namespace pileus::testing {
namespace {

constexpr const char* forcing = "org.pileus.large_scale_forcing";
constexpr const char* theta = "liquid_water_potential_temperature";
constexpr const char* water = "total_water_mass_fraction";
const NodeFunction still = [](std::string_view, std::size_t) { return 0.0; };

/// ⟨φ⟩ over all parcels.
template <int D>
double mean(const MeshRun<D>& run, const double* values) {
  long double volume = 0;
  for (std::size_t p = 0; p < run.store.size(); ++p) volume += run.store.volume()[p];
  return static_cast<double>(amount(run.store, values).first / volume);
}

/// Parcels at even heights, of equal volume, anywhere sideways.
template <int D>
void spread_evenly(MeshRun<D>& run, std::size_t count) {
  run.fill(count, 1.5, 21);
  for (std::size_t p = 0; p < count; ++p) {
    const double part = (static_cast<double>(p) + 0.5) / static_cast<double>(count);
    run.store.position(D - 1)[p] = run.grid.bottom() + part * (run.grid.top() - run.grid.bottom());
    run.store.volume()[p] = run.grid.domain_volume() / static_cast<double>(count);
  }
}

/// Sets a quantity to a function of height.
template <int D, class F>
void set(MeshRun<D>& run, double* values, F&& of_height) {
  for (std::size_t p = 0; p < run.store.size(); ++p)
    values[p] = of_height(run.store.position(D - 1)[p]);
}

double linear_between(const std::vector<std::pair<double, double>>& points, double z) {
  for (std::size_t i = 1; i < points.size(); ++i)
    if (z <= points[i].first) {
      const auto [a, fa] = points[i - 1];
      const auto [b, fb] = points[i];
      return fa + (z - a) / (b - a) * (fb - fa);
    }
  return points.back().second;
}

const Settings trade_wind = {
    {"subsidence_velocity", "{height: [0 m, 1500 m, 2100 m], value: [0 m/s, -0.0065 m/s, 0 m/s]}"},
    {"potential_temperature_tendency", "{height: [1500 m, 2500 m], value: [-2/86400 K/s, 0 K/s]}"},
    {"total_water_tendency", "{height: [300 m, 500 m], value: [-1.2e-8 s-1, 0 s-1]}"}};

/// Siebesma et al. 2003: of the column, K m s⁻¹ and m s⁻¹, subsidence 3.882e-2 and −5.043e-5,
/// cooling to zero at 2500 m −4.630e-2, drying −4.8e-6. Kinks between
/// levels are not resolved: on levels of 100 m subsidence comes out 0.1 % weaker.
TEST(LargeScaleForcing, brings_the_column_budgets_of_trade_wind_cumulus) {
  for (const int cells : {30, 90}) {
    MeshRun<3> run(mesh::Grid<3>({2, 2, cells}, {0, 0, 0}, {400, 200, 3000}), forcing, trade_wind,
                   {theta, water}, still);
    spread_evenly(run, 60 * static_cast<std::size_t>(cells));
    run.bind();
    double *heat = run.values(theta), *moisture = run.values(water);
    set(run, heat, [](double z) {
      return linear_between(
          {{0, 298.7}, {520, 298.7}, {1480, 302.4}, {2000, 308.2}, {3000, 311.85}}, z);
    });
    set(run, moisture, [](double z) {
      return linear_between(
          {{0, 17e-3}, {520, 16.3e-3}, {1480, 10.7e-3}, {2000, 4.2e-3}, {3000, 3e-3}}, z);
    });
    run.sequence->population_changed();
    const auto heat_before = amount(run.store, heat), water_before = amount(run.store, moisture);
    const double dt = 10, area = 8e4;
    run.step(dt);
    const auto gained = [&](const double* values, auto before) {
      return static_cast<double>(amount(run.store, values).first - before.first);
    };
    EXPECT_NEAR(gained(heat, heat_before) / (area * dt), 3.882e-2 - 4.630e-2, 0.01 * 3.882e-2);
    EXPECT_NEAR(gained(moisture, water_before) / (area * dt), -5.043e-5 - 4.80e-6, 0.01 * 5.043e-5);
    // What is booked is what the levels were given, not what parcels then had: the two agree up to
    // the rounding of the sums.
    const coupling::OperatorLedger entry = run.sequence->ledger().operators.front();
    for (const auto& budget : entry.budgets) {
      const bool is_heat = budget.budget == "heat";
      if (!is_heat && budget.budget != "water") continue;
      const double total = static_cast<double>((is_heat ? heat_before : water_before).second);
      EXPECT_NE(budget.source, 0);
      EXPECT_NEAR(budget.defect(), 0, 1e-13 * total) << budget.budget;
      EXPECT_NEAR(budget.source,
                  is_heat ? gained(heat, heat_before) : gained(moisture, water_before),
                  1e-13 * total);
    }
  }
}

/// Parcels of any size that leave gaps: sources still arrive in full.
TEST(LargeScaleForcing, brings_as_much_to_uneven_parcels) {
  MeshRun<3> run(mesh::Grid<3>({4, 4, 12}, {0, 0, 0}, {400, 400, 1200}), forcing,
                 {{"potential_temperature_tendency",
                   "{height: [130 m, 777 m], value: [1e-4 K/s, -3e-4 K/s]}"}},
                 {theta}, still);
  run.fill(3000, 2, 22);
  run.bind();
  double* heat = run.values(theta);
  set(run, heat, [](double z) { return 300 + 1e-3 * z; });
  run.sequence->population_changed();
  const auto before = amount(run.store, heat);
  run.step(7);
  // ∫ = 130·1e-4 + 647·(−1e-4) + 423·(−3e-4) K m s⁻¹
  EXPECT_NEAR(static_cast<double>(amount(run.store, heat).first - before.first),
              7 * 1.6e5 * (0.013 - 0.0647 - 0.1269), 1e-13 * static_cast<double>(before.second));
}

/// Heating of air without a temperature: g/θ_00 of it.
TEST(LargeScaleForcing, heats_buoyancy_where_there_is_no_temperature) {
  MeshRun<2> run(mesh::Grid<2>({4, 8}, {0, 0}, {400, 800}), forcing,
                 {{"potential_temperature_tendency", "2e-3 K/s"},
                  {"gravity", "10 m/s2"},
                  {"reference_temperature", "250 K"},
                  {"buoyancy_tendency", "1e-5 m/s3"}},
                 {"liquid_water_buoyancy"}, still);
  spread_evenly(run, 400);
  run.bind();
  double* b = run.values("liquid_water_buoyancy");
  const double before = mean(run, b);
  run.step(5);
  EXPECT_NEAR(mean(run, b) - before, 5 * (2e-3 * 10 / 250 + 1e-5), 1e-14);
}

/// Means relax exponentially whatever the parcels hold: from a shear of 0 to 2e-3 s⁻¹, from a mean
/// of 3 m s⁻¹ to that of the target, −7 m s⁻¹; across from 1 to 0.
TEST(LargeScaleForcing, nudges_shear_and_mean_wind_exponentially) {
  MeshRun<3> run(mesh::Grid<3>({4, 4, 10}, {0, 0, 0}, {400, 400, 1000}), forcing,
                 {{"wind_nudging_time", "600 s"},
                  {"target_x_velocity", "{height: [0 m, 1000 m], value: [-8 m/s, -6 m/s]}"}},
                 {}, still);
  run.fill(4000, 2, 23);
  run.bind();
  run.mesh.mean_wind = {3, 1};
  const double xi = mean(run, run.store.vorticity(0)), eta = mean(run, run.store.vorticity(1));
  for (std::uint64_t n = 0; n < 40; ++n) run.step(15, n);
  const double left = std::exp(-1.0);
  EXPECT_NEAR(run.mesh.mean_wind[0], -7 + 10 * left, 1e-12);
  EXPECT_NEAR(run.mesh.mean_wind[1], left, 1e-13);
  EXPECT_NEAR(mean(run, run.store.vorticity(1)), 2e-3 + (eta - 2e-3) * left, 1e-13);
  EXPECT_NEAR(mean(run, run.store.vorticity(0)), xi * left, 1e-13);
}

/// A force that falls linearly from F at the ground to zero at the top changes the shear by −F/H
/// and the mean by F/2, per second: ∫ u dz gains F H/2.
TEST(LargeScaleForcing, pushes_the_wind) {
  MeshRun<3> run(mesh::Grid<3>({4, 4, 10}, {0, 0, 0}, {400, 400, 1000}), forcing,
                 {{"x_wind_tendency", "{height: [0 m, 1000 m], value: [2e-3 m/s2, 0 m/s2]}"},
                  {"y_wind_tendency", "-1e-3 m/s2"}},
                 {}, still);
  run.fill(4000, 2, 23);
  run.bind();
  const double xi = mean(run, run.store.vorticity(0)), eta = mean(run, run.store.vorticity(1));
  run.step(15);
  EXPECT_NEAR(run.mesh.mean_wind[0], 15 * 1e-3, 1e-15);
  EXPECT_NEAR(run.mesh.mean_wind[1], -15 * 1e-3, 1e-15);
  EXPECT_NEAR(mean(run, run.store.vorticity(1)) - eta, -15 * 2e-6, 1e-16);
  EXPECT_NEAR(mean(run, run.store.vorticity(0)), xi, 1e-16);
}

/// In the plane the vorticity is minus the shear.
TEST(LargeScaleForcing, nudges_the_wind_of_a_plane) {
  MeshRun<2> run(mesh::Grid<2>({4, 10}, {0, 0}, {400, 1000}), forcing,
                 {{"wind_nudging_time", "600 s"},
                  {"target_x_velocity", "{height: [0 m, 1000 m], value: [-8 m/s, -6 m/s]}"}},
                 {}, still);
  run.fill(2000, 2, 24);
  run.bind();
  run.step(1e6);
  EXPECT_NEAR(run.mesh.mean_wind[0], -7, 1e-12);
  EXPECT_NEAR(mean(run, run.store.vorticity(0)), -2e-3, 1e-13);
}

/// To first order du/dt = −f v_g and dv/dt = f u_g at every height: with u_g = −10 + 2e-3 z and
/// v_g = 4 − 1e-3 z over 1 km, dη/dt = 1e-3 f, dξ/dt = −2e-3 f.
TEST(LargeScaleForcing, balances_the_geostrophic_wind) {
  const double f = 1e-4, dt = 0.5;
  MeshRun<3> run(mesh::Grid<3>({4, 4, 10}, {0, 0, 0}, {400, 400, 1000}), forcing,
                 {{"geostrophic", "true"},
                  {"geostrophic_x_velocity", "{height: [0 m, 1000 m], value: [-10 m/s, -8 m/s]}"},
                  {"geostrophic_y_velocity", "{height: [0 m, 1000 m], value: [4 m/s, 3 m/s]}"}},
                 {}, still);
  run.fill(3000, 2, 25);
  run.mesh.coriolis_parameter = f;
  run.bind();
  const double xi = mean(run, run.store.vorticity(0)), eta = mean(run, run.store.vorticity(1));
  run.step(dt);
  EXPECT_NEAR(run.mesh.mean_wind[0] / dt, -f * 3.5, f * 10 * f * dt);
  EXPECT_NEAR(run.mesh.mean_wind[1] / dt, f * -9.0, f * 10 * f * dt);
  EXPECT_NEAR((mean(run, run.store.vorticity(1)) - eta) / dt, 1e-3 * f, 1e-4 * f);
  EXPECT_NEAR((mean(run, run.store.vorticity(0)) - xi) / dt, -2e-3 * f, 1e-4 * f);
}

/// −w ∂u/∂z with w = −D z and u = s z: the shear grows as D s everywhere, the mean as D s H/2.
TEST(LargeScaleForcing, subsidence_carries_the_wind_down) {
  const double d = 1e-5, s = 4e-3;
  MeshRun<3> run(mesh::Grid<3>({4, 4, 10}, {0, 0, 0}, {400, 400, 1000}), forcing,
                 {{"subsidence_velocity", "{height: [0 m, 1000 m], value: [0 m/s, -0.01 m/s]}"},
                  {"subsidence_of", "scalars_and_wind"}},
                 {}, still);
  run.fill(3000, 2, 26);
  run.bind();
  set(run, run.store.vorticity(1), [&](double) { return s; });
  set(run, run.store.vorticity(0), [&](double) { return -2 * s; });  // v = 2 s z
  run.sequence->population_changed();
  run.step(10);
  EXPECT_NEAR(run.mesh.mean_wind[0], 10 * d * s * 500, 1e-15);
  EXPECT_NEAR(run.mesh.mean_wind[1], 10 * d * 2 * s * 500, 1e-15);
  for (std::size_t p = 0; p < run.store.size(); ++p) {
    EXPECT_NEAR(run.store.vorticity(1)[p], s * (1 + 10 * d), 1e-15);
    EXPECT_NEAR(run.store.vorticity(0)[p], -2 * s * (1 + 10 * d), 1e-15);
  }
}

/// Deviations above the sponge's foot decay, those below stay; means are kept.
TEST(LargeScaleForcing, sponge_damps_what_differs_from_the_level) {
  MeshRun<3> run(mesh::Grid<3>({4, 4, 10}, {0, 0, 0}, {400, 400, 1000}), forcing,
                 {{"sponge_rate", "{height: [600 m, 601 m], value: [0 s-1, 0.01 s-1]}"},
                  {"sponge_of", "vorticity_and_scalars"}},
                 {"passive_tracer"}, still);
  run.fill(8000, 2, 27);
  run.bind();
  const std::array<double*, 3> columns = {run.store.vorticity(0), run.store.vorticity(2),
                                          run.values("passive_tracer")};
  std::vector<std::vector<double>> before;
  std::vector<double> means;
  for (const double* values : columns) {
    before.emplace_back(values, values + run.store.size());
    means.push_back(mean(run, values));
  }
  run.step(100);
  for (std::size_t c = 0; c < columns.size(); ++c) {
    double square = 0, square_left = 0;
    for (std::size_t p = 0; p < run.store.size(); ++p) {
      const double z = run.store.position(2)[p], old = before[c][p], now = columns[c][p];
      if (z < 500) {
        EXPECT_EQ(now, old);
      }
      if (z > 800) square += old * old, square_left += now * now;
    }
    // e⁻² of the variance, and what the means of levels of 700 parcels have of it.
    EXPECT_NEAR(square_left / square, std::exp(-2.0), 0.01);
    EXPECT_NEAR(mean(run, columns[c]), means[c], 1e-15);
  }
}

TEST(LargeScaleForcing, same_bits_for_any_number_of_threads) {
  const int before = omp_get_max_threads();
  Settings all = trade_wind;
  for (const auto& more : Settings{{"subsidence_of", "scalars_and_wind"},
                                   {"wind_nudging_time", "600 s"},
                                   {"geostrophic", "true"},
                                   {"geostrophic_x_velocity", "3 m/s"},
                                   {"sponge_rate", "1e-3 s-1"},
                                   {"sponge_of", "vorticity_and_scalars"}})
    all.push_back(more);
  std::vector<double> first;
  for (const int threads : {1, 2, 3}) {
    omp_set_num_threads(threads);
    MeshRun<3> run(mesh::Grid<3>({8, 8, 12}, {0, 0, 0}, {800, 800, 3000}), forcing, all,
                   {theta, water, "passive_tracer"}, still);
    run.fill(20000, 2, 28);
    run.mesh.coriolis_parameter = 1e-4;
    run.bind();
    set(run, run.values(theta), [](double z) { return 300 + 1e-3 * z; });
    set(run, run.values(water), [](double z) { return 1e-2 * std::exp(-z / 1000); });
    run.sequence->population_changed();
    for (std::uint64_t n = 0; n < 3; ++n) run.step(5, n);
    std::vector<double> now(run.mesh.mean_wind.begin(), run.mesh.mean_wind.end());
    for (int c = 0; c < run.store.column_count(); ++c)
      now.insert(now.end(), run.store.column(c), run.store.column(c) + run.store.size());
    if (first.empty()) first = now;
    EXPECT_EQ(first, now) << threads << " threads";
  }
  omp_set_num_threads(before);
}

/// Without anything asked for, nothing changes.
TEST(LargeScaleForcing, of_nothing_changes_nothing) {
  MeshRun<3> run(mesh::Grid<3>({4, 4, 4}, {0, 0, 0}, {4, 4, 4}), forcing, {}, {"passive_tracer"},
                 still);
  run.fill(500, 2, 29);
  run.bind();
  std::vector<double> before(run.store.vorticity(0), run.store.vorticity(0) + 500);
  run.step(1);
  EXPECT_EQ(before, std::vector<double>(run.store.vorticity(0), run.store.vorticity(0) + 500));
}

template <int D>
std::string refusal_on(const mesh::Grid<D>& grid, const Settings& settings,
                       std::vector<std::string> initial, double coriolis = 0) {
  MeshRun<D> run(grid, forcing, settings, std::move(initial), still);
  run.fill(500, 2, 30);
  run.mesh.coriolis_parameter = coriolis;
  run.bind();
  try {
    run.step(1);
  } catch (const std::exception& failure) {
    return failure.what();
  }
  return {};
}
std::string refusal(const Settings& settings, double coriolis = 0) {
  return refusal_on(mesh::Grid<3>({4, 4, 4}, {0, 0, 0}, {4, 4, 4}), settings, {}, coriolis);
}

/// What a setting asks for either happens or is refused by its name.
TEST(LargeScaleForcing, refuses_what_could_not_act) {
  const mesh::Grid<2> plane({4, 8}, {0, 0}, {400, 800});
  for (const Settings& across :
       {Settings{{"y_wind_tendency", "1e-3 m/s2"}},
        Settings{{"wind_nudging_time", "600 s"}, {"target_y_velocity", "1 m/s"}}})
    EXPECT_NE(refusal_on(plane, across, {}).find(across.back().first), std::string::npos);
  EXPECT_EQ(refusal_on(plane, {{"x_wind_tendency", "1e-3 m/s2"}}, {}), "");

  const Settings weightless = {{"potential_temperature_tendency", "2e-3 K/s"},
                               {"gravity", "0 m/s2"}};
  EXPECT_NE(refusal_on(plane, weightless, {"liquid_water_buoyancy"}).find("gravity is 0"),
            std::string::npos);
  EXPECT_EQ(refusal_on(plane, weightless, {theta}).find("gravity"), std::string::npos);

  for (const char* target : {"target_x_velocity", "target_y_velocity"}) {
    EXPECT_THROW(refusal({{target, "3 m/s"}}), std::logic_error) << "never nudged";
    EXPECT_EQ(refusal({{target, "3 m/s"}, {"wind_nudging_time", "600 s"}}), "");
  }
}

/// A target that is not stated is rest.
TEST(LargeScaleForcing, nudges_to_rest_without_a_target) {
  MeshRun<3> run(mesh::Grid<3>({4, 4, 10}, {0, 0, 0}, {400, 400, 1000}), forcing,
                 {{"wind_nudging_time", "600 s"}}, {}, still);
  run.fill(1000, 2, 23);
  run.bind();
  run.mesh.mean_wind = {3, 1};
  run.step(600);
  EXPECT_NEAR(run.mesh.mean_wind[0], 3 * std::exp(-1.0), 1e-13);
  EXPECT_NEAR(run.mesh.mean_wind[1], std::exp(-1.0), 1e-13);
}

TEST(LargeScaleForcing, refuses_what_the_run_does_not_have) {
  EXPECT_NE(refusal({{"total_water_tendency", "1e-8 s-1"}}).find("total_water_mass_fraction"),
            std::string::npos);
  EXPECT_NE(refusal({{"geostrophic", "true"}}).find("background.coriolis"), std::string::npos);
  EXPECT_EQ(refusal({{"geostrophic", "true"}}, 1e-4), "");
  EXPECT_THROW(refusal({{"wind_nudging_time", "-1 s"}}), std::logic_error);
}

}  // namespace
}  // namespace pileus::testing
