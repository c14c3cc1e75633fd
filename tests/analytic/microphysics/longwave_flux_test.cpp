// The idealised longwave flux of stratocumulus against its closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "../../../plugins/longwave_cooling/radiative_flux.hpp"

namespace pileus::longwave {
namespace {

/// The flux parameters of Stevens et al. (2005), DYCOMS-II RF01.
Flux rf01() {
  Flux flux;
  flux.divergence = 3.75e-6;
  return flux;
}

struct Cooled {
  Column column;
  std::vector<double> convergence;  // W m⁻³
  double total = 0;                 // W m⁻²
};

Cooled cool(const Flux& flux, std::size_t levels, double spacing, double base, double top,
            double liquid_content, double inversion) {
  Cooled result{{0, spacing, levels}, std::vector<double>(levels), 0};
  std::vector<double> density(levels, 1.1), liquid(levels, 0.0);
  for (std::size_t k = 0; k < levels; ++k) {
    const double z = result.column.height(k);
    if (z > base && z < top) liquid[k] = liquid_content;
  }
  heating(result.column, flux, density, liquid, inversion, 1.1, result.convergence);
  for (std::size_t k = 0; k < levels; ++k)
    result.total += result.convergence[k] * result.column.depth(k);
  return result;
}

TEST(LongwaveFlux, adds_up_to_the_difference_of_its_ends) {
  Flux flux;
  const Cooled cloud = cool(flux, 151, 10, 604, 841, 0.25e-3, 0);
  const double path = 1.1 * 0.25e-3 * 10 * 24;  // levels 610 ... 840 m
  const double bottom = flux.above * std::exp(-flux.absorption * path) + flux.below;
  const double top = flux.above + flux.below * std::exp(-flux.absorption * path);
  EXPECT_NEAR(cloud.total, bottom - top, 1e-12 * top);
  // A cloud of 66 g m⁻² is nearly black: F_0 less F_1 is lost (Stevens et al. 2005, fig. 2).
  EXPECT_NEAR(cloud.total, -(70 - 22), 0.01 * 48);
}

TEST(LongwaveFlux, cools_the_top_and_warms_the_base) {
  const Cooled cloud = cool({}, 151, 10, 604, 841, 0.5e-3, 0);
  EXPECT_LT(cloud.convergence[84], 0);   // 840 m
  EXPECT_GT(cloud.convergence[61], 0);   // 610 m
  EXPECT_EQ(cloud.convergence[30], 0);   // below the cloud
  EXPECT_EQ(cloud.convergence[120], 0);  // above
  for (std::size_t k = 0; k < 151; ++k) EXPECT_GE(cloud.convergence[k], cloud.convergence[84]);
}

TEST(LongwaveFlux, without_liquid_nothing_happens) {
  const Cooled clear = cool({}, 31, 50, 0, 0, 0, 0);
  for (const double c : clear.convergence) EXPECT_EQ(c, 0.0);
}

/// θ = 297.5 K + ((z − z_i)/1 m)^{1/3} above the inversion is steady under subsidence w = −D z and
/// this cooling: ρ c_p D z dθ/dz of warming (Stevens et al. 2005, section 2).
TEST(LongwaveFlux, in_clear_air_balances_subsidence) {
  const double z_i = 840;
  const Flux flux = rf01();
  const Cooled clear = cool(flux, 1501, 1, 0, 0, 0, z_i);
  for (const std::size_t z : {900, 1000, 1200, 1400}) {
    const double rise = static_cast<double>(z) - z_i;
    const double slope = std::pow(rise, -2.0 / 3) / 3;
    const double warming =
        1.1 * flux.heat_capacity * flux.divergence * static_cast<double>(z) * slope;
    EXPECT_NEAR(clear.convergence[z], -warming, 1e-3 * warming) << z;
  }
}

TEST(LongwaveFlux, finds_the_inversion) {
  const Column column{100, 10, 4};
  EXPECT_DOUBLE_EQ(inversion_height(column, std::vector<double>{9, 9, 5, 1}, 8), 112.5);
  EXPECT_DOUBLE_EQ(inversion_height(column, std::vector<double>{9, 5, 9, 1}, 8), 121.25);
  EXPECT_DOUBLE_EQ(inversion_height(column, std::vector<double>{1, 1, 1, 1}, 8), 100);
  EXPECT_DOUBLE_EQ(inversion_height(column, std::vector<double>{9, 9, 9, 9}, 8), 130);
}

}  // namespace
}  // namespace pileus::longwave
