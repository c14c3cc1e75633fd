// Quantities of the ground: who may declare them, and what calls, retries and restarts make of
// them.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "coupling/failure.hpp"
#include "toy_operators.hpp"

namespace pileus::test {
namespace {

/// Explicit Euler for dq/dt = −q; what a parcel loses, times its volume, falls to the ground of the
/// column that its identity names. Rejects steps above `longest` after having taken them.
class Fallout : public Operator<Fallout> {
 public:
  void describe(Declaration& d) {
    introduce(d, "test.fallout");
    d.op.scope = PILEUS_GLOBAL;
    rain = d.owns("mass_fraction_of_rain_in_air", "1").intensive("water").range(0, 10).initial(1);
    volume = d.reads("parcel_volume", "m3");
    ground = d.accumulates("rainfall_amount", "kg m-2").range(0, 1e3);
    water = d.budget("water");
    longest = d.number("longest", "s", 100);
  }
  void apply(const pileus_step& step, Block block) const {
    double* q = block.out(rain);
    const double* v = block.in(volume);
    double* fallen = block.accumulator(ground);
    const auto columns = static_cast<std::uint64_t>(block.elements(ground));
    block.each([&](auto p) {
      const double loss = step.dt * q[p];
      q[p] -= loss;
      fallen[block.uid(p) % columns] += v[p] * loss;
      block.book(water, -v[p] * loss);
    });
    if (step.dt > value(longest)) throw Retry("too long");
  }

 private:
  Slot rain, volume, ground;
  Param longest;
  Budget water;
};

/// A second one that adds to the same quantity: one unit per call.
class Drizzle : public Operator<Drizzle> {
 public:
  void describe(Declaration& d) {
    introduce(d, "test.drizzle");
    d.op.scope = PILEUS_GLOBAL;
    ground = d.accumulates("rainfall_amount", "kg m-2");
  }
  void apply(const pileus_step&, Block block) const {
    for (std::int64_t c = 0; c < block.elements(ground); ++c) block.accumulator(ground)[c] += 1;
  }

 private:
  Slot ground;
};

/// A local operator that reads the ground: the tracer becomes what lies in the first column.
class Gauge : public Operator<Gauge> {
 public:
  void describe(Declaration& d) {
    introduce(d, "test.gauge");
    tracer = d.owns("passive_tracer", "1").intensive().range(0, 1e6).initial(0);
    ground = d.reads("rainfall_amount", "kg m-2").place(PILEUS_SURFACE);
  }
  void apply(const pileus_step&, Block block) const {
    double* c = block.out(tracer);
    block.each([&](auto p) { c[p] = block.in(ground)[0]; });
  }

