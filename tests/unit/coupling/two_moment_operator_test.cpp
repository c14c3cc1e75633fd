// Two-moment clouds through the loaded library: what is skipped, what is kept, what is booked.
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <cstring>
#include <map>

#include "coupling/operator_sequence.hpp"
#include "pileus/thermo.hpp"

namespace pileus::coupling {
namespace {

using Settings = std::vector<std::pair<std::string, scene::RawValue>>;
using Verdicts = std::map<std::string, EffectState>;  // of effects that are not on

scene::RawValue one(const char* text) {
  return {text, false, {}, {}, {}};
}

constexpr const char* theta_name = "air_potential_temperature";
constexpr const char* vapour_name = "specific_humidity";
constexpr const char* cloud_name = "mass_fraction_of_cloud_liquid_water_in_air";
constexpr const char* droplets_name = "number_of_cloud_droplets_per_mass_of_air";

/// A layer of parcels of one temperature, the lower half too dry for cloud.
struct Layer {
  OperatorSequence sequence;
  parcels::Store store;
  std::uint64_t steps = 0;

  explicit Layer(const Settings& settings, std::size_t count = 3000, bool skip = true,
                 int substeps = 0, const Verdicts& verdicts = {})
      : sequence(make(settings, skip, substeps, verdicts)), store(3, sequence.required_scalars()) {
    store.resize(count);
    for (std::size_t p = 0; p < count; ++p) {
      store.uid()[p] = p + 1;
      store.volume()[p] = 1000;
      store.position(2)[p] = 800 + 400.0 * static_cast<double>(p) / static_cast<double>(count);
      values(theta_name)[p] = 290;
      values(vapour_name)[p] = p < count / 2 ? 2e-3 : 8.1e-3;
    }
    sequence.bind(store, {});
    sequence.init({});
  }
  double* values(const char* name) { return store.scalar(store.find_scalar(name)); }

  /// Lifts everything and applies.
  void rise(double distance, double dt) {
    sequence.apply_before_transport({steps, 0, dt});
    for (std::size_t p = 0; p < store.size(); ++p) store.position(2)[p] += distance;
    sequence.diagnose({steps, 0, dt});
    sequence.apply_after_transport({steps, 0, dt});
    sequence.population_changed();
    ++steps;
  }

 private:
  static OperatorSequence make(const Settings& settings, bool skip, int substeps,
                               const Verdicts& verdicts) {
    scene::Scene scene;
    scene::OperatorBlock block;
    block.use = "org.pileus.two_moment";
    block.name = "clouds";
    block.parameters = settings;
    scene.operators.push_back(block);
    scene::Problems problems;
    SequenceOptions options;
    options.initial = {theta_name, vapour_name};
    options.coupling.skip_inactive = skip;
    auto entries = load_operators(scene, {{PILEUS_BINARY_DIR "/lib/pileus/plugins"}}, problems);
    EXPECT_TRUE(problems.empty()) << problems.render();
    entries.front().substeps = substeps;
    for (const pileus_effect& effect : entries.front().table->effects) {
      const auto found = verdicts.find(effect.name);
      entries.front().effects.push_back(found != verdicts.end() ? found->second : EffectState::on);
    }
    return OperatorSequence(std::move(entries), std::move(options));
  }
};

std::vector<double> bits_of(Layer& layer) {
  std::vector<double> all;
  for (std::size_t s = 0; s < layer.store.scalars().size(); ++s) {
    const double* x = layer.store.scalar(static_cast<int>(s));
    all.insert(all.end(), x, x + layer.store.size());
  }
  return all;
}

TEST(TwoMomentOperator, skips_clear_air_below_saturation_and_changes_nothing_by_it) {
  Layer skipping({}), calling({}, 3000, false);
  for (int i = 0; i < 20; ++i) {
    skipping.rise(10, 2);
    calling.rise(10, 2);
  }
  const auto a = bits_of(skipping), b = bits_of(calling);
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(double)), 0);
  // Half of the parcels never saturate; the others do after part of the ascent.
  const OperatorLedger ledger = skipping.sequence.ledger().operators.front();
  EXPECT_GE(ledger.skipped(), 20u * 1500u);
  EXPECT_LT(ledger.skipped(), 20u * 3000u);
  EXPECT_GT(*std::max_element(skipping.values(cloud_name), skipping.values(cloud_name) + 3000),
            0.0);
  EXPECT_EQ(*std::max_element(skipping.values(cloud_name), skipping.values(cloud_name) + 1500),
            0.0);
}

