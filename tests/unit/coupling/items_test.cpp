// Items of parcels as operators see them: made, changed, moved, refused, put back, accounted for.
#include <gtest/gtest.h>

#include "toy_operators.hpp"

namespace pileus::test {
namespace {

constexpr const char* number_name = "droplet_multiplicity";
constexpr const char* mass_name = "droplet_water_mass";

/// Makes uid % 4 items per parcel, each for ten things of a mass of their own; they grow by a tenth
/// a second. Rejects long steps for one parcel.
class Maker : public Operator<Maker> {
 public:
  void describe(Declaration& d) {
    introduce(d, "test.maker");
    number = d.owns_items(number_name).range(0, 1e6);
    mass = d.owns_of_items(mass_name, "kg").of_each(number_name, "water").range(0, 5);
    d.budget("water");
    d.active_if(0, mass_name, PILEUS_GT, 0.0);
  }
  const void* extension(const char* id) const {
    static const pileus_items_ext about{sizeof about, 0, 5, 2.0};
    return std::string(id) == PILEUS_ITEMS_EXTENSION ? &about : nullptr;
  }
  void init(const pileus_step&, Block block) {
    std::vector<std::int32_t> count;
    std::size_t total = 0;
    for (std::int64_t p = 0; p < block.count(); ++p) {
      count.push_back(static_cast<std::int32_t>(block.uid(p) % 4));
      total += block.uid(p) % 4;
    }
    regroup_items(block, count, std::vector<std::int64_t>(total, -1));
    for (std::int64_t p = 0; p < block.count(); ++p)
      for (std::int64_t i = block.item_begin(p); i < block.item_end(p); ++i) {
        block.whole_out(number)[i] = 10;
        block.out(mass)[i] = block.uid(p) % 3 == 0 ? 0.0 : 1.0;
      }
  }
  void apply(const pileus_step& step, Block block) const {
    double* m = block.out(mass);
    block.each([&](auto p) {
      for (std::int64_t i = block.item_begin(p); i < block.item_end(p); ++i)
        m[i] *= 1.0 + 0.1 * step.dt;
      if (block.uid(p) == 2 && step.dt > 0.5) throw Retry("too long");
    });
  }

 private:
  Slot number, mass;
};

/// Gives all items to the first parcel, or asks for what cannot be, or fails afterwards.
class Mover : public Operator<Mover> {
 public:
  void describe(Declaration& d) {
    introduce(d, "test.mover");
    d.op.scope = PILEUS_GLOBAL;
    d.op.flags = PILEUS_RESIZES_ITEMS;
    number = d.updates_of_items(number_name, "1").type(PILEUS_I64).range(0, 1e6);
    mass = d.updates_of_items(mass_name, "kg").of_each(number_name, "water").range(0, 5);
    d.budget("water");
    what = d.choice("what", {"move", "negative", "beyond", "spoil"});
  }
  void apply(const pileus_step&, Block block) const {
    std::vector<std::int32_t> count(static_cast<std::size_t>(block.count()), 0);
    std::vector<std::int64_t> source;
    for (std::int64_t p = 0; p < block.count(); ++p)
      for (std::int64_t i = block.item_begin(p); i < block.item_end(p); ++i) source.push_back(i);
    count[0] = static_cast<std::int32_t>(source.size());
    if (choice(what) == 1) count[1] = -1;
    if (choice(what) == 2) source.back() = 1000000;
    regroup_items(block, count, source);
    EXPECT_EQ(block.item_end(0) - block.item_begin(0), static_cast<std::int64_t>(source.size()));
    if (choice(what) == 3) block.out(mass)[0] = -1;
  }

 private:
  Slot number, mass;
  Param what;
};

/// Not global, and regroups all the same.
class Meddler : public Operator<Meddler> {
 public:
  void describe(Declaration& d) {
    introduce(d, "test.meddler");
    number = d.owns_items(number_name).range(0, 1e6);
  }
  void apply(const pileus_step&, Block block) const {
    regroup_items(block, std::vector<std::int32_t>(static_cast<std::size_t>(block.count()), 0), {});
  }

