// Longwave cooling of parcels on a mesh: what a cloud loses is what its columns' fluxes say.
#include <gtest/gtest.h>

#include <cmath>

#include "../../unit/coupling/sampled_mesh.hpp"

namespace pileus::testing {
namespace {

constexpr const char* theta_name = "liquid_water_potential_temperature";
constexpr const char* liquid_name = "mass_fraction_of_cloud_liquid_water_in_air";

template <int D>
std::unique_ptr<MeshRun<D>> clouds(const mesh::Grid<D>& grid, double content) {
  auto run = std::make_unique<MeshRun<D>>(
      grid, "org.pileus.longwave_cooling", Settings{{"absorption", "85 m2/kg"}},
      std::vector<std::string>{theta_name, liquid_name, "total_water_mass_fraction"},
      [](std::string_view, std::size_t) { return 0.0; });
  run->fill(8 * grid.cell_count(), 1.5, 7);
  run->bind();
  const double* z = run->store.position(D - 1);
  for (std::size_t p = 0; p < run->store.size(); ++p) {
    run->values(theta_name)[p] = 290;
    run->values(liquid_name)[p] = z[p] > 400 && z[p] < 600 ? content : 0.0;
  }
  return run;
}

TEST(LongwaveCooling, books_what_parcels_lose) {
  const mesh::Grid<3> grid({5, 4, 20}, {0, 0, 0}, {500, 400, 1000});
  const auto run = clouds(grid, 1e-3);
  const auto before = amount(run->store, run->values(theta_name));
  run->step(10.0);
  const auto after = amount(run->store, run->values(theta_name));
  const auto budget = run->sequence->ledger().operators.front().budgets.front();
  EXPECT_EQ(budget.budget, "heat");
  EXPECT_LT(budget.source, 0);
  EXPECT_NEAR(budget.change, budget.source,
              1e-12 * std::abs(budget.source) + 1e-15 * double(before.second));
  EXPECT_NEAR(double(after.first - before.first), budget.source, 1e-15 * double(before.second));
}

/// ρ Π of air at rest with 1000 hPa at the ground and θ_v = 300 K, kg m⁻³.
double density_times_exner(double z) {
  const double exner = 1 - 9.81 * z / (1005 * 300.0);
  return 1e5 * std::pow(exner, 1005 / 287.04) / (287.04 * 300);
}

/// A black cloud loses F_0 = 70 W m⁻² at its top and gains F_1 = 22 W m⁻² at its base, whatever is
/// in it: c_p Σ V Δθ = A dt (22/(ρΠ)_base − 70/(ρΠ)_top).
TEST(LongwaveCooling, of_a_black_cloud_is_that_of_its_ends) {
  const mesh::Grid<2> grid({8, 40}, {0, 0}, {800, 1000});
  const auto run = clouds(grid, 5e-3);
  const auto before = amount(run->store, run->values(theta_name));
  run->step(10.0);
  const auto after = amount(run->store, run->values(theta_name));
  const double warming = 1005 * double(after.first - before.first) / (800 * 10.0);
  const double expected = 22 / density_times_exner(400) - 70 / density_times_exner(600);
  EXPECT_NEAR(warming, expected, 0.01 * std::abs(expected));
}

TEST(LongwaveCooling, without_clouds_changes_nothing) {
  const mesh::Grid<3> grid({3, 3, 5}, {0, 0, 0}, {300, 300, 500});
  const auto run = clouds(grid, 0.0);
  run->step(10.0);
  for (std::size_t p = 0; p < run->store.size(); ++p) EXPECT_EQ(run->values(theta_name)[p], 290.0);
}

}  // namespace
}  // namespace pileus::testing
