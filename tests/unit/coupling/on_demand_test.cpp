// Quantities derived on demand: left out within a step, there for everybody who looks after it.
#include <gtest/gtest.h>

#include "toy_operators.hpp"

namespace pileus::test {
namespace {

void lift(ToyRun& run, double by) {
  for (std::size_t p = 0; p < run.store.size(); ++p) run.store.position(2)[p] += by;
}

TEST(OnDemand, is_left_out_within_a_step) {
  ToyRun run(entries_of<Thermometer>({"thermometer"}), 10);
  Thermometer::buoyancies = Thermometer::temperatures = 0;
  for (int stage = 0; stage < 3; ++stage) {
    lift(run, 1);
    run.sequence.diagnose_stage({});
  }
  EXPECT_EQ(Thermometer::buoyancies, 3);
  EXPECT_EQ(Thermometer::temperatures, 0);
  EXPECT_EQ(run.values("buoyancy")[0], 103);
  EXPECT_EQ(run.values("air_temperature")[0], 100) << "as it was";
}

TEST(OnDemand, is_caught_up_with_although_nothing_has_changed_since_the_last_stage) {
  ToyRun run(entries_of<Thermometer, RandomGrowth>({"thermometer", "growth"}), 10);
  lift(run, 1);
  run.sequence.diagnose_stage({});
  run.sequence.diagnose({});
  EXPECT_EQ(run.values("air_temperature")[0], 101);
  lift(run, 1);
  run.sequence.diagnose_stage({});
  run.step(0, 1.0);
  EXPECT_EQ(run.values("air_temperature")[0], 102) << "operators see the state they are called in";
}

TEST(OnDemand, is_always_there_for_other_closures) {
  ToyRun run(entries_of<Thermometer, Hygrometer>({"thermometer", "hygrometer"}), 10);
  lift(run, 1);
  run.sequence.diagnose_stage({});
  EXPECT_EQ(run.values("air_temperature")[0], 101);
  EXPECT_EQ(run.values("relative_humidity")[0], 101);
}

/// The buoyancy drives the flow: it is needed whatever a plugin says.
class LazyBuoyancy : public Operator<LazyBuoyancy> {
 public:
  void describe(Declaration& d) {
    introduce(d, "test.lazy_buoyancy");
    d.op.form = PILEUS_CLOSURE;
    d.provides("buoyancy");
    height = d.reads("height", "m");
    buoyancy = d.derives("buoyancy", "m s-2").on_demand();
  }
  void diagnose(const pileus_step&, Block block) const {
    if (block.has(buoyancy)) std::copy_n(block.in(height), block.count(), block.out(buoyancy));
  }

 private:
  Slot height, buoyancy;
};

TEST(OnDemand, is_nothing_for_the_buoyancy) {
  ToyRun run(entries_of<LazyBuoyancy>({"lazy"}), 10);
  lift(run, 1);
  run.sequence.diagnose_stage({});
  EXPECT_EQ(run.values("buoyancy")[0], 101);
}

/// Declares what makes no sense: an owned quantity on demand.
class Demanding : public Operator<Demanding> {
 public:
  void describe(Declaration& d) {
    introduce(d, "test.demanding");
    d.owns("passive_tracer", "1").intensive().on_demand();
  }
  void apply(const pileus_step&, Block) const {}
};

TEST(OnDemand, is_refused_for_what_is_not_derived) {
  std::vector<std::string> complaints;
  host::read_operator(Demanding::table(), complaints);
  ASSERT_EQ(complaints.size(), 1u);
  EXPECT_NE(complaints.front().find("on demand, but not derived"), std::string::npos)
      << complaints.front();
}

}  // namespace
}  // namespace pileus::test