TEST(TwoMomentOperator, has_the_same_bits_for_any_number_of_threads) {
  std::vector<double> reference;
  for (const int threads : {1, 2, 3}) {
    omp_set_num_threads(threads);
    Layer layer({{"collection", one("seifert_beheng")}});
    for (int i = 0; i < 20; ++i) layer.rise(15, 3);
    if (threads == 1) reference = bits_of(layer);
    const auto found = bits_of(layer);
    EXPECT_EQ(std::memcmp(found.data(), reference.data(), found.size() * sizeof(double)), 0);
  }
  omp_set_num_threads(2);
}

double total_of(const Ledger& ledger, const std::string& name) {
  for (const BudgetTotal& t : ledger.totals)
    if (t.budget == name) return t.total;
  return -1.0;
}

TEST(TwoMomentOperator, closes_the_books_of_water_and_of_droplets) {
  Layer layer({{"collection", one("khairoutdinov_kogan")}});
  const auto water = [&] { return total_of(layer.sequence.ledger(), "water"); };
  const auto droplets = [&] { return total_of(layer.sequence.ledger(), "droplets_and_aerosol"); };
  const auto budget = [&](const std::string& name) {
    const Ledger ledger = layer.sequence.ledger();
    for (const OperatorBudget& b : ledger.operators.front().budgets)
      if (b.budget == name) return b;
    return OperatorBudget{};
  };
  const double before = water();
  for (int i = 0; i < 40; ++i) layer.rise(15, 3);
  const double most = droplets();
  EXPECT_GT(most, 0.0);
  EXPECT_NEAR(budget("droplets_and_aerosol").change / most, 1.0, 1e-9);
  EXPECT_NEAR(budget("droplets_and_aerosol").source / most, 1.0, 1e-9);
  // 60 steps of a few roundings each for 3000 parcels, of random sign.
  EXPECT_NEAR(water() / before, 1.0, 1e-15);
  EXPECT_LE(std::abs(budget("water").change), 1e-15 * before);
  EXPECT_EQ(budget("water").source, 0.0);
  // Descent evaporates all clouds: the droplets are gone, the limiter that emptied them counted.
  for (int i = 0; i < 20; ++i) layer.rise(-65, 3);
  EXPECT_EQ(droplets(), 0.0);
  EXPECT_NEAR(budget("droplets_and_aerosol").source / most, 0.0, 1e-9);
  EXPECT_NEAR(water() / before, 1.0, 1e-15);
  EXPECT_GT(layer.sequence.ledger().operators.front().repairs, 0u);
}

TEST(TwoMomentOperator, accounts_for_an_ascent_once) {
  // Two sub-steps of the operator: all of the ascent belongs to the first, none to the second.
  Layer once({{"activation", one("twomey")}, {"twomey_exponent", one("0")}});
  Layer twice({{"activation", one("twomey")}, {"twomey_exponent", one("0")}}, 3000, true, 2);
  for (int i = 0; i < 30; ++i) {
    once.rise(10, 2);
    twice.rise(10, 2);
  }
  for (std::size_t p = 0; p < 3000; ++p) {
    EXPECT_EQ(once.values("previous_height")[p], once.store.position(2)[p]);
    // The steady excess A τ differs with A over a half step; q_c hardly.
    EXPECT_NEAR(once.values(cloud_name)[p], twice.values(cloud_name)[p], 1e-5);
  }
}

