// Rain falling through a mesh of parcels: what leaves the parcels lies on the ground.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "coupling/operator_sequence.hpp"

namespace pileus::coupling {
namespace {

constexpr const char* rain_name = "mass_fraction_of_rain_in_air";
constexpr const char* drops_name = "number_of_raindrops_per_mass_of_air";
constexpr double density = 1.2;  // kg m-3, the operator's default

scene::OperatorBlock operator_of(const char* id, const char* name,
                                 std::vector<std::pair<std::string, scene::RawValue>> settings) {
  scene::OperatorBlock block;
  block.use = id;
  block.name = name;
  block.parameters = std::move(settings);
  return block;
}

/// Parcels of random volumes and places over a mesh of 4 by 3 (in the plane 4) by 10 cells.
struct Shower {
  OperatorSequence sequence;
  parcels::Store store;
  pileus_grid grid{};
  std::uint64_t steps = 0;

  using Settings = std::vector<std::pair<std::string, scene::RawValue>>;
  explicit Shower(int dimension, const Settings& settings = {})
      : sequence(make(settings)), store(dimension, sequence.required_scalars()) {
    grid.dimension = static_cast<std::uint32_t>(dimension);
    grid.cells[0] = 4, grid.cells[1] = dimension == 3 ? 3 : 1, grid.cells[2] = 10;
    grid.spacing[0] = 100, grid.spacing[1] = dimension == 3 ? 150 : 0, grid.spacing[2] = 50;
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> unit(0, 1);
    store.resize(4000);
    for (std::size_t p = 0; p < store.size(); ++p) {
      store.uid()[p] = p + 1;
      store.volume()[p] = 100 * (0.5 + unit(random));
      store.position(0)[p] = 400 * unit(random);
      if (dimension == 3) store.position(1)[p] = 450 * unit(random);
      store.position(dimension - 1)[p] = 500 * unit(random);
      values("air_potential_temperature")[p] = 290;
      values("specific_humidity")[p] = 1e-3;
    }
    sequence.bind(store, grid);
    sequence.init({});
    for (std::size_t p = 0; p < store.size(); ++p) {
      values(rain_name)[p] = p % 3 == 0 ? 1e-3 * unit(random) : 0.0;
      values(drops_name)[p] = 1e7 * values(rain_name)[p];
    }
  }
  double* values(const char* name) { return store.scalar(store.find_scalar(name)); }
  double in_the_air(const char* name) {
    double sum = 0;
    for (std::size_t p = 0; p < store.size(); ++p) sum += store.volume()[p] * values(name)[p];
    return sum;
  }
  /// Σ V q of what lies on the ground.
  double on_the_ground(const char* name) {
    const double area = 100.0 * (grid.dimension == 3 ? 150 : 1);
    double sum = 0;
    const auto field = static_cast<std::size_t>(sequence.surface().find(name));
    for (const double x : sequence.surface().values(field)) sum += x * area / density;
    return sum;
  }
  void step(double dt) {
    sequence.apply_after_transport({steps, 0, dt});
    sequence.population_changed();
    ++steps;
  }

