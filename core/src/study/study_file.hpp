// A study as its YAML file describes it: what is varied, what is measured, what is known already.
#pragma once
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scene/document.hpp"
#include "scene/keys.hpp"

namespace pileus::study {

inline constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// One position of a knob.
struct Rung {
  std::string label;
  double number = not_a_number;  // its place on an axis and in orders; NaN: a word without one
  std::vector<scene::Setting> settings;
};

/// Something that trades accuracy for time: one key of the scene, or several that move together.
struct Knob {
  std::string name;
  std::vector<std::string> keys;
  std::vector<Rung> ladder;  // coarse to fine
  std::string axis;          // label of the axis; empty: the name
  scene::Location where;

  // as written, before they are put together
  std::string key;
  std::vector<scene::Node> values;
  std::vector<double> numbers;
  std::vector<std::string> labels;
};

/// How wrong a run is, as one number that is zero for a perfect one.
struct ErrorNorm {
  enum class Reference { value, finest };
  std::string name, title;
  // a diagnostic's statistic: |statistic − reference|
  std::string diagnostic, statistic = "final";
  std::optional<double> at, from;  // s
  Reference reference = Reference::value;
  double exact = 0;       // with Reference::value
  bool relative = false;  // divided by |reference|
  // a diagnostic over time against published data: r.m.s. difference over r.m.s. of the data
  std::string file, time_column = "time", column;
  // a gridded field at the end against the finest run's: r.m.s. difference over the r.m.s.
  // deviation of the finest from its mean; or the r.m.s. distance of its histogram
  std::string field;
  int bins = 0;  // 0: the field itself, not its histogram
  double low = 0, high = 0;
  std::vector<double> slopes;  // guides drawn beside the points
  scene::Location where;

  bool needs_finest() const { return !field.empty() || reference == Reference::finest; }
};

/// What another code or paper reaches.
struct PublishedPoint {
  std::string label, source;
  std::map<std::string, double> errors;   // by norm
  double cost = not_a_number;             // in the study's measure of cost
  std::map<std::string, double> numbers;  // by knob
  scene::Location where;
};

/// A bound that errors, or orders of convergence, of this study keep.
struct StudyExpectation {
  enum class Of { error, order };
  std::string norm;
  Of of = Of::error;
  std::string along;                          // order: the knob; empty: the first
  std::map<std::string, std::string> points;  // only where this knob stands at this label
  std::optional<double> low, high;
  std::string source;
  scene::Location where;
};

enum class Cost { core_time, wall_time, parcel_steps };

struct Study {
  enum class Experiment { scene, shape_integrators };
  enum class Combine { product, one_at_a_time };

  std::string path;  // of the file
  std::string name, title, description;
  Experiment experiment = Experiment::scene;
  std::string scene;  // path of the base scene, relative to the study file
  std::vector<scene::Setting> settings;
  std::vector<Knob> knobs;
  bool operator_knobs = false;
  Combine combine = Combine::product;
  std::vector<scene::Setting> finest;  // of the reference run; none: every knob at its last rung
  int repeats = 1, threads = 1;
  std::vector<std::uint64_t> seeds;
  std::vector<std::string> seed_keys;
  Cost cost = Cost::core_time;
  std::vector<ErrorNorm> errors;
  std::vector<PublishedPoint> published;
  std::vector<StudyExpectation> expect;

  /// Path of the base scene from the current folder.
  std::string scene_path() const;
  bool needs_finest() const;
};

/// The declared keys of a study file.
const scene::Table& study_table();

/// Reads a study; everything wrong with its own keys goes to `problems`. What depends on the scene
/// is checked where the points are laid out (points.hpp).
/// Throws Error(usage) when the file is missing, Error(file) when it cannot be read.
Study read_study(const std::string& path, scene::Problems& problems);

/// The JSON Schema of study files.
std::string study_schema();

/// "core time" and its unit "s".
struct CostWords {
  std::string name, unit;
};
CostWords words_of(const Study& study);

}  // namespace pileus::study
