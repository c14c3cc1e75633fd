// The closure of the moist scenes through the whole chain: library, parameters, store, blocks.
#include <gtest/gtest.h>

#include <cmath>

#include "coupling/operator_sequence.hpp"

namespace pileus::coupling {
namespace {

scene::Scene moist_scene() {
  scene::Scene scene;
  scene::OperatorBlock block;
  block.use = "org.pileus.saturation_adjustment";
  block.name = "condensation";
  const auto set = [&](const char* key, const char* text) {
    block.parameters.push_back({key, {text, false, {}, {}, {}}});
  };
  set("thermodynamics", "ideal");
  set("gravity", "10 m/s2");
  set("latent_heat", "2.5e6 J/kg");
  set("heat_capacity", "1000 J/kg/K");
  set("buoyancy_temperature", "300 K");
  scene.operators.push_back(block);
  return scene;
}

host::SearchPath built_plugins() {
  return {{PILEUS_BINARY_DIR "/lib/pileus/plugins"}};
}

SequenceOptions moist_options() {
  SequenceOptions options;
  options.initial = {"liquid_water_buoyancy", "total_water_mass_fraction"};
  return options;
}

TEST(SaturationClosure, gives_the_published_liquid_water_and_buoyancy) {
  scene::Problems problems;
  OperatorSequence sequence(load_operators(moist_scene(), built_plugins(), problems),
                            moist_options());
  ASSERT_TRUE(problems.empty()) << problems.render();
  EXPECT_TRUE(sequence.derives_buoyancy());
  parcels::Store store(3, sequence.required_scalars());
  // Heights and humidities of microphysics reference 1.6 with G = 83.3333 of the moist thermal.
  const double height[] = {500, 1000, 1500, 2000}, q[] = {0.012, 0.010, 0.006, 0.002};
  const double liquid[] = {2.90204010e-3, 4.48180838e-3, 2.65304760e-3, 0};
  store.resize(4);
  for (std::size_t p = 0; p < 4; ++p) {
    store.position(2)[p] = height[p];
    store.uid()[p] = p + 1;
    store.scalar(store.find_scalar("liquid_water_buoyancy"))[p] = 0.25;
    store.scalar(store.find_scalar("total_water_mass_fraction"))[p] = q[p];
  }
  sequence.bind(store, {});
  sequence.init({});
  for (std::size_t p = 0; p < 4; ++p) {
    const int wet = store.find_scalar("mass_fraction_of_cloud_liquid_water_in_air");
    // Half a unit of the reference's last printed digit.
    EXPECT_NEAR(store.scalar(wet)[p], liquid[p], 5e-12);
    EXPECT_NEAR(store.scalar(store.find_scalar("buoyancy"))[p],
                0.25 + 250.0 / 3.0 * store.scalar(wet)[p], 1e-15);
  }
}

}  // namespace
}  // namespace pileus::coupling
