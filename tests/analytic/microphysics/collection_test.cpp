// Collection against the formulas' own values, an exact solution and independent integrations.
#include "../../../plugins/two_moment/collection.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace pileus::two_moment {
namespace {

TEST(KhairoutdinovKogan, rates_equal_the_fits) {
  using Kogan = KhairoutdinovKogan;
  EXPECT_NEAR(Kogan::autoconversion(5e-4, 50), 8.622503e-9, 0.6e-15);
  EXPECT_NEAR(Kogan::autoconversion(1e-3, 50), 4.777244e-8, 0.6e-14);
  EXPECT_NEAR(Kogan::autoconversion(1e-3, 100), 1.381446e-8, 0.6e-14);
  EXPECT_NEAR(Kogan::autoconversion(1e-3, 500), 7.747783e-10, 0.6e-16);
  EXPECT_NEAR(Kogan::accretion(1e-3, 1e-4), 5.971381e-7, 0.6e-13);
  EXPECT_NEAR(Kogan::accretion(2e-3, 1e-3), 1.871799e-5, 0.6e-11);
  EXPECT_NEAR(Kogan::drizzle_mass, mass_of_radius(25e-6), 1e-25);
}

TEST(SeifertBeheng, rates_equal_the_formulas) {
  const SeifertBeheng sb;
  EXPECT_NEAR(sb.autoconversion(1e-3, 1e8, 0, 1.225), 3.201923e-10, 0.6e-16);
  EXPECT_NEAR(sb.droplet_merging(1e-3, 1.225), 6660.0, 1e-9);
  EXPECT_NEAR(sb.autoconversion(1e-3, 1e8, 1e-4, 1), 1.945790e-8, 0.6e-14);
  EXPECT_NEAR(SeifertBeheng::accretion(1e-3, 1e-4, 1), 5.797919e-7, 0.6e-13);
  EXPECT_NEAR(sb.droplet_merging(1e-3, 1), 8158.5, 1e-9);
  EXPECT_NEAR(SeifertBeheng::raindrop_merging(1e-4, 1e4, 1e-8, 1), 5.567232, 0.6e-6);
  EXPECT_NEAR(sb.autoconversion(5e-4, 5e7, 5e-4, 1), 5.585000e-9, 0.6e-15);
  EXPECT_NEAR(SeifertBeheng::accretion(5e-4, 5e-4, 1), 1.452090e-6, 0.6e-12);
  const double merging = SeifertBeheng::raindrop_merging(5e-4, 2e3, 2.5e-7, 1);
  EXPECT_NEAR(merging, 3.032777, 0.6e-6);
  EXPECT_NEAR(merging * (SeifertBeheng::breakup(2.5e-7) + 1), 2.673673, 0.6e-6);
  // Break-up balances merging at 0.9 mm and exceeds it beyond, continuously.
  const double equilibrium = pi / 6 * water_density * std::pow(0.9e-3, 3);
  EXPECT_NEAR(SeifertBeheng::breakup(equilibrium), 0.0, 1e-12);
  EXPECT_EQ(SeifertBeheng::breakup(1e-10), -1.0);
  EXPECT_GT(SeifertBeheng::breakup(2 * equilibrium), 0.0);
}

/// Collection alone: cloud water and raindrops per m3 of air of 1 kg m-3 at the times given.
template <class Scheme>
Water box(double cloud, double droplets, double time, double dt) {
  Water w;
  w.cloud = cloud;
  w.droplets = droplets;
  Actions did;
  const long steps = std::lround(time / dt);
  for (long i = 0; i < steps; ++i) collect(Scheme{}, w, 1.0, dt, did);
  // One rounding of each of the two per sub-step.
  EXPECT_NEAR(w.cloud + w.rain, cloud, did.substeps * 2.3e-16 * cloud);
  EXPECT_NEAR(did.created, w.droplets - droplets, 1e-9 * droplets);
  return w;
}

TEST(KhairoutdinovKogan, autoconversion_alone_follows_its_exact_solution) {
  // At a fixed number: q = [q_0^{−1.47} + 1.47·1350 N^{−1.79} t]^{−1/1.47}.
  struct Alone {
    CollectionRates rates(const Water& w, double) const {
      CollectionRates r;
      r.autoconversion = KhairoutdinovKogan::autoconversion(w.cloud, 1e-6 * w.droplets);
      return r;
    }
  };
  EXPECT_NEAR(box<Alone>(1e-3, 50e6, 600, 0.5).cloud, 9.7231443026e-4, 1e-12);
  EXPECT_NEAR(box<Alone>(1e-3, 100e6, 3600, 0.5).cloud, 9.5313551277e-4, 1e-12);
}

struct BoxPoint {
  double time, cloud, drops;
};

template <class Scheme>
void expect_box(double droplets, std::initializer_list<BoxPoint> points, double dt, double mass,
                double number) {
  for (const BoxPoint& p : points) {
    const Water w = box<Scheme>(1e-3, droplets, p.time, dt);
    EXPECT_NEAR(w.cloud / p.cloud, 1.0, mass) << droplets << " " << p.time;
    EXPECT_NEAR(w.raindrops / p.drops, 1.0, number) << droplets << " " << p.time;
  }
}

// The boxes were integrated by an independent program (LSODA, relative tolerance 1e-9 to 1e-11) for
// the same equations; the table has five to seven digits.
TEST(KhairoutdinovKogan, boxes_equal_an_independent_integration) {
  const std::initializer_list<BoxPoint> fifty = {{600, 8.304557e-4, 4.239706e5},
                                                 {1200, 8.332190e-5, 6.552317e5},
                                                 {1800, 4.938872e-6, 6.895747e5},
                                                 {2400, 5.685716e-7, 6.956165e5},
                                                 {3600, 1.362909e-8, 6.975820e5}};
  const std::initializer_list<BoxPoint> hundred = {{600, 9.626249e-4, 1.257029e5},
                                                   {1200, 3.639665e-4, 2.297369e5},
                                                   {1800, 1.794477e-5, 2.568998e5},
                                                   {2400, 1.727228e-6, 2.608539e5},
                                                   {3600, 6.604162e-8, 2.621116e5}};
  // Second order: 2.1e-5 at 1 s, 2.1e-3 at 10 s.
  expect_box<KhairoutdinovKogan>(50e6, fifty, 1.0, 1e-4, 1e-4);
  expect_box<KhairoutdinovKogan>(100e6, hundred, 1.0, 1e-4, 1e-4);
  expect_box<KhairoutdinovKogan>(50e6, fifty, 10.0, 3e-3, 1e-3);
}

TEST(SeifertBeheng, boxes_equal_an_independent_integration) {
  const std::initializer_list<BoxPoint> fifty = {{600, 9.628935e-4, 4.2662e4},
                                                 {1200, 3.624289e-4, 8.0539e4},
                                                 {1800, 1.702663e-5, 1.6608e4},
                                                 {2400, 5.303063e-7, 7.5419e3},
                                                 {3600, 4.98e-10, 3.7995e3}};
  const std::initializer_list<BoxPoint> hundred = {{600, 9.983922e-4, 2.3657e3},
                                                   {1200, 9.319547e-4, 2.0746e4},
                                                   {1800, 2.838837e-4, 2.3412e4},
                                                   {2400, 1.198971e-5, 9.4775e3},
                                                   {3600, 1.138662e-8, 4.0902e3}};
  const std::initializer_list<BoxPoint> clean = {
      {1200, 9.999130e-4, 267.65}, {2400, 9.902192e-4, 1234.7}, {3600, 8.643444e-5, 4260.0}};
  expect_box<SeifertBeheng>(5e7, fifty, 1.0, 1e-3, 1.5e-3);
  expect_box<SeifertBeheng>(1e8, hundred, 1.0, 1e-3, 1.5e-3);
  expect_box<SeifertBeheng>(3e8, clean, 1.0, 1e-3, 1.5e-3);
}

TEST(Collection, converges_in_the_second_order) {
  const double exact = box<KhairoutdinovKogan>(1e-3, 50e6, 600, 0.25).cloud;
  const double coarse = box<KhairoutdinovKogan>(1e-3, 50e6, 600, 8).cloud - exact;
  const double fine = box<KhairoutdinovKogan>(1e-3, 50e6, 600, 4).cloud - exact;
  EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.2);
}

TEST(Collection, of_an_hour_in_one_step_is_as_stable) {
  for (const double droplets : {1e6, 50e6, 1e9, 1e12}) {
    const Water w = box<KhairoutdinovKogan>(5e-3, droplets, 3600, 3600);
    EXPECT_GE(w.cloud, 0.0);
    EXPECT_GE(w.droplets, 0.0);
    EXPECT_TRUE(std::isfinite(w.raindrops));
    const Water s = box<SeifertBeheng>(5e-3, droplets, 3600, 3600);
    EXPECT_GE(s.cloud, 0.0);
    EXPECT_GE(s.raindrops, 0.0);
    EXPECT_TRUE(std::isfinite(s.raindrops));
  }
}

}  // namespace
}  // namespace pileus::two_moment
