// A sweep as a job array of the batch system Slurm: one task per member.
#pragma once
#include <filesystem>
#include <string>

#include "study/sweep_run.hpp"

namespace pileus::study {

/// The batch script. `program`, `sweep` and `folder` are absolute paths; `jobs` limits the tasks
/// that run at a time, 0 does not.
std::string slurm_script(const Ensemble& ensemble, const SweepRequest& request,
                         const std::filesystem::path& program, const std::filesystem::path& sweep,
                         const std::filesystem::path& folder);

/// Writes sweep.sbatch and the lists of members to the sweep's folder and submits it where sbatch
/// exists, unless `submit` is false; `out` hears what to do next. Throws Error(usage) for mistakes
/// in the sweep, Error(file) when the script cannot be written or is refused.
void hand_to_slurm(const SweepRequest& request, bool submit, std::ostream& out);

}  // namespace pileus::study