TEST(TwoMomentOperator, gives_every_cloud_the_number_of_a_constant_spectrum) {
  Layer layer({{"activation", one("twomey")},
               {"twomey_exponent", one("0")},
               {"twomey_coefficient", one("100 cm-3")},
               {"aerosol_air_density", one("1 kg/m3")}});
  for (int i = 0; i < 40; ++i) layer.rise(10, 5);
  int clouds = 0;
  for (std::size_t p = 0; p < 3000; ++p) {
    if (layer.values(cloud_name)[p] < 1e-5) continue;
    ++clouds;
    EXPECT_NEAR(layer.values(droplets_name)[p], 1e8, 1e-3);
  }
  EXPECT_GT(clouds, 500);
}

const Verdicts nothing_condenses = {{"condensation", EffectState::off},
                                    {"activation", EffectState::off},
                                    {"collection", EffectState::off},
                                    {"rain_evaporation", EffectState::off}};

// In a layer that stays below saturation: half of it never gets there, and 8 m are no ascent.
TEST(TwoMomentOperator, without_condensation_has_no_arrays_and_no_calls_and_the_same_air) {
  const Settings with_rain = {{"collection", one("seifert_beheng")}};
  for (const bool skip : {true, false}) {
    Layer off(with_rain, 3000, skip, 0, nothing_condenses), on(with_rain);
    for (Layer* layer : {&off, &on}) {
      for (std::size_t p = 0; p < 3000; ++p) layer->values(vapour_name)[p] = 2e-3;
      layer->sequence.population_changed();
      for (int i = 0; i < 5; ++i) layer->rise(8, 2);
      layer->sequence.diagnose({5, 0, 2});
    }
    for (const char* name :
         {cloud_name, droplets_name, "mass_fraction_of_rain_in_air",
          "number_of_raindrops_per_mass_of_air", "previous_height", "relative_humidity"}) {
      EXPECT_EQ(off.store.find_scalar(name), -1) << name;
      EXPECT_GE(on.store.find_scalar(name), 0) << name;
    }
    for (const char* name : {theta_name, vapour_name, "air_temperature", "buoyancy"}) {
      EXPECT_EQ(std::memcmp(off.values(name), on.values(name), 3000 * sizeof(double)), 0) << name;
    }
    const OperatorLedger ledger = off.sequence.ledger().operators.front();
    EXPECT_EQ(ledger.applied, 0u);
    EXPECT_EQ(ledger.skipped(), 0u) << "nobody was asked";
    EXPECT_GT(on.sequence.ledger().operators.front().skipped(), 0u);
  }
}

TEST(TwoMomentOperator, without_collection_is_the_scheme_without_rain) {
  const Verdicts no_collection = {{"collection", EffectState::off},
                                  {"rain_evaporation", EffectState::off}};
  Layer off({{"collection", one("seifert_beheng")}}, 3000, true, 0, no_collection), never({});
  EXPECT_EQ(off.store.find_scalar("mass_fraction_of_rain_in_air"), -1);
  EXPECT_EQ(off.store.find_scalar("number_of_raindrops_per_mass_of_air"), -1);
  for (int i = 0; i < 20; ++i) {
    off.rise(15, 3);
    never.rise(15, 3);
  }
  const auto a = bits_of(off), b = bits_of(never);
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(double)), 0);
  EXPECT_GT(*std::max_element(off.values(cloud_name), off.values(cloud_name) + 3000), 1e-5);
}