 private:
  Slot tracer, ground;
};

/// Gives a quantity of the ground a nature.
class Heavy : public Operator<Heavy> {
 public:
  void describe(Declaration& d) {
    introduce(d, "test.heavy");
    d.op.scope = PILEUS_GLOBAL;
    d.accumulates("rainfall_amount", "kg m-2").extensive();
  }
  void apply(const pileus_step&, Block) const {}
};

/// Is active where the ground is wet, which no parcel is.
class Puddle : public Operator<Puddle> {
 public:
  void describe(Declaration& d) {
    introduce(d, "test.puddle");
    d.op.scope = PILEUS_GLOBAL;
    d.accumulates("rainfall_amount", "kg m-2");
    d.active_if(0, "rainfall_amount", PILEUS_GT, 0.0);
  }
  void apply(const pileus_step&, Block) const {}
};

pileus_grid grid_of(std::int64_t nx, std::int64_t ny) {
  pileus_grid grid{};
  grid.cells[0] = nx, grid.cells[1] = ny, grid.cells[2] = 4;
  grid.dimension = ny > 1 ? 3 : 2;
  for (double& spacing : grid.spacing) spacing = 1;
  return grid;
}

/// An entry whose table says something else about its only quantity of the ground.
template <class Op, class Change>
std::vector<coupling::OperatorEntry> changed(Change&& change) {
  coupling::OperatorEntry entry = entry_of<Op>("rain");
  auto table = std::make_shared<host::OperatorTable>(*entry.table);
  change(table->op,
         table->quantities.at(static_cast<std::size_t>(table->find_quantity("rainfall_amount"))));
  entry.table = table;
  return {entry};
}

std::string complaint(std::vector<coupling::OperatorEntry> entries,
                      coupling::SequenceOptions options = {}) {
  try {
    const coupling::OperatorSequence sequence(std::move(entries), std::move(options));
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

void expect_in(const std::string& text, const std::string& phrase) {
  EXPECT_NE(text.find(phrase), std::string::npos) << text;
}

TEST(Surface, collects_what_each_column_was_given) {
  constexpr std::size_t parcels = 3000, nx = 3, ny = 2;
  ToyRun run(entries_of<Fallout>({"rain"}), parcels, {}, grid_of(nx, ny));
  const coupling::SurfaceFields& surface = run.sequence.surface();
  ASSERT_EQ(surface.list().size(), 1u);
  EXPECT_EQ(surface.list().front().units, "kg m-2");
  ASSERT_EQ(surface.columns(), nx * ny);
  run.step(0, 0.25);
  run.step(1, 0.5);
  // Per parcel of volume 2: 0.25, then half of what is left, exactly representable.
  const double each = 2 * (0.25 + 0.5 * 0.75);
  for (const double fallen : surface.values(0)) EXPECT_EQ(fallen, each * parcels / (nx * ny));
  const auto budget = run.sequence.ledger().operators.front().budgets.front();
  EXPECT_EQ(budget.source, -each * parcels);
  EXPECT_EQ(budget.change, -each * parcels);
}

TEST(Surface, stands_on_one_column_without_a_mesh_and_is_shared_by_those_that_add) {
  ToyRun run(entries_of<Fallout, Drizzle>({"rain", "drizzle"}), 4);
  run.step(0, 0.5);
  ASSERT_EQ(run.sequence.surface().columns(), 1u);
  EXPECT_EQ(run.sequence.surface().values(0).front(), 4 * 2 * 0.5 + 1);
}

TEST(Surface, is_put_back_before_a_retry) {
  std::vector<coupling::OperatorEntry> fussy = entries_of<Fallout>({"rain"});
  fussy.front().values.set_number(0, 0.25);
  ToyRun retried(fussy, 100, {}, grid_of(5, 1));
  ToyRun four(entries_of<Fallout>({"rain"}), 100, {}, grid_of(5, 1));
  retried.step(0, 1.0);
  for (std::uint64_t n = 0; n < 4; ++n) four.step(n, 0.25);
  EXPECT_GT(retried.sequence.ledger().operators.front().retries, 0u);
  EXPECT_EQ(retried.sequence.surface().values(0), four.sequence.surface().values(0));
}

TEST(Surface, out_of_its_range_is_named_and_left_as_it_was) {
  auto narrow = changed<Fallout>([](auto&, pileus_quantity& row) { row.high = 30; });
  ToyRun run(narrow, 100, {}, grid_of(5, 1));
  run.step(0, 0.5);  // 20 of the 40 in every column
  try {
    run.step(1, 0.75);  // also in eight parts it takes 10.9 of the other 20, and 10 are allowed
    FAIL() << "a value above the range passed";
  } catch (const coupling::OperatorFailure& failure) {
    expect_in(failure.what(), "it brought column 0 of the surface to");
    EXPECT_EQ(failure.bundle().quantity, "rainfall_amount");
    EXPECT_EQ(failure.bundle().uid, 0u);
  }
  EXPECT_EQ(run.sequence.surface().values(0), std::vector<double>(5, 20.0));
  EXPECT_EQ(run.values("mass_fraction_of_rain_in_air")[7], 0.5);
}

TEST(Surface, can_be_read_by_local_operators_after_each_change) {
  ToyRun run(entries_of<Gauge, Drizzle>({"gauge", "drizzle"}), 2000);
  for (std::uint64_t n = 0; n < 3; ++n) run.step(n, 1.0);
  // The last of the order is called first.
  EXPECT_EQ(run.values("passive_tracer")[1999], 3.0);
}

TEST(Surface, survives_a_restart) {
  ToyRun run(entries_of<Drizzle>({"drizzle"}), 10, {}, grid_of(4, 3));
  run.step(0, 1.0);
  run.sequence.surface().values(0)[7] = 1.0 / 3;
  const auto saved = run.sequence.surface().named_values();
  ToyRun other(entries_of<Drizzle>({"drizzle"}), 10, {}, grid_of(4, 3));
  EXPECT_EQ(other.sequence.surface().values(0), std::vector<double>(12, 0.0));
  other.sequence.surface().restore(saved);
  EXPECT_EQ(other.sequence.surface().values(0), run.sequence.surface().values(0));
  EXPECT_THROW(other.sequence.surface().restore({}), Error);
  ToyRun narrower(entries_of<Drizzle>({"drizzle"}), 10, {}, grid_of(4, 1));
  EXPECT_THROW(narrower.sequence.surface().restore(saved), Error);
}

TEST(Surface, may_start_from_the_value_of_its_owner) {
  const auto owned = changed<Drizzle>([](auto&, pileus_quantity& row) {
    row.access |= PILEUS_CREATE;
    row.initial = 5;
  });
  ToyRun run(owned, 1, {}, grid_of(2, 1));
  EXPECT_EQ(run.sequence.surface().values(0), std::vector<double>(2, 5.0));
  auto twice = owned;
  twice.push_back(owned.front());
  twice.back().name = "second";
  expect_in(complaint(twice), "is owned by both 'rain' and 'second'");
}

TEST(Surface, is_refused_to_those_who_would_make_results_depend_on_threads) {
  expect_in(
      complaint(changed<Drizzle>([](pileus_operator& op, auto&) { op.scope = PILEUS_LOCAL; })),
      "in no fixed order; its scope has to be global");
  expect_in(complaint(changed<Drizzle>(
                [](auto&, pileus_quantity& row) { row.access = PILEUS_READ | PILEUS_WRITE; })),
            "to overwrite it; only its owner does, others add to it");
  expect_in(complaint(changed<Drizzle>([](auto&, pileus_quantity& row) { row.components = 2; })),
            "one double-precision number per column of cells");
}

/// Multiplies what it owns of the ground by two, and tells the parcels the last column's value.
/// Rejects steps above 1 s after having taken them.
class Soil : public Operator<Soil> {
 public:
  void describe(Declaration& d) {
    introduce(d, "test.soil");
    d.op.scope = PILEUS_GLOBAL;
    ground = d.owns_on_surface("rainfall_amount", "kg m-2").initial(3).range(0, 1e3);
    tracer = d.owns("passive_tracer", "1").intensive().range(0, 1e6);
  }
  void apply(const pileus_step& step, Block block) const {
    double* value = block.out(ground);
    for (std::int64_t c = 0; c < block.elements(ground); ++c) value[c] *= 2;
    block.each([&](auto p) { block.out(tracer)[p] = value[block.elements(ground) - 1]; });
    if (step.dt > 1) throw Retry("too long");
  }

 private:
  Slot ground, tracer;
};

TEST(Surface, is_overwritten_by_its_owner_and_put_back_before_a_retry) {
  ToyRun run(entries_of<Soil>({"soil"}), 10, {}, grid_of(4, 2));
  run.step(0, 1.0);
  EXPECT_EQ(run.sequence.surface().values(0), std::vector<double>(8, 6.0));
  EXPECT_EQ(run.values("passive_tracer")[9], 6.0);
  run.step(1, 2.0);  // twice 1 s
  EXPECT_EQ(run.sequence.surface().values(0), std::vector<double>(8, 24.0));
}

TEST(Surface, starts_at_what_it_is_given_column_by_column) {
  coupling::SequenceOptions options;
  options.initial = {"rainfall_amount"};
  ToyRun run(entries_of<Soil>({"soil"}), 1, options, grid_of(2, 1));
  EXPECT_EQ(run.sequence.surface().values(0), std::vector<double>(2, 3.0));
  run.sequence.surface().begin_with(0, {5, 7});
  run.sequence.surface().start(2);
  run.step(0, 1.0);
  EXPECT_EQ(run.sequence.surface().values(0), (std::vector<double>{10, 14}));
  expect_in(complaint(changed<Soil>([](pileus_operator& op, auto&) { op.scope = PILEUS_LOCAL; })),
            "in no fixed order; its scope has to be global");
}

TEST(Surface, contradictions_are_named) {
  expect_in(complaint(entries_of<Gauge>({"gauge"})),
            "operator 'gauge' reads 'rainfall_amount' on the surface, which no operator adds to");
  coupling::SequenceOptions options;
  options.initial = {"rainfall_amount"};
  expect_in(complaint(entries_of<Drizzle>({"drizzle"}), options), "but parcels carry it");
  expect_in(complaint(changed<Drizzle>([](auto&, pileus_quantity& row) { row.units = "mm"; })),
            "declares 'rainfall_amount' in 'mm', registered is 'kg m-2'");
  EXPECT_THROW(entry_of<Heavy>("heavy"), std::logic_error);
  EXPECT_THROW(entry_of<Puddle>("puddle"), std::logic_error);
}

}  // namespace
}  // namespace pileus::test
