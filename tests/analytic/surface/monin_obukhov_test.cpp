// The surface layer of Monin & Obukhov: stability functions, fluxes of given winds and
// temperatures, and that every search ends.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "../../../plugins/surface_fluxes/bulk.hpp"
#include "../../../plugins/surface_fluxes/monin_obukhov.hpp"

namespace pileus::surface {
namespace {

constexpr StabilityFunctions both[] = {StabilityFunctions::businger_dyer,
                                       StabilityFunctions::wilson};

/// Values of Dyer's functions, ψ = ∫(1 − φ)dζ/ζ, to the digits given.
TEST(StabilityFunctions, HaveTheValuesOfTheirIntegrals) {
  const struct {
    double zeta, momentum, heat;
  } table[] = {{-0.1, 0.28361, 0.53428},
               {-0.5, 0.79336, 1.38629},
               {-1, 1.11623, 1.88123},
               {-2, 1.49469, 2.43118},
               {-5, 2.06844, 3.21888},
               {0.1, -0.5, -0.5},
               {1, -5, -5}};
  for (const auto& row : table) {
    EXPECT_NEAR(psi_m(StabilityFunctions::businger_dyer, row.zeta), row.momentum, 5.1e-6);
    EXPECT_NEAR(psi_h(StabilityFunctions::businger_dyer, row.zeta), row.heat, 5.1e-6);
  }
}

/// The closed forms as printed (Wilson 2001; Beljaars & Holtslag 1991).
TEST(StabilityFunctions, OfWilsonAreThePrintedOnes) {
  for (const double zeta : {-20.0, -1.0, -0.03}) {
    const double root = std::pow(-zeta, 2.0 / 3.0);
    EXPECT_NEAR(psi_m(StabilityFunctions::wilson, zeta),
                3 * std::log((1 + std::sqrt(1 + 3.6 * root)) / 2), 1e-13);
    EXPECT_NEAR(psi_h(StabilityFunctions::wilson, zeta),
                3 * std::log((1 + std::sqrt(1 + 7.9 * root)) / 2), 1e-13);
  }
  for (const double zeta : {0.02, 0.7, 5.0, 40.0}) {
    const double part = -2.0 / 3 * (zeta - 5 / 0.35) * std::exp(-0.35 * zeta);
    EXPECT_NEAR(psi_m(StabilityFunctions::wilson, zeta), part - zeta - 2.0 / 3 * 5 / 0.35, 1e-12);
    EXPECT_NEAR(psi_h(StabilityFunctions::wilson, zeta),
                part - std::pow(1 + 2.0 / 3 * zeta, 1.5) - 2.0 / 3 * 5 / 0.35 + 1, 1e-11);
  }
}

TEST(StabilityFunctions, FallWithStabilityAndVanishAtNeutral) {
  for (const StabilityFunctions f : both) {
    EXPECT_EQ(psi_m(f, 0), 0);
    EXPECT_EQ(psi_h(f, 0), 0);
    double m = 1e300, h = 1e300;
    for (double zeta = -100; zeta < 100; zeta += 0.01) {
      EXPECT_LT(psi_m(f, zeta), m);
      EXPECT_LT(psi_h(f, zeta), h);
      m = psi_m(f, zeta), h = psi_h(f, zeta);
    }
  }
}

TEST(StabilityFunctions, GradientOfTheWindIsThatOfItsProfile) {
  for (const StabilityFunctions f : both)
    for (double zeta = 0.01; zeta < 20; zeta *= 1.3) {
      const double d = 1e-5 * zeta;
      const double slope = (psi_m(f, zeta + d) - psi_m(f, zeta - d)) / (2 * d);
      if (std::abs(zeta - 1) < 2 * d) continue;  // where Dyer's changes
      EXPECT_NEAR(stable_phi_m(f, zeta), 1 - zeta * slope, 1e-8 * (1 + zeta));
    }
}

SimilaritySettings without_gusts(double theta = 300) {
  SimilaritySettings s;
  s.reference_temperature = theta;
  s.gust_depth = 0;
  return s;
}

/// Neutral layers: u* = κU/ln(z_1/z_0), to the digits given.
TEST(Similarity, NeutralLayers) {
  const struct {
    double wind, height, roughness, friction;
  } table[] = {{8, 10, 0.1, 0.69487}, {8, 10, 2e-4, 0.29575}, {10, 50, 0.1, 0.64364}};
  for (const auto& row : table) {
    const Similarity layer(without_gusts(), {row.height, row.roughness, row.roughness});
    for (const Exchange& e : {layer.of_flux(row.wind, 0), layer.of_difference(row.wind, 0)}) {
      EXPECT_NEAR(e.friction_velocity, row.friction, 5.1e-6);
      EXPECT_EQ(e.stability, 0);
    }
  }
  const Similarity sea(without_gusts(), {10, 2e-4, 2e-4});
  EXPECT_NEAR(std::pow(sea.of_flux(8, 0).friction_velocity / 8, 2), 1.3667e-3, 5.1e-8);
}

/// Wind, height, z_0 = z_0h, flux and θ_00, and what follows from them by an independent solution.
TEST(Similarity, StratifiedLayers) {
  const struct {
    double wind, height, roughness, flux, theta, friction, length, scale, difference;
  } table[] = {{5, 10, 0.1, 0.1, 300, 0.46822, -78.477, -0.21358, -2.12684},
               {5, 16.5, 0.01, 0.1, 300, 0.31000, -22.777, -0.32258, -4.65220},
               {1, 10, 0.1, 0.24, 300, 0.16095, -1.3282, -1.49114, -5.41370},
               {5, 10, 0.1, 0.01, 300, 0.43971, -649.96, -0.02274, -0.25547},
               {8, 10, 0.1, -0.02, 265, 0.68815, 1100.36, 0.02906, 0.33787}};
  for (const auto& row : table) {
    const Similarity layer(without_gusts(row.theta), {row.height, row.roughness, row.roughness});
    const Exchange by_flux = layer.of_flux(row.wind, row.flux);
    const double difference = -row.flux / by_flux.transfer;
    EXPECT_NEAR(by_flux.friction_velocity, row.friction, 1e-4 * row.friction);
    EXPECT_NEAR(row.height / by_flux.stability, row.length, 1e-4 * std::abs(row.length));
    EXPECT_NEAR(-row.flux / by_flux.friction_velocity, row.scale, 3e-4 * std::abs(row.scale));
    EXPECT_NEAR(difference, row.difference, 1e-4 * std::abs(row.difference));
    // The difference leads back to the flux.
    const Exchange by_difference = layer.of_difference(row.wind, difference);
    EXPECT_NEAR(by_difference.transfer * -difference, row.flux, 1e-10 * std::abs(row.flux));
    EXPECT_NEAR(by_difference.stability, by_flux.stability, 1e-10 * std::abs(by_flux.stability));
  }
}

struct Case {
  SimilaritySettings settings;
  SurfaceLayer layer;
  double wind, difference, flux;
};

Case draw(std::mt19937_64& random) {
  std::uniform_real_distribution<double> u(0, 1);
  const auto between = [&](double low, double high) { return low + (high - low) * u(random); };
  const auto logarithmic = [&](double low, double high) {
    return low * std::pow(high / low, u(random));
  };
  Case c;
  c.settings.functions = both[random() % 2];
  c.settings.gust_depth = random() % 2 == 0 ? 0 : 1000;
  c.layer.height = logarithmic(1, 200);
  c.layer.roughness = logarithmic(1e-5, std::min(1.0, 0.499 * c.layer.height));
  c.layer.heat_roughness =
      random() % 2 == 0 ? c.layer.roughness : c.layer.roughness * logarithmic(1e-3, 1);
  c.wind = random() % 20 == 0 ? 0 : logarithmic(0.1, 50);
  c.difference = between(-20, 20) * logarithmic(1e-9, 1);
  c.flux = between(-0.5, 1) * logarithmic(1e-9, 1);
  return c;
}

/// The equation solved, ζ = −z_1 κ g <w'θ_v'> F_m³/(θ_00 (κU)³).
void expect_consistent(const Case& c, const Exchange& e, double flux) {
  const double k = c.settings.von_karman, u = e.friction_velocity;
  const double zeta = -c.layer.height * k * c.settings.gravity * flux /
                      (c.settings.reference_temperature * u * u * u);
  EXPECT_NEAR(e.stability, zeta, 1e-10 * std::abs(zeta));
  const double gust =
      c.settings.gust_factor * std::cbrt(c.settings.gravity * std::max(flux, 0.0) *
                                         c.settings.gust_depth / c.settings.reference_temperature);
  EXPECT_NEAR(e.wind, std::hypot(std::max(c.wind, 0.1), gust), 1e-9 * e.wind);
}

TEST(Similarity, EverySearchEndsAtASolution) {
  std::mt19937_64 random(1);
  int most = 0, decoupled = 0;
  for (int n = 0; n < 40000; ++n) {
    const Case c = draw(random);
    SCOPED_TRACE(::testing::Message()
                 << n << ": U " << c.wind << " z1 " << c.layer.height << " z0 " << c.layer.roughness
                 << " z0h " << c.layer.heat_roughness << " d " << c.difference << " Q " << c.flux);
    const Similarity layer(c.settings, c.layer);
    const Exchange a = layer.of_difference(c.wind, c.difference);
    ASSERT_TRUE(a.coupled);
    expect_consistent(c, a, -a.transfer * c.difference);
    const Exchange b = layer.of_flux(c.wind, c.flux);
    if (b.coupled)
      expect_consistent(c, b, c.flux);
    else
      ++decoupled;
    most = std::max({most, a.evaluations, b.evaluations});
    ASSERT_FALSE(HasFailure());
  }
  EXPECT_LE(most, most_similarity_evaluations);
  EXPECT_GT(decoupled, 0);
}

/// A wind carries up to a certain flux downwards and none beyond; up to there ζ is continuous.
/// Linear functions end at ζ = ln(z_1/z_0)/(10 (1 − z_0/z_1)), where F_m has grown by a half.
TEST(Similarity, DecouplesBeyondTheLargestDownwardFlux) {
  const Similarity layer(without_gusts(), {10, 0.1, 0.1});
  const double end = std::log(100.0) / 9.9, k = 0.4, u = 2.0 / 3 * k * 5 / std::log(100.0);
  const double flux = end * 300 * u * u * u / (10 * k * 9.81);
  const Exchange below = layer.of_flux(5, -flux * (1 - 1e-6));
  ASSERT_TRUE(below.coupled);
  EXPECT_NEAR(below.stability, end, 3e-3 * end);
  EXPECT_NEAR(below.friction_velocity, u, 3e-3 * u);
  const Exchange above = layer.of_flux(5, -flux * (1 + 1e-6));
  EXPECT_FALSE(above.coupled);
  EXPECT_EQ(above.friction_velocity, 0);
  EXPECT_EQ(above.drag(), 0);
}

/// u* of a wind of 5 m/s at 50 m by bisection of the equation, as the table of docs/surface.md.
/// There is a largest flux where ln(z_1/z_0) ≤ 10 (1 − z_0/z_1): z_0 above 2.27 mm.
TEST(Similarity, SmoothGroundCarriesWhatRoughGroundDecouplesFrom) {
  const struct {
    double roughness, friction[5];
  } table[] = {{1e-3, {0.1848, 0.1750, 0.0793, 0.0520, 0.0331}},
               {5e-3, {0.2171, 0.2090, 0, 0, 0}},
               {0.1, {0.3218, 0.3166, 0.2908, 0, 0}}};
  constexpr double fluxes[] = {0, -0.001, -0.005, -0.02, -0.5};
  for (const auto& row : table)
    for (int i = 0; i < 5; ++i) {
      const Similarity layer(without_gusts(), {50, row.roughness, row.roughness});
      const Exchange e = layer.of_flux(5, fluxes[i]);
      EXPECT_NEAR(e.friction_velocity, row.friction[i], 5.1e-5) << row.roughness << fluxes[i];
      EXPECT_EQ(e.coupled, row.friction[i] > 0);
    }
  SimilaritySettings wilson = without_gusts();
  wilson.functions = StabilityFunctions::wilson;
  for (const double roughness : {1e-3, 0.1})
    EXPECT_FALSE(Similarity(wilson, {50, roughness, roughness}).of_flux(5, -0.5).coupled);
}

/// Where no flux is the largest, u* falls without a jump: −d ln u*/d ln Q = d/(F_m − 3d) with
/// d = φ_m(ζ) − φ_m(ζ z_0/z_1) is largest at ζ = 1, where it is 5 (1 − r)/(ln(z_1/z_0) − 10 (1 −
/// r)), r = z_0/z_1. It never falls below κU/(6 ln(z_1/z_0)): φ = 6 all the way down.
TEST(Similarity, SmoothGroundHasNoJump) {
  const double z1 = 50, z0 = 1e-3, r = z0 / z1, logarithm = std::log(z1 / z0);
  const double steepest = 5 * (1 - r) / (logarithm - 10 * (1 - r));
  const Similarity layer(without_gusts(), {z1, z0, z0});
  double flux = -1e-6, before = layer.of_flux(5, flux).friction_velocity;
  while (flux > -100) {
    flux *= 1.001;
    const double friction = layer.of_flux(5, flux).friction_velocity;
    ASSERT_LT(friction, before * (1 + 1e-12)) << flux;
    ASSERT_GT(std::log(friction / before), -1.001 * steepest * std::log(1.001)) << flux;
    before = friction;
  }
  EXPECT_GE(before, 0.4 * 5 / (6 * logarithm) * (1 - 1e-12));
}

/// The exchange falls with stability without a jump, over a given temperature of the ground.
TEST(Similarity, ExchangeFallsWithTheDifference) {
  for (const StabilityFunctions f : both) {
    SimilaritySettings s = without_gusts();
    s.functions = f;
    const Similarity layer(s, {10, 0.01, 0.001});
    double before = 1e300;
    for (double difference = -20; difference <= 20; difference += 0.05) {
      const double transfer = layer.of_difference(3, difference).transfer;
      EXPECT_LT(transfer, before);
      before = transfer;
    }
    EXPECT_GT(before, 0);
  }
}

TEST(Similarity, FreeConvectionNeedsNoWind) {
  SimilaritySettings s;
  const Similarity layer(s, {10, 0.01, 0.01});
  const Exchange e = layer.of_difference(0, -5);
  const double flux = e.transfer * 5;
  EXPECT_NEAR(e.wind, std::hypot(0.1, 1.2 * std::cbrt(9.81 / 300 * flux * 1000)), 1e-9 * e.wind);
  EXPECT_GT(flux, 0.05);
}

/// z_0 = α u*²/g + 0.11 ν/u*, by substituting until nothing changes; COARE 3.0 for heat.
TEST(Charnock, RoughnessBelongsToTheFrictionVelocity) {
  const Charnock sea;
  for (const double wind : {0.2, 1.0, 5.0, 15.0, 40.0})
    for (const double difference : {-8.0, 0.0, 3.0}) {
      const auto solve = [&](const SurfaceLayer& layer) {
        return Similarity(without_gusts(), layer).of_difference(wind, difference);
      };
      const Exchange e = over_waves(sea, 10, solve);
      const double u = e.friction_velocity;
      const double z = 0.011 * u * u / 9.81 + 0.11 * 1.5e-5 / u;
      const double heat = std::min(1.1e-4, 5.5e-5 * std::pow(z * u / 1.5e-5, -0.6));
      EXPECT_NEAR(solve({10, std::min(z, 2.5), heat}).friction_velocity, u, 1e-10 * u);
      EXPECT_LE(e.evaluations, 1 + 160 * most_similarity_evaluations);
    }
  // 8 m/s at 10 m over a neutral sea: C_D is 1.1e-3 with α = 0.011 (COARE 3.0, 1.0 … 1.2e-3).
  const Exchange e = over_waves(sea, 10, [&](const SurfaceLayer& layer) {
    return Similarity(without_gusts(), layer).of_flux(8, 0);
  });
  EXPECT_NEAR(std::pow(e.friction_velocity / 8, 2), 1.1e-3, 1e-4);
}

TEST(Charnock, EveryWindHasARoughness) {
  std::mt19937_64 random(2);
  for (int n = 0; n < 2000; ++n) {
    const Case c = draw(random);
    const Exchange e = over_waves({}, c.layer.height, [&](const SurfaceLayer& layer) {
      return Similarity(c.settings, layer).of_flux(c.wind, c.flux);
    });
    ASSERT_TRUE(std::isfinite(e.friction_velocity) && e.friction_velocity >= 0) << n;
    ASSERT_LE(e.evaluations, 160 * most_similarity_evaluations);
  }
}

/// RICO (van Zanten et al. 2011): coefficients of 20 m at the 40 m of its first level.
TEST(Bulk, CoefficientsAtAnotherHeight) {
  const BulkCoefficients rico{0.001229, 0.001094, 0.001133, 20};
  EXPECT_EQ(rico.adjustment(20, 2e-4), 1);
  EXPECT_NEAR(rico.adjustment(40, 2e-4), std::pow(std::log(1e5) / std::log(2e5), 2), 1e-15);
}

}  // namespace
}  // namespace pileus::surface
