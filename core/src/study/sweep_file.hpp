// A sweep as its YAML file describes it: one scene with many settings, each run a member.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "study/study_file.hpp"
#include "study/sweep_sample.hpp"

namespace pileus::study {

/// One entry of `list`: settings of a member, as written.
struct ListedSettings {
  std::vector<scene::Setting> settings;
  scene::Location where;
};

/// A key of the scene that is sampled between two values.
struct SampleRange {
  enum class Scale { linear, log };
  std::string name, key;
  scene::Node low_text, high_text;  // as written
  double low = 0, high = 0;         // both in `unit`
  std::string unit;                 // that of `low`; empty: bare numbers
  Scale scale = Scale::linear;
  bool whole = false;  // whole numbers only
  scene::Location where;

  /// The value at a place of the unit interval, as a setting has it. Ten digits are kept, so that
  /// machines whose logarithms differ in the last bit have the same members.
  std::string value_at(double place) const;
};

struct SamplePlan {
  SampleMethod method = SampleMethod::latin_hypercube;
  int count = 0;
  std::uint64_t seed = 0;
  std::vector<SampleRange> ranges;
};

struct Sweep {
  std::string path;  // of the file
  std::string name, title, description;
  std::string scene;  // path of the scene, relative to the sweep
  std::vector<scene::Setting> settings;
  std::vector<Knob> product;
  std::vector<ListedSettings> list;
  SamplePlan sample;
  std::vector<std::uint64_t> seeds;
  std::vector<std::string> seed_keys;
  scene::Location seeds_where;  // of seed_keys, or of the seeds where there are none
  int threads = 1;
  std::vector<std::string> pictures;
  std::vector<std::string> slurm;

  /// Path of the scene from the current folder.
  std::string scene_path() const;
};

/// The declared keys of a sweep file.
const scene::Table& sweep_table();

/// Reads a sweep; everything wrong with its own keys goes to `problems`. What depends on the scene
/// is checked where the members are laid out (sweep_members.hpp).
/// Throws Error(usage) when the file is missing, Error(file) when it cannot be read.
Sweep read_sweep(const std::string& path, scene::Problems& problems);

/// The JSON Schema of sweep files.
std::string sweep_schema();

}  // namespace pileus::study
