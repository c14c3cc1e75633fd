// The budget of a variance: closed, booked where it goes, and kept across a restart.
#include "model/variance_budget.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"

namespace pileus::model {
namespace {

using Sink = VarianceBudget::Sink;

/// Four parcels of volumes 1, 1, 2, 4 with values 1, 3, 2, 10 and a derived quantity.
parcels::Store four_parcels() {
  parcels::Store store(3, {{"tracer", "kg-1", parcels::Nature::intensive, "", 0, 0, 0},
                           {"amount", "kg", parcels::Nature::extensive, "", 0, 0, 0}});
  store.resize(4);
  constexpr double volume[] = {1, 1, 2, 4}, value[] = {1, 3, 2, 10};
  for (std::size_t p = 0; p < 4; ++p) {
    store.volume()[p] = volume[p];
    store.scalar(0)[p] = value[p];
  }
  return store;
}

/// (1 + 9 + 8 + 400)/8 − 6² = 16.25.
TEST(VarianceBudget, IsClosedAndNamesWhatTookTheVariance) {
  parcels::Store store = four_parcels();
  VarianceBudget budget({{"tracer", {}}}, store, 8);
  EXPECT_NEAR(budget.measure(store)[0], 16.25, 1e-14);
  budget.book(store, Sink::operators);
  EXPECT_EQ(budget.measure(store)[1], 0) << "the first look books nothing";
  // An operator exchanges between the last two: 2 and 10 become 4 and 9. (1+9+32+324)/8 − 36 = 9.75
  store.scalar(0)[2] = 4, store.scalar(0)[3] = 9;
  budget.book(store, Sink::operators);
  // The first two merge to 2: (8 + 32 + 324)/8 − 36 = 9.5.
  store.volume()[0] = 2, store.scalar(0)[0] = 2, store.volume()[1] = 0;
  budget.book(store, Sink::mergers);
  const std::vector<double> now = budget.measure(store);
  EXPECT_NEAR(now[0], 9.5, 1e-14);
  EXPECT_NEAR(now[1], 6.5, 1e-14);
  EXPECT_NEAR(now[2], 0.25, 1e-14);
  EXPECT_EQ(budget.outputs()[0][0], "tracer_variance");
  EXPECT_EQ(budget.outputs()[1][1], "(kg-1)2");
}

TEST(VarianceBudget, GoesOnAfterARestart) {
  parcels::Store store = four_parcels();
  VarianceBudget budget({{"tracer", {}}}, store, 8);
  budget.book(store, Sink::operators);
  store.scalar(0)[3] = 8;
  budget.book(store, Sink::mergers);
  output::NamedData data;
  budget.save(data);
  VarianceBudget continued({{"tracer", {}}}, store, 8);
  continued.restore(data);
  store.scalar(0)[0] = 2;
  budget.book(store, Sink::operators);
  continued.book(store, Sink::operators);
  EXPECT_EQ(budget.measure(store), continued.measure(store));
}

/// One that is added begins then; the other goes on.
TEST(VarianceBudget, GoesOnByNameWhenAnotherIsAdded) {
  parcels::Store store(2, {{"tracer", "1", parcels::Nature::intensive, "", 0, 0, 0},
                           {"other", "1", parcels::Nature::intensive, "", 0, 0, 0}});
  store.resize(4);
  for (std::size_t p = 0; p < 4; ++p) {
    store.volume()[p] = 2;
    store.scalar(0)[p] = store.scalar(1)[p] = static_cast<double>(p);
  }
  VarianceBudget budget({{"tracer", {}}}, store, 8);
  budget.book(store, Sink::operators);
  store.scalar(0)[3] = 2;
  budget.book(store, Sink::mergers);
  output::NamedData data;
  budget.save(data);
  VarianceBudget continued({{"other", {}}, {"tracer", {}}}, store, 8);
  continued.restore(data);
  EXPECT_FALSE(continued.started());
  continued.book(store, Sink::operators);
  const auto before = budget.measure(store), after = continued.measure(store);
  EXPECT_GT(before[2], 0);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(after[3 + i], before[i]) << i;
  EXPECT_EQ(after[1], 0);
}

TEST(VarianceBudget, RefusesWhatIsNotCarriedPerVolume) {
  const parcels::Store store = four_parcels();
  EXPECT_THROW(VarianceBudget({{"amount", {}}}, store, 8), Error);
  EXPECT_THROW(VarianceBudget({{"tracers", {}}}, store, 8), Error);
}

}  // namespace
}  // namespace pileus::model