 private:
  static OperatorSequence make(const Settings& settings) {
    scene::Scene scene;
    scene.operators.push_back(operator_of("org.pileus.rain_sedimentation", "fall", settings));
    scene::Problems problems;
    SequenceOptions options;
    options.initial = {"air_potential_temperature", "specific_humidity", rain_name, drops_name};
    auto entries = load_operators(scene, {{PILEUS_BINARY_DIR "/lib/pileus/plugins"}}, problems);
    EXPECT_TRUE(problems.empty()) << problems.render();
    return OperatorSequence(std::move(entries), std::move(options));
  }
};

TEST(RainSedimentation, brings_all_rain_to_the_ground_and_loses_none) {
  for (const int dimension : {2, 3}) {
    Shower shower(dimension);
    const double before = shower.in_the_air(rain_name);
    const double drops = shower.in_the_air(drops_name);
    for (int i = 0; i < 40; ++i) {
      shower.step(i % 5 == 0 ? 60.0 : 4.0);  // Courant numbers from below one to nine
      EXPECT_NEAR((shower.in_the_air(rain_name) + shower.on_the_ground("rainfall_amount")) / before,
                  1.0, 1e-13);
      for (std::size_t p = 0; p < shower.store.size(); ++p) {
        ASSERT_GE(shower.values(rain_name)[p], 0.0);
        ASSERT_GE(shower.values(drops_name)[p], 0.0);
      }
    }
    EXPECT_GT(shower.on_the_ground("rainfall_amount"), 0.99 * before);
    // Drops fall more slowly than their mass, and more so the smaller those are that are left.
    const double fallen = shower.on_the_ground("raindrop_number_at_surface");
    EXPECT_GT(fallen, 0.1 * drops);
    const OperatorBudget water = shower.sequence.ledger().operators.front().budgets.front();
    EXPECT_NEAR(water.change / before, (shower.in_the_air(rain_name) - before) / before, 1e-12);
    EXPECT_NEAR(water.defect() / before, 0.0, 1e-13);
  }
}

TEST(RainSedimentation, falls_within_its_column) {
  Shower shower(3);
  for (std::size_t p = 0; p < shower.store.size(); ++p) {
    const bool there = shower.store.position(0)[p] < 100 && shower.store.position(1)[p] > 300;
    if (!there) shower.values(rain_name)[p] = shower.values(drops_name)[p] = 0;
  }
  for (int i = 0; i < 60; ++i) shower.step(20);
  const auto& ground = shower.sequence.surface().values(
      static_cast<std::size_t>(shower.sequence.surface().find("rainfall_amount")));
  ASSERT_EQ(ground.size(), 12u);
  for (std::size_t k = 0; k < 12; ++k) EXPECT_EQ(ground[k] > 0, k == 0 + 4 * 2) << k;
}

TEST(RainSedimentation, ends_at_a_ground_above_the_bottom) {
  // Faces lie at 0, 50, … 500 m: 161 m is nearest to 150 m.
  Shower shower(2, {{"ground", {"161", false, {}, {}, {}}}});
  const double before = shower.in_the_air(rain_name);
  double buried = 0;
  for (std::size_t p = 0; p < shower.store.size(); ++p)
    if (shower.store.position(1)[p] < 150)
      buried += shower.store.volume()[p] * shower.values(rain_name)[p];
  ASSERT_GT(buried, 0.1 * before);
  shower.step(1e-9);  // nothing falls far
  EXPECT_NEAR(shower.on_the_ground("rainfall_amount") / buried, 1.0, 1e-9);
  for (int i = 0; i < 30; ++i) {
    shower.step(i % 5 == 0 ? 60.0 : 4.0);
    EXPECT_NEAR((shower.in_the_air(rain_name) + shower.on_the_ground("rainfall_amount")) / before,
                1.0, 1e-13);
    for (std::size_t p = 0; p < shower.store.size(); ++p) {
      const bool below = shower.store.position(1)[p] < 150;
      ASSERT_EQ(below && shower.values(rain_name)[p] != 0, false) << p;
      ASSERT_EQ(below && shower.values(drops_name)[p] != 0, false) << p;
    }
  }
  EXPECT_GT(shower.on_the_ground("rainfall_amount"), 0.99 * before);
}

TEST(RainSedimentation, falls_out_at_once_below_a_ground_above_everything) {
  Shower shower(3, {{"ground", {"1e5", false, {}, {}, {}}}});
  const double before = shower.in_the_air(rain_name);
  shower.step(1);
  EXPECT_EQ(shower.in_the_air(rain_name), 0.0);
  EXPECT_NEAR(shower.on_the_ground("rainfall_amount") / before, 1.0, 1e-13);
}

TEST(RainSedimentation, does_nothing_without_rain) {
  Shower shower(2);
  std::fill_n(shower.values(rain_name), shower.store.size(), 0.0);
  std::fill_n(shower.values(drops_name), shower.store.size(), 0.0);
  shower.step(10);
  EXPECT_EQ(shower.in_the_air(rain_name), 0.0);
  EXPECT_EQ(shower.on_the_ground("rainfall_amount"), 0.0);
  EXPECT_EQ(shower.sequence.ledger().operators.front().repairs, 0u);
}

}  // namespace
}  // namespace pileus::coupling
