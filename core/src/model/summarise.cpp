// The summary of a run: everything summary.json holds.
#include <fmt/format.h>
#include <omp.h>
#include <sys/resource.h>

#include <algorithm>

#include "model/loop.hpp"
#include "model/provenance.hpp"
#include "output/state_hash.hpp"
#include "planner/costs.hpp"
#include "planner/plan_text.hpp"

namespace pileus::model {
namespace {

std::uint64_t peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

std::vector<output::PhaseSummary> phases_of(const PhaseTimes& times) {
  double total = 0;
  for (int p = 0; p < static_cast<int>(Phase::count_); ++p)
    total += times[static_cast<Phase>(p)].seconds;
  std::vector<output::PhaseSummary> phases;
  for (int p = 0; p < static_cast<int>(Phase::count_); ++p) {
    const auto& entry = times[static_cast<Phase>(p)];
    phases.push_back({std::string(phase_names[static_cast<std::size_t>(p)]), entry.seconds,
                      total > 0 ? entry.seconds / total : 0.0, entry.calls});
  }
  return phases;
}

}  // namespace

/// Share of the run's wall time on all its threads: calls are timed by the same clock, so that what
/// else the machine does falls on both.
double Loop::share_of_run(double seconds) const {
  const double all = totals_.wall * omp_get_max_threads();
  return all > 0 ? seconds / all : 0.0;
}

output::CallSummary Loop::call_summary(const coupling::OperatorLedger& op) const {
  output::CallSummary calls;
  calls.calls = op.parcels;
  calls.skipped = op.skipped();
  calls.seconds = op.core_seconds;
  calls.share = share_of_run(op.core_seconds);
  calls.retries = op.retries;
  calls.repairs = op.repairs;
  calls.skipped_by_epoch = op.skipped_by_epoch;
  calls.skipped_by_bounds = op.skipped_by_bounds;
  calls.skipped_by_list = op.skipped_by_list;
  calls.audited = op.audited;
  calls.seconds_saved = op.seconds_saved();
  return calls;
}

/// Verdicts of the plan, and what happened to them. The calls of an operator count for every effect
/// it provides.
std::vector<output::EffectSummary> Loop::effect_summaries(const coupling::Ledger& ledger) const {
  std::vector<output::EffectSummary> effects;
  for (const planner::EffectPlan& effect : plan_.effects) {
    if (effect.silent) continue;
    output::EffectSummary entry{effect.effect, word_of(effect.verdict),
                                planner::reason_line(plan_, effect)};
    for (const Activation& one : physics_.activations())
      if (one.effect == effect.effect)
        entry.reason += fmt::format("; switched on at t = {:.6g} s, step {}", one.time, one.step);
    for (const std::size_t i : effect.providers)
      for (const coupling::OperatorLedger& op : ledger.operators)
        if (op.name == plan_.operators[i].name && effect.verdict != planner::Verdict::off)
          entry.calls.add(call_summary(op));
    effects.push_back(std::move(entry));
  }
  return effects;
}

/// What became of every total that the run keeps books of.
std::vector<output::BudgetSummary> Loop::budget_summaries(const coupling::Ledger& ledger) const {
  std::vector<output::BudgetSummary> budgets;
  for (const auto& total : ledger.totals) {
    output::BudgetSummary budget;
    budget.name = total.budget;
    budget.final = budget.initial = total.total;
    for (const auto& initial : initial_budgets_)
      if (initial.budget == total.budget) budget.initial = initial.total;
    for (const auto& op : ledger.operators)
      for (const auto& share : op.budgets)
        if (share.budget == total.budget) budget.sources += share.source;
    budget.defect = budget.final - budget.initial - budget.sources;
    budgets.push_back(budget);
  }
  return budgets;
}

/// Memory by the plan, time by the costs kept on this machine, unless what was left out came on.
output::LeftOutSummary Loop::left_out() const {
  output::LeftOutSummary left;
  left.bytes_per_parcel = plan_.flow.bytes_left_out;
  planner::Plan priced = plan_;
  planner::predict_time(scene_, planner::Costs::read(planner::Costs::default_path()), priced);
  if (priced.flow.seconds_left_out && physics_.activations().empty())
    left.seconds = *priced.flow.seconds_left_out * totals_.parcel_steps;
  return left;
}

output::Summary Loop::summary() const {
  output::Summary s;
  describe_origin(scene_, s);
  s.status = status_;
  s.message = message_;
  s.dimension = simulation_->dimension();
  s.threads = omp_get_max_threads();
  s.steps = simulation_->step();
  s.simulated_time = simulation_->time();
  s.wall = totals_.wall;
  s.core = totals_.core;
  s.parcels_initial = totals_.parcels_initial;
  s.parcels_final = simulation_->store().size();
  s.parcels_mean = s.steps > 0 ? totals_.parcel_steps / static_cast<double>(s.steps)
                               : static_cast<double>(s.parcels_final);
  if (totals_.parcel_steps > 0)
    s.ns_per_parcel_step = totals_.loop_core / totals_.parcel_steps * 1e9;
  s.bytes_per_parcel = static_cast<double>(simulation_->allocated_bytes()) /
                       static_cast<double>(std::max<std::uint64_t>(1, s.parcels_final));
  s.peak_memory = peak_memory_bytes();
  s.phases = phases_of(simulation_->times());
  s.diagnostics = record_->summarise();
  s.expect = judge(scene_.expect, *record_);

  const coupling::Ledger ledger = sequence_.ledger();
  for (const auto& op : ledger.operators) {
    s.operators.push_back({op.name, call_summary(op)});
  }
  s.watch = {physics_.tripwires().checks(), physics_.tripwires().seconds()};
  s.effects = effect_summaries(ledger);
  s.budgets = budget_summaries(ledger);
  s.left_out = left_out();
  std::map<std::string, std::vector<double>> beside_parcels = sequence_.surface().named_values();
  const auto& wind = simulation_->mean_wind().velocity;
  beside_parcels["mean_wind"] = {wind[0], wind[1]};
  s.state_sha256 = output::state_sha256(simulation_->store(), simulation_->time(),
                                        simulation_->step(), beside_parcels);
  s.directory = directory_.path().string();
  if (streams_) s.outputs = streams_->summarise();
  s.outputs.push_back({"plan.json", "which effects were simulated, and why", 0});
  return s;
}

}  // namespace pileus::model
