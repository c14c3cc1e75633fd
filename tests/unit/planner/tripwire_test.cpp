// The watch over what was left out: extrema of all, of blocks, of single parcels.
#include "planner/tripwire.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "moist_operator.hpp"

namespace pileus::planner {
namespace {

/// 5000 parcels with 0.005 of water at 100 m, in air that saturates at 0.04 exp(−z/1000 m): a
/// parcel of 0.005 does so at 1000 ln 8 = 2079.4 m.
struct Watched {
  explicit Watched(const char* effects) : store(3, {water()}) {
    moist.values.set_number(moist.table->find_parameter("surface_humidity"), 0.04);
    tripwires = std::make_unique<Tripwires>(test::plan_of(test::wet_scene(effects), {&moist}));
    store.resize(5000);
    for (std::size_t p = 0; p < store.size(); ++p) {
      store.uid()[p] = 100 + p;
      store.position(2)[p] = 100;
      store.scalar(0)[p] = 0.005;
    }
  }
  static parcels::Scalar water() {
    parcels::Scalar scalar;
    scalar.name = "total_water_mass_fraction";
    scalar.units = "1";
    return scalar;
  }
  test::Loaded moist = test::load<test::MoistAir>();
  std::unique_ptr<Tripwires> tripwires;
  parcels::Store store;
};

TEST(Tripwires, hold_until_a_parcel_saturates_and_name_it) {
  Watched run("effects: {condensation: watch}\n");
  EXPECT_FALSE(run.tripwires->check(run.store));
  run.store.position(2)[1500] = 2079.0;  // just below
  EXPECT_FALSE(run.tripwires->check(run.store));
  run.store.position(2)[1500] = 2080.0;
  const auto trip = run.tripwires->check(run.store);
  ASSERT_TRUE(trip);
  EXPECT_EQ(trip->effect, "condensation");
  EXPECT_EQ(trip->uid, 1600u);
  EXPECT_NEAR(trip->number, 0.005 / (0.04 * std::exp(-2.08)), 1e-12);
  EXPECT_TRUE(trip->was_watched);
  EXPECT_FALSE(trip->stop);
  run.tripwires->disarm("condensation");
  EXPECT_TRUE(run.tripwires->empty());
}

// The wettest parcel is low and the highest is dry: the extrema of all do not rule it out, those of
// the blocks or parcels do.
TEST(Tripwires, look_closer_where_extrema_do_not_rule_out) {
  Watched run("effects: {condensation: watch}\n");
  run.store.position(2)[10] = 3000;
  run.store.scalar(0)[10] = 1e-4;
  run.tripwires->values_changed();
  EXPECT_FALSE(run.tripwires->check(run.store));
  run.store.scalar(0)[10] = 0.004;  // saturation there: 0.0019915
  run.tripwires->values_changed();
  EXPECT_TRUE(run.tripwires->check(run.store));
}

TEST(Tripwires, are_armed_for_bounds_and_not_for_what_the_scene_forces_off) {
  EXPECT_FALSE(Watched("").tripwires->empty());
  EXPECT_TRUE(Watched("effects: {condensation: on}\n").tripwires->empty());
  test::Loaded moist = test::load<test::MoistAir>();  // saturates: off is against the rules
  EXPECT_TRUE(Tripwires(test::plan_of(test::wet_scene("effects: {condensation: off}\n"), {&moist}))
                  .empty());
  Watched stops("effects: {condensation: {mode: watch, on_trip: stop}}\n");
  stops.store.position(2)[0] = 3000;
  const auto trip = stops.tripwires->check(stops.store);
  ASSERT_TRUE(trip);
  EXPECT_TRUE(trip->stop);
}

}  // namespace
}  // namespace pileus::planner
