// Column budgets of the forcings of trade-wind cumulus on its initial profiles, from integrals by
// hand: with θ_l = 298.7, 298.7, 302.4, 308.2, 311.85 K at 0, 520, 1480, 2000, 3000 m and
// w = −0.0065 m s⁻¹ at 1500 m, 0 at 0 and 2100 m, −∫ w dθ_l/dz dz = 3.882e-2 K m s⁻¹; −2 K per day
// to 1500 m and to zero at 3000 m (2500 m) −5.208e-2 (−4.630e-2) K m s⁻¹; with q_t =
// 17, 16.3, 10.7, 4.2, 3 g kg⁻¹ −∫ w dq_t/dz dz = −5.043e-5 m s⁻¹; −1.2e-8 s⁻¹ to 300 m, zero at
// 500 m −4.8e-6.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numeric>

#include "../../../plugins/large_scale_forcing/level_sources.hpp"
#include "column.hpp"

namespace pileus::large_scale {
namespace {

template <std::size_t N>
PiecewiseLinear profile_of(const std::array<double, N>& points) {
  return PiecewiseLinear(points);
}

PiecewiseLinear theta() {
  return profile_of<10>({0, 298.7, 520, 298.7, 1480, 302.4, 2000, 308.2, 3000, 311.85});
}
PiecewiseLinear water() {
  return profile_of<10>({0, 17e-3, 520, 16.3e-3, 1480, 10.7e-3, 2000, 4.2e-3, 3000, 3e-3});
}
PiecewiseLinear subsidence() {
  return profile_of<6>({0, 0, 1500, -0.0065, 2100, 0});
}

double subsidence_budget(const PiecewiseLinear& scalar, const Levels& levels) {
  const Cloud cloud = even_cloud(levels, 2);
  std::vector<double> values, sources(levels.count(), 0.0);
  for (const double z : cloud.height) values.push_back(scalar(z));
  std::vector<LayerIntegrals> velocity;
  for (std::size_t k = 0; k < levels.cells; ++k)
    velocity.push_back(layer_integrals(subsidence(), levels, k));
  const Gathered gathered(levels, cloud, {values.data()}, in_order);
  add_subsidence(levels, gathered.means, 0, velocity, sources.data());
  return std::accumulate(sources.begin(), sources.end(), 0.0);
}

double tendency_budget(const PiecewiseLinear& tendency, const Levels& levels) {
  double sum = 0;
  for (std::size_t k = 0; k < levels.count(); ++k) sum += hat_integral(tendency, levels, k);
  return sum;
}

constexpr double per_day = 1.0 / 86400;

TEST(BomexBudgets, of_subsidence) {
  for (const std::size_t cells : {std::size_t{30}, std::size_t{90}}) {
    const Levels levels{0, 3000.0 / static_cast<double>(cells), cells};
    EXPECT_NEAR(subsidence_budget(theta(), levels), 3.882e-2, 0.002 * 3.882e-2) << cells;
    EXPECT_NEAR(subsidence_budget(water(), levels), -5.043e-5, 0.002 * 5.043e-5) << cells;
    RecordProperty("theta_" + std::to_string(cells),
                   std::to_string(1e2 * subsidence_budget(theta(), levels)));
    RecordProperty("water_" + std::to_string(cells),
                   std::to_string(1e5 * subsidence_budget(water(), levels)));
  }
}

TEST(BomexBudgets, of_cooling_and_drying_are_exact_on_any_levels) {
  const double cold = -2 * per_day;
  const PiecewiseLinear deep = profile_of<4>({1500, cold, 3000, 0});
  const PiecewiseLinear shallow = profile_of<4>({1500, cold, 2500, 0});
  const PiecewiseLinear drying = profile_of<4>({300, -1.2e-8, 500, 0});
  for (const std::size_t cells : {std::size_t{7}, std::size_t{30}, std::size_t{90}}) {
    const Levels levels{0, 3000.0 / static_cast<double>(cells), cells};
    EXPECT_NEAR(tendency_budget(deep, levels), cold * 2250, 1e-15) << cells;
    EXPECT_NEAR(tendency_budget(deep, levels), -5.208e-2, 1e-5) << cells;
    EXPECT_NEAR(tendency_budget(shallow, levels), cold * 2000, 1e-15) << cells;
    EXPECT_NEAR(tendency_budget(shallow, levels), -4.630e-2, 1e-5) << cells;
    EXPECT_NEAR(tendency_budget(drying, levels), -4.8e-6, 1e-19) << cells;
  }
}

}  // namespace
}  // namespace pileus::large_scale
