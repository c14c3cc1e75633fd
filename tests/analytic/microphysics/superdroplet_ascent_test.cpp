// Supersaturation and activation in rising parcels against the exact bin solution.
//
// "Reference" is a solution of 100 to 120 exact bins per mode (LSODA, 1e-9). "Repeated" is
// the same computed once more by a program of ours with S = e/e_s, 240 bins: S_max to 5e-5 of it,
// q_l to 1e-5. The two differ by 0.13 % in q_l: the reference lowers the pressure with the density
// of moist air but the temperature by g/c_p, which does not conserve θ in dry ascent.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "superdroplet_parcel.hpp"

namespace pileus::superdroplets {
namespace {

struct Risen {
  double peak = -1;      // S_max − 1
  double peak_time = 0;  // s
  double critical = 0;   // m-3, number with S_c < S_max
  double beyond = 0;     // m-3, number with r > r_c at the end
  double liquid = 0, kelvin = 0;
  long substeps = 0;
  int fallbacks = 0;
};

Risen rise(double temperature, double humidity, std::vector<AerosolMode> modes,
           const DropletAir& air, double speed, double distance, double dt) {
  constexpr double pressure = 9e4;
  constexpr std::size_t count = 256;
  Parcel parcel(pressure, temperature, humidity);
  const double density = pressure / (epic.gas_constant_dry_air * temperature);
  for (AerosolMode& mode : modes) mode.number /= density;  // per kg
  const AerosolSampler sampler(modes, count, {Sampling::log_uniform});
  std::vector<Superdroplet> sample(count);
  sample.resize(sampler.sample(
      1.0, {humidity, parcel.kelvin(), 1.0}, [](std::size_t) { return 0.5; }, sample));
  for (const Superdroplet& s : sample) parcel.add(s);
  const Condensation scheme(air, {});
  Risen found;
  double kelvin = 0;
  const long steps = std::lround(distance / speed / dt);
  for (long i = 0; i < steps; ++i) {
    const Outcome did = parcel.advance(scheme, parcel.above(speed * dt), dt);
    found.substeps += did.substeps;
    found.fallbacks += did.fallbacks;
    if (did.largest_supersaturation > found.peak) {
      found.peak = did.largest_supersaturation;
      found.peak_time = (static_cast<double>(i) + 0.5) * dt;
      kelvin = parcel.kelvin();
    }
  }
  for (std::size_t i = 0; i < parcel.water.size(); ++i) {
    const double number = static_cast<double>(parcel.multiplicity[i]) * density;
    const Particle p = parcel.particle(i);
    if (critical_point(p, kelvin).saturation - 1 < found.peak) found.critical += number;
    if (parcel.radius(i) > critical_point(p, parcel.kelvin()).radius) found.beyond += number;
  }
  found.liquid = parcel.liquid();
  found.kelvin = parcel.temperature();
  return found;
}

struct Row {
  double speed, distance, percent, time, critical, beyond, kelvin, liquid;  // reference
  double repeated_percent, repeated_liquid;
};
constexpr Row rows[] = {
    {0.1, 150, 0.08087, 435.8, 249.8, 182.3, 282.20727, 2.091557e-4, 0.08082, 2.088385e-4},
    {0.5, 300, 0.19242, 91.1, 559.6, 527.1, 281.43570, 4.870255e-4, 0.19230, 4.864202e-4},
    {1.0, 300, 0.28040, 47.6, 700.2, 695.9, 281.43397, 4.863310e-4, 0.28023, 4.856997e-4},
    {3.0, 300, 0.51934, 18.0, 869.7, 863.0, 281.42749, 4.837229e-4, 0.51899, 4.831121e-4}};

Risen rise(const Row& row, double dt) {
  return rise(283.15, 0.98, {{1e9, 50e-9, 2.0, 0.61}}, epic_air(), row.speed, row.distance, dt);
}

TEST(SuperdropletAscent, of_a_broad_mode_equals_the_reference_with_steps_of_a_second) {
  for (const Row& row : rows) {
    const Risen found = rise(row, 1.0);
    EXPECT_NEAR(100 * found.peak / row.percent, 1, 0.02) << row.speed;
    EXPECT_NEAR(found.peak_time, row.time, 1.0) << row.speed;
    // The number with S_c < S_max, by steps of one superdroplet in both.
    EXPECT_NEAR(1e-6 * found.critical / row.critical, 1, 0.03) << row.speed;
    EXPECT_NEAR(found.liquid / row.liquid, 1, 0.002) << row.speed;
    EXPECT_NEAR(found.kelvin, row.kelvin, 2e-3) << row.speed;
    EXPECT_EQ(found.fallbacks, 0);
  }
}

TEST(SuperdropletAscent, equals_the_repeated_solution_with_steps_of_a_second_and_of_ten) {
  for (const Row& row : rows) {
    const Risen fine = rise(row, 1.0);
    EXPECT_NEAR(100 * fine.peak / row.repeated_percent, 1, 5e-4) << row.speed;
    EXPECT_NEAR(fine.liquid / row.repeated_liquid, 1, 1e-4) << row.speed;
    const Risen coarse = rise(row, 10.0);
    EXPECT_NEAR(100 * coarse.peak / row.repeated_percent, 1, 3e-3) << row.speed;
    // The parcel's pressure is that of the midpoint's temperature, dry within the step.
    EXPECT_NEAR(coarse.liquid / row.repeated_liquid, 1, 3e-4) << row.speed;
  }
}

TEST(SuperdropletAscent, deactivates_what_the_reference_deactivates) {
  // Slow ascent: 27 % of what S_max activated falls back. One superdroplet is 1.9 % of the number.
  const Risen found = rise(rows[0], 1.0);
  EXPECT_NEAR(1e-6 * found.beyond / rows[0].beyond, 1, 0.04);
  EXPECT_LT(found.beyond, 0.8 * found.critical);
}

TEST(SuperdropletAscent, of_two_modes_with_slow_accommodation_equals_the_reference) {
  // α = 0.3 for mass, 1 for heat; 283 K, 97 %, κ 1.28; modes of Grabowski & Pawlowska
  // (2023). S_max (%) and the number with S_c < S_max (cm-3).
  const std::vector<AerosolMode> pristine = {{125e6, 11e-9, 1.2, 1.28}, {65e6, 60e-9, 1.7, 1.28}};
  const std::vector<AerosolMode> polluted = {{160e6, 29e-9, 1.36, 1.28},
                                             {380e6, 71e-9, 1.57, 1.28}};
  const double speed[] = {0.25, 1, 4};
  const double percent[2][3] = {{0.30920, 0.72946, 1.45983}, {0.14656, 0.32691, 0.77257}};
  const double number[2][3] = {{61.58, 74.14, 172.48}, {353.4, 489.2, 538.7}};
  DropletAir air = epic_air();
  air.accommodation.mass = 0.3;
  for (int k = 0; k < 2; ++k) {
    for (int i = 0; i < 3; ++i) {
      const Risen found = rise(283.0, 0.97, k == 0 ? pristine : polluted, air, speed[i], 300, 1.0);
      EXPECT_NEAR(100 * found.peak / percent[k][i], 1, 0.02) << k << " " << speed[i];
      EXPECT_NEAR(1e-6 * found.critical / number[k][i], 1, 0.03) << k << " " << speed[i];
    }
  }
}

}  // namespace
}  // namespace pileus::superdroplets
