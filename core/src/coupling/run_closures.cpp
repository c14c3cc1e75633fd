// When closures run: in every stage, and before somebody looks at what only they derive.
#include "base/parallel.hpp"
#include "coupling/operator_sequence.hpp"

namespace pileus::coupling {

void OperatorSequence::diagnose(const StepTime& step) {
  touch_core();
  refresh(step, Derived::all);
}

void OperatorSequence::diagnose_stage(const StepTime& step) {
  touch_core();
  refresh(step, Derived::within_a_step);
}

/// Runs the closures whose inputs have changed since they last ran, and those that depend on them.
void OperatorSequence::refresh(const StepTime& step, Derived what) {
  clear_withheld();
  stale_.clear();
  for (const std::size_t which : plan_.closures) {
    const BoundOperator& bound = bound_[which];
    if (bound.dormant) continue;
    const std::uint64_t version = version_of(bound.read_columns);
    OperatorProgress& progress = progress_[which];
    if (version <= (what == Derived::all ? progress.demanded_at : progress.diagnosed_at)) continue;
    progress.diagnosed_at = version;
    if (what == Derived::all) progress.demanded_at = version;
    for (const std::size_t s : bound.derived) {
      if (is_left_out(bound.slots[s], what)) continue;
      versions_[static_cast<std::size_t>(bound.slots[s].column)] = next_version_;
    }
    ++next_version_;
    stale_.push_back(which);
  }
  if (!stale_.empty()) run_closures(step, what);
}

/// Block by block, all closures of a block one after another while its columns are in the cache.
void OperatorSequence::run_closures(const StepTime& step, Derived what) {
  match_threads();
  parallel_tasks(block_count(), [&](std::size_t block) {
    Workspace& work = workspaces_[static_cast<std::size_t>(omp_get_thread_num())];
    for (const std::size_t which : stale_) {
      const pileus_step record = step_record(bound_[which], step, false);
      if (!runner_->diagnose(which, record, block_range(block), what, work)) return;
    }
  });
  throw_first_failure();
}

}  // namespace pileus::coupling
