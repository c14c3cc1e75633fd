// A run from its scene file to its summary.
#pragma once
#include <string>
#include <vector>

#include "base/progress.hpp"
#include "output/summary.hpp"

namespace pileus::model {

struct RunRequest {
  std::string scene_path;
  std::vector<std::string> overrides;  // key=value
  std::string output_directory;        // empty: the scene's, else results/<scene>
  int threads = 0;                     // 0: OMP_NUM_THREADS, SLURM_CPUS_PER_TASK, all cores
  bool resume = false, force = false, quiet = false;
};

struct RunResult {
  std::string directory;
  output::Summary summary;
  bool expectations_met = true;
};

/// Runs a scene to its end, or until stopped on request (summary.status stopped, with a
/// checkpoint).
///
/// Errors  Error with ExitCode::usage (scene or options; nothing was written), plugin, numerical
///         (a failure bundle and a summary were written), file
RunResult run(const RunRequest& request, Progress& progress);

}  // namespace pileus::model
