// The time loop: one state, its outputs, its checkpoints.
#pragma once
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "base/progress.hpp"
#include "coupling/operator_sequence.hpp"
#include "model/diagnostics.hpp"
#include "model/operator_physics.hpp"
#include "model/output_streams.hpp"
#include "model/plan_run.hpp"
#include "model/record.hpp"
#include "model/simulation.hpp"
#include "model/slab_statistics.hpp"
#include "output/run_directory.hpp"
#include "scene/scene.hpp"

namespace pileus::model {

/// Counts of a run that survive a restart.
struct LoopTotals {
  std::uint64_t parcels_initial = 0, splits = 0, merges = 0;
  double parcel_steps = 0;    // sum of parcels over steps
  double loop_core = 0;       // s, processor time of the steps, outputs and diagnostics aside
  double wall = 0, core = 0;  // s, of the whole run
};

class Loop {
 public:
  /// The scene, the folder and the progress outlive the loop.
  Loop(const scene::Scene& scene, PlannedRun planned, const output::RunDirectory& directory,
       Progress& progress);
  ~Loop();

  /// A new run. Files of an earlier run in the folder are replaced when `overwrite`.
  void start(bool overwrite);
  /// Continues from the newest whole checkpoint; false when there is none.
  bool resume();
  /// Steps to the end, or until a stop is requested. On failure writes a bundle and rethrows with
  /// its path in the message.
  void run();

  output::Summary summary() const;

 private:
  void open_streams(output::Start start);
  void advance();
  void timed_evaluate();
  void observe_and_begin(double until, bool last);
  void observe_slabs(bool for_series);
  void finish_step();
  double next_time(double allowed) const;
  void checkpoint();
  void checkpoint_if_due();
  void save_totals(output::NamedData& data) const;
  void restore_totals(const output::NamedData& data);
  void restore_phases(const output::NamedData& data);
  void report_progress(const dynamics::TimeStep& allowed);
  void report_activations();
  double share_of_run(double seconds) const;
  output::CallSummary call_summary(const coupling::OperatorLedger& op) const;
  std::vector<output::EffectSummary> effect_summaries(const coupling::Ledger& ledger) const;
  std::vector<output::BudgetSummary> budget_summaries(const coupling::Ledger& ledger) const;
  output::LeftOutSummary left_out() const;
  void write_status(const char* state) const;

  const scene::Scene& scene_;
  const output::RunDirectory& directory_;
  Progress& progress_;
  planner::Plan plan_;
  coupling::OperatorSequence sequence_;
  OperatorPhysics physics_;
  std::unique_ptr<Simulation> simulation_;
  std::unique_ptr<SlabStatistics> slabs_;  // null where none are wanted
  std::unique_ptr<Diagnostics> diagnostics_;
  std::unique_ptr<Record> record_;
  std::unique_ptr<OutputStreams> streams_;
  LoopTotals totals_;
  output::Summary::Status status_ = output::Summary::Status::done;
  std::string message_;
  std::vector<coupling::BudgetTotal> initial_budgets_;
  std::chrono::steady_clock::time_point started_, last_checkpoint_, last_status_;
  double core_started_ = 0;  // s, processor time when this session began
  double seconds_per_step_ = 0;
  std::uint64_t steps_since_checkpoint_ = 0;
  std::size_t activations_reported_ = 0;
};

}  // namespace pileus::model
