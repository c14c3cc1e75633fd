// The cheapest setting of a scene whose measured error meets a target.
#pragma once
#include <string>
#include <vector>

namespace pileus::study {

struct TargetRequest {
  std::string scene_path;
  std::string target;  // "1%", "0.01"
  std::string norm;
  std::string study;                   // findings to choose from; empty: those kept near the scene
  std::vector<std::string> overrides;  // of the user, key=value
};

struct Choice {
  std::vector<std::string> overrides;  // of the setting chosen
  std::string explanation;             // several lines: what was chosen and from which data
};

/// Chooses among the findings of studies of this very scene: those of `study` (a study.json, or the
/// folder it is in), else every studies/results/*.json in a folder above the scene's. An error over
/// several seeds counts by its highest. A study that changes the scene beyond its knobs and outputs
/// says nothing about the scene as it is and is left out.
///
/// Errors  Error(ExitCode::usage): nothing was measured, the scene has changed since, the norm is
///         not known (naming the nearest), no setting meets the target (naming the best), the
///         target is not a positive number, or an override changes what was measured
Choice choose_setting(const TargetRequest& request);

}  // namespace pileus::study
