// Scenes as tests: run them and judge what they expect of themselves.
#pragma once
#include <filesystem>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "base/progress.hpp"
#include "model/run.hpp"
#include "output/summary.hpp"

namespace pileus::study {

/// The scene files that a path of the command line stands for:
/// a file: itself;
/// a folder with <folder>_small.yaml: that; else with <folder>.yaml: that;
/// a folder of other YAML files: all of them; a folder of such folders: theirs.
/// Throws Error(usage) when there is no such path or no scene in it.
std::vector<std::filesystem::path> scenes_of(const std::filesystem::path& path);

struct CheckRequest {
  std::vector<std::string> paths;      // files and folders, see scenes_of
  std::vector<std::string> overrides;  // key=value, for every scene
  std::string results_directory;       // one folder per scene below it; empty: a temporary one
  int threads = 0;                     // 0: as many as there are cores
  bool all_bounds = false;             // list them all also for folders of several scenes
};

struct CheckedScene {
  std::filesystem::path scene;
  std::string directory;  // of its results
  std::vector<output::ExpectSummary> expectations;
  double seconds = 0;              // wall time
  ExitCode code = ExitCode::done;  // numerical when a bound was missed or nothing was expected
  std::string failure;             // why there are no expectations to list
  bool passed() const { return code == ExitCode::done; }
};

struct CheckResult {
  std::vector<CheckedScene> scenes;
  /// done when every scene passed, else the code of the first that did not.
  ExitCode code() const;
};

/// How a scene is run; the model's run() outside tests.
using Runner = std::function<model::RunResult(const model::RunRequest&, Progress&)>;

/// Runs the scenes one after another and writes to `out`, as each is done, a line per scene and
/// per expectation, and a total at the end. Of the scenes of a folder that stands for several, only
/// the expectations that were missed are listed. A scene that fails does not stop those after it.
/// A temporary results folder is removed when everything passed and named when not.
CheckResult check(const CheckRequest& request, Progress& progress, std::ostream& out,
                  const Runner& run = model::run);

}  // namespace pileus::study
