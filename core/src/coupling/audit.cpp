#include "coupling/audit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "coupling/operator_sequence.hpp"
#include "pileus/philox.hpp"

namespace pileus::coupling {

bool is_audited(double share, const pileus_step& step, std::size_t block) {
  if (!(share > 0)) return false;
  constexpr std::uint32_t channel = 63;  // the last: operators count theirs from 0
  double draw = 0;
  draw_uniform({step.seed, step.stream, block, step.number, step.call, channel}, 1, &draw);
  return draw < share;
}

/// Looks at the skipped part of a block, if it is among those audited.
void OperatorSequence::audit_block(std::size_t which, const pileus_step& step,
                                   const ParcelRange& range, const ActiveParcels& active,
                                   Workspace& work) {
  if (active.active() == range.count || !bound_[which].is_local()) return;
  if (!is_audited(options_.coupling.audit, step, static_cast<std::size_t>(range.block))) return;
  work.skipped.clear();
  if (active.count > 0) {
    const auto skip = [&](std::size_t from, std::size_t to) {
      for (; from < to; ++from) work.skipped.push_back(static_cast<std::uint32_t>(from));
    };
    std::size_t next = 0;
    if (active.indices.empty()) {
      skip(0, active.begin);
      next = active.begin + active.count;
    }
    for (const std::uint32_t index : active.indices) {
      skip(next, active.begin + index);
      next = active.begin + index + 1;
    }
    skip(next, range.count);
  }
  work.applied[which].audited += range.count - active.active();
  runner_->audit(which, step, range, work.skipped, work);
}

/// The same after a step in which nothing had changed since nobody was active.
void OperatorSequence::audit_idle(std::size_t which, const pileus_step& step) {
  if (!(options_.coupling.audit > 0) || !bound_[which].is_local()) return;
  match_threads();
  parallel_tasks(block_count(), [&](std::size_t block) {
    Workspace& work = workspaces_[static_cast<std::size_t>(omp_get_thread_num())];
    audit_block(which, step, block_range(block), {0, 0, {}}, work);
  });
  throw_first_finding();
}

void OperatorSequence::throw_first_finding() {
  const AuditFinding* first = nullptr;
  for (const Workspace& work : workspaces_) {
    if (work.finding.found() && (first == nullptr || work.finding.block < first->block)) {
      first = &work.finding;
    }
  }
  if (first == nullptr) return;
  const AuditFinding finding = *first;
  for (Workspace& work : workspaces_) work.finding = {};
  const OperatorEntry& entry = operators_[finding.which];
  throw Error(ExitCode::plugin,
              fmt::format("audit: operator '{}' ({} {}, {}) declares parcel {} inactive, but its "
                          "apply {}. Its activity conditions are wrong; until they are mended, run "
                          "with coupling.skip_inactive: false",
                          entry.name, entry.table->op.id, entry.table->op.version,
                          entry.table->library, finding.uid, finding.what));
}

}  // namespace pileus::coupling