// Saturation is reached on the way: until then the watched operator is given no water and is not
// called; what it does from then on is what the other does.
TEST(TwoMomentOperator, switched_on_before_saturation_equals_the_one_that_was_on) {
  const Verdicts watch = {{"condensation", EffectState::watched}};
  Layer watched({{"collection", one("seifert_beheng")}}, 3000, true, 0, watch);
  Layer on({{"collection", one("seifert_beheng")}});
  for (Layer* layer : {&watched, &on})
    for (std::size_t p = 0; p < 3000; ++p) layer->values(vapour_name)[p] = 6e-3;
  watched.sequence.population_changed();
  on.sequence.population_changed();
  const auto wettest = [&] {
    return *std::max_element(on.values("relative_humidity"), on.values("relative_humidity") + 3000);
  };
  int switched_at = 0;
  for (int i = 0; i < 30; ++i) {
    on.sequence.diagnose({on.steps, 0, 3});
    if (switched_at == 0 && wettest() > 0.97) {
      EXPECT_EQ(watched.sequence.ledger().operators.front().applied, 0u);
      EXPECT_TRUE(watched.sequence.activate("condensation"));
      switched_at = i;
    }
    watched.rise(10, 3);
    on.rise(10, 3);
  }
  EXPECT_GT(switched_at, 2);
  const auto a = bits_of(watched), b = bits_of(on);
  ASSERT_EQ(a.size(), b.size());
  EXPECT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(double)), 0);
  EXPECT_GT(*std::max_element(on.values(cloud_name), on.values(cloud_name) + 3000), 1e-5);
}

TEST(TwoMomentOperator, refuses_modes_that_do_not_match) {
  EXPECT_THROW(Layer({{"aerosol_number", {"", true, {"100 cm-3", "50 cm-3"}, {}, {}}}}),
               std::exception);
}

TEST(TwoMomentOperator, keeps_the_largest_supersaturation_of_a_step_whatever_its_length) {
  // The number activated is C (100 s)^k of the largest supersaturation met, Twomey 1959.
  const auto peak_after = [](double dt) {
    Layer layer({{"largest_supersaturation", one("kept")}, {"activation", one("twomey")}}, 40);
    for (double t = 0; t < 100; t += dt) layer.rise(dt, dt);
    const double peak = layer.values("largest_supersaturation")[30];
    EXPECT_NEAR(layer.values(droplets_name)[30], 1e8 / 1.2 * std::sqrt(100 * peak), 1e-9 * 1e8);
    EXPECT_EQ(layer.values("largest_supersaturation")[0], 0.0);  // of air that stays dry
    return peak;
  };
  const double fine = peak_after(0.1);
  EXPECT_GT(fine, 1e-3);
  // Sub-steps of half the relaxation time resolve the peak to some 1 % (tests/analytic).
  EXPECT_NEAR(peak_after(10) / fine, 1.0, 0.012);
}

TEST(TwoMomentOperator, heats_cloud_while_it_rises_and_not_a_step_later) {
  for (const char* measure : {"specific_humidity", "mixing_ratio"}) {
    Layer layer({{"activation", one("twomey")},
                 {"twomey_coefficient", one("1e13")},  // so many that the excess stays near zero
                 {"twomey_limit", one("1e13")},
                 {"twomey_exponent", one("0")},
                 {"saturation_humidity", one(measure)}},
                40);
    for (int i = 0; i < 50; ++i) layer.rise(10, 10);
    ASSERT_GT(layer.values(cloud_name)[30], 1e-4);
    for (const double distance : {100.0, -100.0}) {
      const double theta = layer.values(theta_name)[30];
      layer.sequence.apply_before_transport({layer.steps, 0, 10});
      for (std::size_t p = 0; p < 40; ++p) layer.store.position(2)[p] += distance;
      layer.sequence.diagnose({layer.steps, 0, 10});
      const double on_the_way = layer.values("buoyancy")[30];
      EXPECT_EQ(layer.values(theta_name)[30], theta);
      layer.sequence.apply_after_transport({layer.steps, 0, 10});
      layer.sequence.population_changed();
      ++layer.steps;
      layer.sequence.diagnose({layer.steps, 0, 10});
      const double after = layer.values("buoyancy")[30];
      // Of the heat only the curvature of q_s is left: (100 m/1.5 km)^2/6 and that of Γ, 100 m/3
      // km.
      const double heat = 9.81 / 300 * std::abs(layer.values(theta_name)[30] - theta);
      EXPECT_GT(heat, 5e-3);
      EXPECT_NEAR(on_the_way, after, 0.04 * heat) << measure << distance;
    }
  }
}

}  // namespace
}  // namespace pileus::coupling