 private:
  Slot number;
};

double total_mass(const parcels::ItemLists& items) {
  double sum = 0;
  for (std::size_t i = 0; i < items.size(); ++i)
    sum += static_cast<double>(items.multiplicity()[i]) * items.column(0)[i];
  return sum;
}

TEST(Items, are_made_in_init_and_grow) {
  ToyRun run(entries_of<Maker>({"maker"}), 3000);  // several blocks
  const parcels::ItemLists& items = run.store.items();
  EXPECT_EQ(items.most_per_parcel(), 5);
  EXPECT_EQ(items.budget_scale(), 2.0);
  std::size_t expected = 0;
  for (std::size_t p = 0; p < 3000; ++p) expected += (p + 1) % 4;
  ASSERT_EQ(items.size(), expected);
  const double before = total_mass(items);
  run.step(0, 1.0);
  for (std::size_t p = 0; p < 3000; ++p)
    for (std::int64_t i = items.begin()[p]; i < items.begin()[p] + items.count()[p]; ++i) {
      const double once = run.store.uid()[p] == 2 ? 1.05 * 1.05 : 1.1;  // two halves
      EXPECT_EQ(items.column(0)[i], run.store.uid()[p] % 3 == 0 ? 0.0 : 1.0 * once) << p;
    }
  const coupling::Ledger ledger = run.sequence.ledger();
  EXPECT_NEAR(ledger.operators[0].budgets[0].change, (total_mass(items) - before) / 2.0, 1e-9);
  EXPECT_NEAR(ledger.totals[0].total, total_mass(items) / 2.0, 1e-9);
  EXPECT_GT(ledger.operators[0].retries, 1u) << "halved until the parcel stands alone";
}

TEST(Items, parcels_without_an_item_above_the_threshold_are_skipped) {
  ToyRun run(entries_of<Maker>({"maker"}), 12);
  run.step(0, 0.1);
  // uid % 4 == 0: no items; uid % 3 == 0: items without mass. Of 12 parcels 3 + 4 − 1.
  EXPECT_EQ(run.sequence.ledger().operators[0].skipped_by_list, 6u);
}

TEST(Items, move_as_a_global_operator_says) {
  ToyRun run(entries_of<Maker, Mover>({"maker", "mover"}), 50);
  const double before = total_mass(run.store.items());
  const std::size_t size = run.store.items().size();
  run.step(0, 0.1);
  const parcels::ItemLists& items = run.store.items();
  EXPECT_EQ(items.size(), size);
  EXPECT_EQ(items.count()[0], static_cast<std::int32_t>(size));
  EXPECT_NEAR(total_mass(items), before * 1.01, 1e-9);
}

void expect_refusal(int position, const char* choice, const char* phrase) {
  auto entries = entries_of<Maker, Mover>({"maker", "mover"});
  entries[1].values.set_choice(0, position, choice);
  ToyRun run(std::move(entries), 50);
  const parcels::ItemLists& items = run.store.items();
  const std::vector<std::int32_t> count(items.count(), items.count() + 50);
  const std::vector<double> mass(items.column(0), items.column(0) + items.size());
  try {
    run.step(0, 0.1);
    FAIL() << choice << " went through";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(phrase), std::string::npos) << error.what();
  }
  EXPECT_EQ(std::vector<std::int32_t>(items.count(), items.count() + 50), count);
  EXPECT_EQ(std::vector<double>(items.column(0), items.column(0) + items.size()), mass);
}

TEST(Items, impossible_lists_are_refused_and_all_is_put_back) {
  expect_refusal(1, "negative", "a negative number of items");
  expect_refusal(2, "beyond", "a copy of one that does not exist");
  expect_refusal(3, "spoil", "wrote -1 to an item");
}

TEST(Items, are_regrouped_by_nobody_else) {
  ToyRun run(entries_of<Meddler>({"meddler"}), 5);
  try {
    run.step(0, 0.1);
    FAIL() << "it went through";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("PILEUS_RESIZES_ITEMS"), std::string::npos);
  }
}

/// Says that it resizes items, block by block.
class LocalMover : public Operator<LocalMover> {
 public:
  void describe(Declaration& d) {
    introduce(d, "test.local_mover");
    d.op.flags = PILEUS_RESIZES_ITEMS;
    number = d.updates_of_items(number_name, "1").type(PILEUS_I64);
  }
  void apply(const pileus_step&, Block) const {}

 private:
  Slot number;
};

TEST(Items, are_resized_by_global_operators_alone) {
  std::vector<std::string> complaints;
  host::read_operator(LocalMover::table(), complaints);
  ASSERT_EQ(complaints.size(), 1u);
  EXPECT_NE(complaints.front().find("global scope"), std::string::npos) << complaints.front();
}

TEST(Items, need_somebody_who_makes_them) {
  try {
    coupling::OperatorSequence sequence(entries_of<Mover>({"mover"}), {});
    FAIL() << "a scene without a maker was accepted";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("which no operator of the scene makes"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace pileus::test
