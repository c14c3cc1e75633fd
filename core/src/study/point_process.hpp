// One run of a study in a process of its own.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace pileus::study {

struct ProcessRequest {
  std::string scene_path;
  std::vector<std::string> overrides;  // key=value
  std::filesystem::path folder;        // of the results
  int threads = 1;
  bool resume = false;        // from a checkpoint in the folder
  std::filesystem::path log;  // what it writes; empty: `<folder>.log`
};

struct ProcessResult {
  int code = 0;       // as the process ended; 128 + number when a signal ended it
  std::string words;  // the last lines it wrote, for a failure
};

/// Share of the run that is done, 0 to 1, called a few times a second.
using Watcher = std::function<void(double share)>;

/// Runs a scene with `pileus run` in a process of its own and waits. What it writes goes to
/// its log. A stop that is requested meanwhile is passed on; the result is then what the
/// process makes of it (75). Throws Error(file) when no process can be started.
ProcessResult run_process(const ProcessRequest& request, const Watcher& watcher);

/// How one run is made; run_process() outside tests.
using PointRunner = std::function<ProcessResult(const ProcessRequest&, const Watcher&)>;

}  // namespace pileus::study
