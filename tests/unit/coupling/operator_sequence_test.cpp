// Order, retry, activity, sub-steps and books of the operator sequence, with operators whose
// results are known in closed form.
#include <gtest/gtest.h>
#include <omp.h>

#include <cstring>

#include "toy_operators.hpp"

namespace pileus::test {
namespace {

using coupling::SequenceOptions;

TEST(Retry, gives_smaller_steps_only_to_the_parcels_that_need_them) {
  ToyRun run(entries_of<FussyEuler>({"euler"}), 2500);
  run.step(1, 1.0);
  const double* q = run.values("passive_tracer");
  for (std::size_t p = 0; p < 2500; ++p) {
    // Parcels accept dt ≤ 1/(1 + uid % 5): 1, 2, 4, 4, 8 parts; Euler gives (1 − 1/n)^n.
    constexpr double parts[] = {1, 2, 4, 4, 8};
    const double n = parts[run.store.uid()[p] % 5];
    double expected = 1;
    for (int k = 0; k < n; ++k) expected -= 1.0 / n * expected;
    EXPECT_EQ(q[p], expected) << "parcel " << p;
  }
  EXPECT_GT(run.sequence.ledger().operators.front().retries, 0u);
}

TEST(Retry, ends_with_an_error_that_names_the_parcel_count_of_calls) {
  ToyRun run(entries_of<FussyEuler>({"euler"}), 10);
  try {
    run.step(1, 10.0);  // even 10/8 s is too long for most parcels
    FAIL() << "an impossible step succeeded";
  } catch (const coupling::OperatorFailure& failure) {
    EXPECT_EQ(failure.code(), ExitCode::plugin);
    EXPECT_NE(std::string(failure.what()).find("asked for a smaller step: too long"),
              std::string::npos);
  }
  for (std::size_t p = 0; p < 10; ++p) EXPECT_EQ(run.values("passive_tracer")[p], 1.0);
}

std::vector<double> random_growth(int threads, bool skip) {
  omp_set_num_threads(threads);
  SequenceOptions options;
  options.coupling.skip_inactive = skip;
  options.seed = 7;
  ToyRun run(entries_of<RandomGrowth>({"growth"}), 5000, options);
  for (std::size_t p = 0; p < 5000; p += 1 + p % 7) run.values("passive_tracer")[p] = 1.5;
  run.sequence.population_changed();
  for (std::uint64_t n = 0; n < 5; ++n) run.step(n, 0.5);
  const double* q = run.values("passive_tracer");
  std::vector<double> all(q, q + 5000);
  const auto budget = run.sequence.ledger().operators.front().budgets.front();
  all.push_back(budget.change);
  all.push_back(budget.source);
  return all;
}

TEST(Determinism, same_bits_for_any_number_of_threads_and_with_skipping_off) {
  const std::vector<double> reference = random_growth(1, true);
  for (const int threads : {2, 3}) EXPECT_EQ(random_growth(threads, true), reference);
  EXPECT_EQ(random_growth(2, false), reference);
  omp_set_num_threads(2);
}

coupling::SequenceOptions audited(double share) {
  SequenceOptions options;
  options.coupling.audit = share;
  return options;
}

TEST(Audit, finds_a_false_declaration_and_names_parcel_quantity_and_plugin) {
  for (const bool partly : {false, true}) {  // a whole block is skipped, or part of one
    ToyRun run(entries_of<FalselyIdle>({"liar"}), 3000, audited(1));
    run.values("passive_tracer")[1500] = 1.75;
    if (partly) run.values("passive_tracer")[1600] = 3.0;
    run.sequence.population_changed();
    try {
      run.step(0, 1.0);
      FAIL() << "the audit saw nothing";
    } catch (const Error& error) {
      const std::string text = error.what();
      EXPECT_EQ(error.code(), ExitCode::plugin);
      for (const char* phrase :
           {"'liar'", "test.falsely_idle", "parcel 1501", "passive_tracer", "from 1.75 to 2.75"})
        EXPECT_NE(text.find(phrase), std::string::npos) << text;
    }
    EXPECT_EQ(run.values("passive_tracer")[1500], 1.75) << "the audit works on a copy";
  }
}

TEST(Audit, also_looks_at_operators_that_have_been_idle) {
  ToyRun run(entries_of<FalselyIdle>({"liar"}), 100, audited(0.0));
  run.step(0, 1.0);  // nobody above 1.5 yet
  EXPECT_EQ(run.sequence.ledger().operators.front().skipped_by_bounds, 100u);
  run.step(1, 1.0);
  EXPECT_EQ(run.sequence.ledger().operators.front().skipped_by_epoch, 100u);
  ToyRun second(entries_of<FalselyIdle>({"liar"}), 100, audited(1.0));
  second.step(0, 1.0);
  second.values("passive_tracer")[3] = 1.75;  // behind the sequence's back: no new version
  EXPECT_THROW(second.step(1, 1.0), Error);
}

TEST(Audit, changes_no_bit_and_draws_its_share) {
  SequenceOptions plain, probing = audited(0.25);
  ToyRun reference(entries_of<RandomGrowth>({"growth"}), 40 * 1024, plain);
  ToyRun run(entries_of<RandomGrowth>({"growth"}), 40 * 1024, probing);
  for (ToyRun* one : {&reference, &run}) {
    for (std::size_t p = 0; p < 40 * 1024; p += 3000) one->values("passive_tracer")[p] = 1.5;
    one->sequence.population_changed();
    for (std::uint64_t n = 0; n < 10; ++n) one->step(n, 0.5);
  }
  for (std::size_t p = 0; p < 40 * 1024; ++p)
    ASSERT_EQ(run.values("passive_tracer")[p], reference.values("passive_tracer")[p]);
  const auto ledger = run.sequence.ledger().operators.front();
  // 400 draws of probability 1/4: 100 expected, standard deviation 8.7; six of them.
  EXPECT_NEAR(static_cast<double>(ledger.audited) / 1024, 100, 52);
  EXPECT_GT(ledger.skipped_by_bounds, 20u * 1024);
}

TEST(Activity, calls_only_active_parcels_and_skips_idle_operators_by_one_comparison) {
  ToyRun run(entries_of<RandomGrowth>({"growth"}), 3000);
  RandomGrowth::parcels_seen = 0;
  run.step(0, 1.0);  // all at 1.0: nobody is above 1
  run.step(1, 1.0);
  EXPECT_EQ(RandomGrowth::parcels_seen, 0);
  EXPECT_EQ(run.sequence.ledger().operators.front().skipped(), 6000u);
  EXPECT_EQ(run.sequence.ledger().operators.front().calls, 0u);
  run.values("passive_tracer")[10] = 2.0;
  run.values("passive_tracer")[1500] = 2.0;
  run.values("passive_tracer")[1502] = 2.0;
  run.sequence.population_changed();
  run.step(2, 1.0);
  EXPECT_EQ(RandomGrowth::parcels_seen, 3);
  EXPECT_EQ(run.sequence.ledger().operators.front().calls, 2u);
}

TEST(Books, hold_change_and_declared_source) {
  ToyRun run(entries_of<RandomGrowth>({"growth"}), 3000);
  for (std::size_t p = 0; p < 3000; ++p) run.values("passive_tracer")[p] = 3.0;
  run.sequence.population_changed();
  const double before = run.sequence.ledger().totals.front().total;
  EXPECT_EQ(before, 3000 * 3.0 * 2.0);
  run.step(0, 1.0);
  const coupling::Ledger ledger = run.sequence.ledger();
  const auto budget = ledger.operators.front().budgets.front();
  EXPECT_EQ(budget.budget, "matter");
  EXPECT_GT(budget.change, 0.0);
  // q + gain is rounded once per parcel: half a unit of 4 for each of 3000 parcels of volume 2.
  EXPECT_NEAR(budget.defect(), 0.0, 3000 * 2.0 * 4.5e-16);
  EXPECT_NEAR(ledger.totals.front().total - before, budget.change, before * 2.3e-16);
}

TEST(Books, survive_a_restart) {
  ToyRun run(entries_of<RandomGrowth>({"growth"}), 100);
  run.values("passive_tracer")[3] = 3.0;
  run.sequence.population_changed();
  run.step(0, 1.0);
  ToyRun other(entries_of<RandomGrowth>({"growth"}), 100);
  other.sequence.restore_books(run.sequence.books());
  EXPECT_EQ(other.sequence.ledger().operators.front().budgets.front().change,
            run.sequence.ledger().operators.front().budgets.front().change);
}

TEST(Substeps, follow_the_limit_of_prepare) {
  ToyRun run(entries_of<Substepped>({"decay"}), 10);
  run.step(0, 1.0);
  double expected = 1;
  for (int k = 0; k < 10; ++k) expected -= 1.0 / 10 * expected;
  EXPECT_EQ(run.values("passive_tracer")[0], expected);
  EXPECT_DOUBLE_EQ(run.sequence.dt_limit(), 6.4);
  EXPECT_THROW(run.step(1, 100.0), Error);
}

/// Error of the oscillator at t = 1 with n steps.
double splitting_error(scene::Coupling::Scheme scheme, int n) {
  SequenceOptions options;
  options.coupling.scheme = scheme;
  ToyRun run(entries_of<Drift, Kick>({"drift", "kick"}), 1, options);
  for (int k = 0; k < n; ++k) run.step(static_cast<std::uint64_t>(k), 1.0 / n);
  return std::hypot(run.values("specific_humidity")[0] - std::cos(1.0),
                    run.values("passive_tracer")[0] + std::sin(1.0));
}

TEST(Splitting, has_order_one_for_lie_and_two_for_strang) {
  using Scheme = scene::Coupling::Scheme;
  // The next term of the error series is smaller by dt = 1/32 at least.
  const double lie = std::log2(splitting_error(Scheme::lie, 32) / splitting_error(Scheme::lie, 64));
  EXPECT_NEAR(lie, 1.0, 0.05);
  const double strang =
      std::log2(splitting_error(Scheme::strang, 32) / splitting_error(Scheme::strang, 64));
  EXPECT_NEAR(strang, 2.0, 0.05);
}

TEST(Order, of_the_scene_is_obeyed_and_checked) {
  SequenceOptions options;
  options.coupling.order = {"kick", "transport", "drift"};
  EXPECT_EQ(coupling::OperatorSequence(entries_of<Drift, Kick>({"drift", "kick"}), options).order(),
            (std::vector<std::string>{"kick", "drift"}));
  options.coupling.order = {"kik", "drift"};
  EXPECT_THROW(coupling::OperatorSequence(entries_of<Drift, Kick>({"drift", "kick"}), options),
               Error);
  options.coupling.order = {"drift"};
  EXPECT_THROW(coupling::OperatorSequence(entries_of<Drift, Kick>({"drift", "kick"}), options),
               Error);
}

std::string complaint(std::vector<coupling::OperatorEntry> entries, SequenceOptions options) {
  try {
    const coupling::OperatorSequence sequence(std::move(entries), std::move(options));
  } catch (const Error& error) {
    return error.code() == ExitCode::usage ? error.what() : "wrong exit code";
  }
  return {};
}

TEST(Quantities, need_one_owner_and_a_source) {
  EXPECT_NE(complaint(entries_of<Kick, FussyEuler>({"a", "b"}), {})
                .find("'passive_tracer' is owned by both 'a' and 'b'"),
            std::string::npos);
  EXPECT_NE(complaint(entries_of<Drift>({"drift"}), {})
                .find("operator 'drift' needs 'passive_tracer', which no operator provides"),
            std::string::npos);
  SequenceOptions options;
  options.initial = {"passive_tracer", "bouyancy"};
  EXPECT_NE(complaint(entries_of<Drift>({"drift"}), options).find("did you mean 'buoyancy'?"),
            std::string::npos);
  options.initial = {"passive_tracer"};
  EXPECT_EQ(complaint(entries_of<Drift>({"drift"}), options), "");
}

TEST(Quantities, buoyancy_is_carried_when_nobody_derives_it) {
  const coupling::OperatorSequence sequence({}, {});
  ASSERT_EQ(sequence.required_scalars().size(), 1u);
  EXPECT_EQ(sequence.required_scalars().front().name, "buoyancy");
  EXPECT_EQ(sequence.required_scalars().front().nature, parcels::Nature::intensive);
  EXPECT_FALSE(sequence.derives_buoyancy());
}

}  // namespace
}  // namespace pileus::test
