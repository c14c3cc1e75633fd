// The points of a study: which settings are run, and along which curves they lie.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "study/study_file.hpp"

namespace pileus::study {

/// One simulation of a point: with one seed.
struct PlannedRun {
  std::optional<std::uint64_t> seed;
  std::vector<std::string> overrides;  // key=value, for `pileus run`
  std::string resolved;                // the scene as it is understood
  std::string key;                     // SHA-256 of the resolved scene and the program's version
};

struct Point {
  std::vector<int> rungs;  // per knob; −1: where the scene has it
  std::string label;       // "rk4, 0.2"
  std::vector<scene::Setting> settings;
  bool only_reference = false;  // run to be compared with, no point of the study
  std::vector<PlannedRun> runs;
};

/// Points that differ in one knob only, from coarse to fine.
struct KnobCurve {
  std::string label;  // of the other knobs; empty when there are none
  std::size_t knob = 0;
  std::vector<std::size_t> points;
};

struct Layout {
  std::vector<Knob> knobs;  // of the study, then of the operators
  std::vector<Point> points;
  std::vector<KnobCurve> curves;
  std::optional<std::size_t> finest;  // the point others are compared with, where errors need one
};

/// Lays a study out: fills in ladders that operators declare, forms the combinations and reads the
/// scene of every run. Mistakes go to `problems` with their place in the study.
/// Throws Error(plugin) for an operator's library that is missing or refused.
Layout lay_out(const Study& study, scene::Problems& problems);

}  // namespace pileus::study
