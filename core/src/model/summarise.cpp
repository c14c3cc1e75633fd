// The summary of a run: everything summary.json holds.
#include <omp.h>
#include <sys/resource.h>

#include <algorithm>

#include "model/loop.hpp"
#include "model/provenance.hpp"
#include "output/state_hash.hpp"

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

std::vector<output::EffectSummary> effects_of(const coupling::OperatorSequence& sequence,
                                              const coupling::Ledger& ledger) {
  std::vector<output::EffectSummary> effects;
  const auto& operators = sequence.operators();
  for (std::size_t i = 0; i < operators.size(); ++i)
    for (const auto& effect : operators[i].table->effects)
      if (effect.role == PILEUS_PROVIDES)
        effects.push_back({effect.name, "on",
                           "provided by the operator '" + operators[i].name + "' of the scene",
                           i < ledger.operators.size() ? ledger.operators[i].core_seconds : 0.0});
  return effects;
}

}  // namespace

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
  for (const auto& op : ledger.operators)
    s.operators.push_back(
        {op.name, op.parcels, op.skipped, op.core_seconds, op.retries, op.repairs});
  s.effects = effects_of(sequence_, ledger);
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
    s.budgets.push_back(budget);
  }
  std::map<std::string, std::vector<double>> beside_parcels = sequence_.surface().named_values();
  const auto& wind = simulation_->mean_wind().velocity;
  beside_parcels["mean_wind"] = {wind[0], wind[1]};
  s.state_sha256 = output::state_sha256(simulation_->store(), simulation_->time(),
                                        simulation_->step(), beside_parcels);
  s.directory = directory_.path().string();
  if (streams_) s.outputs = streams_->summarise();
  return s;
}

}  // namespace pileus::model
