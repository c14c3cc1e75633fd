// Rain falling from cell to cell against the exact displacement and the numerical diffusion it has.
#include "../../../plugins/rain_sedimentation/sedimentation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "../../../plugins/rain_sedimentation/fall_speed.hpp"

namespace pileus::sedimentation {
namespace {

TEST(FallSpeed, equals_the_formulas_of_seifert_and_beheng) {
  const auto at = [](double rain, double drops) {
    return fall_speeds(FallSpeedScheme::seifert_beheng, rain / drops, drops::surface_density);
  };
  EXPECT_NEAR(at(1e-4, 1e4).number, 0.185357, 0.6e-6);
  EXPECT_NEAR(at(1e-4, 1e4).mass, 2.306464, 0.6e-6);
  EXPECT_NEAR(at(1e-3, 1e4).number, 0.995645, 0.6e-6);
  EXPECT_NEAR(at(1e-3, 1e4).mass, 4.516338, 0.6e-6);
  EXPECT_NEAR(at(1e-3, 1e3).number, 2.343328, 0.6e-6);
  EXPECT_NEAR(at(1e-3, 1e3).mass, 7.041644, 0.6e-6);
  EXPECT_EQ(fall_speeds(FallSpeedScheme::khairoutdinov_kogan, drops::mass_of_radius(10e-6), 1).mass,
            0.0);
  const FallSpeeds drizzle =
      fall_speeds(FallSpeedScheme::khairoutdinov_kogan, drops::mass_of_radius(50e-6), 1);
  EXPECT_NEAR(drizzle.mass, 0.4, 1e-12);
  EXPECT_NEAR(drizzle.number, 0.25, 1e-12);
}

/// A column of parcels of random volumes at rest in cells of 33 m.
struct Column {
  static constexpr double depth = 33;
  static constexpr std::size_t per_cell = 20;
  std::vector<double> volume, amount, cell_volume;
  double ground = 0;
  std::size_t cells;

  explicit Column(std::size_t cell_count, unsigned seed = 1) : cells(cell_count) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> size(0.5, 1.5);
    for (std::size_t p = 0; p < cells * per_cell; ++p) volume.push_back(size(random));
    amount.assign(volume.size(), 0.0);
    cell_volume.assign(cells, 0.0);
    for (std::size_t p = 0; p < volume.size(); ++p) cell_volume[p / per_cell] += volume[p];
  }
  void fill(std::size_t cell, double value) {
    for (std::size_t p = cell * per_cell; p < (cell + 1) * per_cell; ++p) amount[p] = value;
  }
  /// One step as the operator does it.
  void step(const std::vector<double>& courant) {
    std::vector<double> held(cells, 0.0), kept(cells), room(cells);
    for (std::size_t p = 0; p < volume.size(); ++p) held[p / per_cell] += volume[p] * amount[p];
    FallingAmount falling{held, kept};
    fall(falling, courant, cell_volume, room);
    for (std::size_t p = 0; p < volume.size(); ++p) {
      const std::size_t k = p / per_cell;
      amount[p] = amount[p] * kept[k] + held[k] / cell_volume[k];
    }
    ground += falling.ground;
  }
  double total() const {
    double sum = ground;
    for (std::size_t p = 0; p < volume.size(); ++p) sum += volume[p] * amount[p];
    return sum;
  }
  /// Mean height and its variance, in cells.
  std::pair<double, double> moments() const {
    double sum = 0, first = 0, second = 0;
    for (std::size_t p = 0; p < volume.size(); ++p) {
      const double m = volume[p] * amount[p], z = static_cast<double>(p / per_cell);
      sum += m, first += m * z, second += m * z * z;
    }
    return {first / sum, second / sum - first / sum * (first / sum)};
  }
};

TEST(Sedimentation, of_a_layer_falls_by_v_t_and_spreads_as_upwind_transport_does) {
  // 2000 m of fall in columns deep enough that nothing reaches the ground.
  // Of an independent program, m; a step more or less is 0.8 m at the Courant number 0.76.
  const double spread[] = {253, 237, 127, 95};
  int i = 0;
  for (const double courant : {0.03, 0.15, 0.76, 1.21}) {
    const auto steps = static_cast<int>(std::lround(2000 / (courant * Column::depth)));
    Column column(200);
    column.fill(180, 1e-3);
    const double before = column.total();
    const double start = column.moments().first;
    for (int k = 0; k < steps; ++k) column.step(std::vector<double>(column.cells, courant));
    const auto [mean, variance] = column.moments();
    EXPECT_NEAR((start - mean) / (courant * steps), 1.0, 1e-10) << courant;
    const double f = courant - std::floor(courant);
    EXPECT_NEAR(variance / (steps * f * (1 - f)), 1.0, 1e-9) << courant;  // exact for one speed
    EXPECT_NEAR(std::sqrt(variance) * Column::depth, spread[i++], 1.0) << courant;
    EXPECT_NEAR(column.total() / before, 1.0, 1e-13) << courant;
    for (const double q : column.amount) ASSERT_GE(q, 0.0);
  }
}

TEST(Sedimentation, conserves_for_every_courant_number_and_empties_onto_the_ground) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> exponent(-3, 3);
  for (int run = 0; run < 50; ++run) {
    Column column(40, static_cast<unsigned>(run));
    std::uniform_real_distribution<double> rain(0, 1e-3);
    for (double& q : column.amount) q = run % 3 == 0 && random() % 2 == 0 ? 0.0 : rain(random);
    const double before = column.total();
    for (int k = 0; k < 30; ++k) {
      std::vector<double> courant(column.cells);
      for (double& c : courant) c = std::pow(10.0, exponent(random));
      column.step(courant);
      ASSERT_NEAR(column.total() / before, 1.0, 1e-13);
      for (const double q : column.amount) ASSERT_GE(q, 0.0);
    }
    column.step(std::vector<double>(column.cells, 1e9));
    EXPECT_NEAR(column.ground / before, 1.0, 1e-13);
  }
}

TEST(Sedimentation, passes_by_cells_without_parcels) {
  std::vector<double> held = {0, 0, 0, 5}, kept(4), room(4);
  const std::vector<double> courant(4, 0.5), volume = {1, 0, 0, 1};
  FallingAmount amount{held, kept};
  fall(amount, courant, volume, room);
  EXPECT_EQ(kept[3], 0.5);
  EXPECT_EQ(held[0], 2.5);
  EXPECT_EQ(held[3], 0.0);
  EXPECT_EQ(amount.ground, 0.0);
}

TEST(Sedimentation, leaves_rain_that_does_not_fall) {
  std::vector<double> held = {1, 2, 3}, kept(3), room(3);
  FallingAmount amount{held, kept};
  fall(amount, std::vector<double>(3, 0.0), std::vector<double>(3, 1.0), room);
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(kept[k], 1.0);
    EXPECT_EQ(held[k], 0.0);
  }
}

}  // namespace
}  // namespace pileus::sedimentation
