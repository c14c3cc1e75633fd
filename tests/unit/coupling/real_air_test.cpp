// Real thermodynamics and the teaching plugin through the loaded libraries.
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>

#include "coupling/operator_sequence.hpp"
#include "pileus/thermo.hpp"

namespace pileus::coupling {
namespace {

using Settings = std::vector<std::pair<std::string, scene::RawValue>>;

scene::RawValue one(const char* text) {
  return {text, false, {}, {}, {}};
}
scene::RawValue list(std::vector<std::string> texts) {
  return {"", true, std::move(texts), {}, {}};
}

/// A sequence of one in-tree plugin; problems of the scene fail the test.
OperatorSequence sequence_of(const char* id, const Settings& settings,
                             std::vector<std::string> initial) {
  scene::Scene scene;
  scene::OperatorBlock block;
  block.use = id;
  block.name = "subject";
  block.parameters = settings;
  scene.operators.push_back(block);
  scene::Problems problems;
  SequenceOptions options;
  options.initial = std::move(initial);
  auto entries = load_operators(scene, {{PILEUS_BINARY_DIR "/lib/pileus/plugins"}}, problems);
  EXPECT_TRUE(problems.empty()) << problems.render();
  return OperatorSequence(std::move(entries), std::move(options));
}

const std::vector<std::string> moist = {"liquid_water_potential_temperature",
                                        "total_water_mass_fraction"};

TEST(RealAir, conserves_and_measures_buoyancy_from_the_reference) {
  OperatorSequence sequence =
      sequence_of("org.pileus.saturation_adjustment",
                  {{"thermodynamics", one("real")},
                   {"surface_pressure", one("1015 hPa")},
                   {"reference_height", list({"0 m", "520 m", "1480 m"})},
                   {"reference_potential_temperature", list({"298.7 K", "298.7 K", "302.4 K"})}},
                  moist);
  parcels::Store store(3, sequence.required_scalars());
  constexpr std::size_t n = 3000;
  store.resize(n);
  double* theta = store.scalar(store.find_scalar("liquid_water_potential_temperature"));
  double* q = store.scalar(store.find_scalar("total_water_mass_fraction"));
  for (std::size_t p = 0; p < n; ++p) {
    store.uid()[p] = p + 1;
    store.volume()[p] = 1;
    store.position(2)[p] = 1500.0 * static_cast<double>(p) / n;
    theta[p] = 298.7;
    q[p] = p % 3 == 0 ? 0.0 : 0.017;
  }
  sequence.bind(store, {});
  sequence.init({});
  const double* wet = store.scalar(store.find_scalar("mass_fraction_of_cloud_liquid_water_in_air"));
  const double* kelvin = store.scalar(store.find_scalar("air_temperature"));
  const double* b = store.scalar(store.find_scalar("buoyancy"));
  const thermo::Constants constants;
  double most = 0;
  for (std::size_t p = 0; p < n; ++p) {
    most = std::max(most, wet[p]);
    if (wet[p] > 0) {
      // T = Πθ_l + (L/c_p) q_l recovers the Exner function, and with it exact saturation.
      const double exner =
          (kelvin[p] - constants.latent_heat / constants.heat_capacity * wet[p]) / theta[p];
      const double pressure = thermo::pressure_of_exner(exner, constants.kappa());
      const double saturated =
          thermo::saturation_specific_humidity(thermo::saturation_pressure(kelvin[p]), pressure,
                                               constants.epsilon)
              .value;
      EXPECT_NEAR(q[p] - wet[p], saturated, 1e-12 * saturated);
    } else if (q[p] == 0 && store.position(2)[p] <= 520) {
      EXPECT_NEAR(b[p], 0.0, 1e-13 * constants.gravity);  // dry air of the reference state
    }
  }
  EXPECT_GT(most, 1e-3);  // cloud base lies near 500 m, so there is liquid at 1500 m
}

TEST(RealAir, refuses_profiles_of_different_lengths_with_the_plugins_own_words) {
  OperatorSequence sequence = sequence_of(
      "org.pileus.saturation_adjustment",
      {{"thermodynamics", one("real")}, {"reference_height", list({"0 m", "520 m"})}}, moist);
  parcels::Store store(3, sequence.required_scalars());
  store.resize(1);
  try {
    sequence.bind(store, {});
    FAIL() << "profiles of different lengths were accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::plugin);
    EXPECT_NE(std::string(error.what()).find("differ in their number of values"),
              std::string::npos);
  }
}

TEST(RealAir, names_a_parcel_above_the_reference_atmosphere) {
  OperatorSequence sequence =
      sequence_of("org.pileus.saturation_adjustment", {{"thermodynamics", one("real")}}, moist);
  parcels::Store store(3, sequence.required_scalars());
  store.resize(2000);
  for (int c = 0; c < store.column_count(); ++c) std::fill_n(store.column(c), 2000, 0.0);
  std::fill_n(store.scalar(store.find_scalar("liquid_water_potential_temperature")), 2000, 300.0);
  for (std::size_t p = 0; p < 2000; ++p) store.uid()[p] = 5000 + p;
  store.position(2)[1700] = 40e3;
  sequence.bind(store, {});
  try {
    sequence.init({});
    FAIL() << "a parcel above the atmosphere was accepted";
  } catch (const OperatorFailure& failure) {
    EXPECT_EQ(failure.bundle().uid, 6700u);
    EXPECT_EQ(failure.bundle().block, 1);
    EXPECT_EQ(failure.bundle().quantity, "liquid_water_potential_temperature");
  }
}

TEST(IdealAir, has_the_latent_buoyancy_of_epic) {
  OperatorSequence sequence = sequence_of("org.pileus.saturation_adjustment",
                                          {{"gravity", one("9.80616 m/s2")},
                                           {"latent_heat", one("2.501e6 J/kg")},
                                           {"heat_capacity", one("1005.7 J/kg/K")},
                                           {"buoyancy_temperature", one("288.15 K")}},
                                          {"liquid_water_buoyancy", "total_water_mass_fraction"});
  parcels::Store store(2, sequence.required_scalars());
  store.resize(1);
  for (int c = 0; c < store.column_count(); ++c) store.column(c)[0] = 0;
  store.uid()[0] = 1;
  store.scalar(store.find_scalar("total_water_mass_fraction"))[0] = 0.025;
  sequence.bind(store, {});
  sequence.init({});
  // q_l = 0.025 − 0.015 at the ground; G = gL/(c_p θ_00) = 84.6302 m s-2 to six digits.
  EXPECT_NEAR(store.scalar(store.find_scalar("buoyancy"))[0] / 0.01, 84.63024394, 1e-8);
}

TEST(Relaxation, follows_the_exact_solution_for_any_step) {
  OperatorSequence sequence =
      sequence_of("org.pileus.example_relaxation",
                  {{"time_scale", one("30 min")}, {"target", one("0.5")}}, {"passive_tracer"});
  parcels::Store store(3, sequence.required_scalars());
  store.resize(1);
  for (int c = 0; c < store.column_count(); ++c) store.column(c)[0] = 0;
  store.uid()[0] = 1;
  double* q = store.scalar(store.find_scalar("passive_tracer"));
  q[0] = 2.0;
  sequence.bind(store, {});
  sequence.init({});
  EXPECT_EQ(q[0], 2.0);  // set by the initial state, so init leaves it
  sequence.apply_after_transport({0, 0.0, 900.0});
  EXPECT_NEAR(q[0], 0.5 + 1.5 * std::exp(-0.5), 3e-16 * 2);
  sequence.apply_after_transport({1, 900.0, 1e9});
  EXPECT_EQ(q[0], 0.5);
}

}  // namespace
}  // namespace pileus::coupling
