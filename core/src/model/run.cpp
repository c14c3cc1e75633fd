#include "model/run.hpp"

#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "base/error.hpp"
#include "base/signals.hpp"
#include "coupling/operator_entry.hpp"
#include "host/search.hpp"
#include "model/loop.hpp"
#include "model/plan_run.hpp"
#include "output/checkpoint.hpp"
#include "scene/read_scene.hpp"

namespace pileus::model {
namespace {

void choose_threads(int asked) {
  if (asked > 0) {
    omp_set_num_threads(asked);
  } else if (std::getenv("OMP_NUM_THREADS") == nullptr) {
    if (const char* slurm = std::getenv("SLURM_CPUS_PER_TASK"))
      omp_set_num_threads(std::max(1, std::atoi(slurm)));
  }
}

std::filesystem::path results_folder(const RunRequest& request, const scene::Scene& scene) {
  if (!request.output_directory.empty()) return request.output_directory;
  if (!scene.output.directory.empty()) return scene.output.directory;
  return std::filesystem::path("results") / scene.name;
}

output::RunDirectory::Mode directory_mode(const RunRequest& request) {
  if (request.resume) return output::RunDirectory::Mode::resume;
  return request.force ? output::RunDirectory::Mode::force : output::RunDirectory::Mode::fresh;
}

/// Continues where that is asked for, or begins. A run that was ended before its first checkpoint
/// begins anew; results that cannot be continued are not thrown away for that.
void begin(Loop& loop, const RunRequest& request, const output::RunDirectory& directory,
           Progress& progress) {
  if (request.resume) {
    if (loop.resume()) return;
    const bool damaged = !output::list_checkpoints(directory.path()).empty();
    if (damaged || std::filesystem::exists(directory / "summary.json"))
      throw Error(ExitCode::file,
                  fmt::format("{}: {}, so the run in it cannot be continued. Replace it with "
                              "--force, or choose another folder with --out.",
                              directory.path().string(),
                              damaged ? "every checkpoint in the folder is damaged"
                                      : "the folder holds the results of a run but no checkpoint"));
    progress.message("no checkpoint to continue from: starting at the beginning");
  }
  loop.start(request.force || request.resume);
}

}  // namespace

RunResult run(const RunRequest& request, Progress& progress) {
  choose_threads(request.threads);
  scene::Problems problems;
  const scene::Scene scene = scene::read_scene(request.scene_path, request.overrides, problems);
  std::vector<coupling::OperatorEntry> operators;
  // Only a scene whose structure could be read has operators to look at; their mistakes are shown
  // with all others.
  operators = coupling::load_operators(
      scene, host::default_search_path(std::filesystem::path(request.scene_path).parent_path()),
      problems);
  problems.throw_if_any();
  PlannedRun planned = plan_run(scene, std::move(operators));

  const output::RunDirectory directory(results_folder(request, scene), directory_mode(request));
  install_stop_signals();
  Loop loop(scene, std::move(planned), directory, progress);
  begin(loop, request, directory, progress);

  RunResult result;
  result.directory = directory.path().string();
  const auto conclude = [&] {
    result.summary = loop.summary();
    output::write_summary(directory / "summary.json", result.summary);
  };
  try {
    loop.run();
  } catch (const Error&) {
    conclude();
    throw;
  }
  conclude();
  result.expectations_met = std::all_of(result.summary.expect.begin(), result.summary.expect.end(),
                                        [](const auto& e) { return e.passed; });
  return result;
}

}  // namespace pileus::model
