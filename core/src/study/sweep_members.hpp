// The members of a sweep: which settings each has, and what it simulates.
#pragma once
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "study/sweep_file.hpp"

namespace pileus::study {

/// Something that members differ in.
struct Parameter {
  std::string name;
  std::vector<std::string> keys;  // of the scene
  scene::Location where;
};

/// Where a member stands on a parameter.
struct ParameterValue {
  std::string text;              // as written; empty: as the scene has it
  double number = not_a_number;  // in `unit`; NaN: a word
  std::string unit;              // empty: a bare number
};

struct Member {
  std::size_t index = 0;
  std::vector<ParameterValue> values;  // by parameter
  std::optional<std::uint64_t> seed;
  std::string label;  // "beta 0.3, seed 2"
  std::vector<scene::Setting> settings;
  std::vector<std::string> overrides;  // the same as key=value, for `pileus run`
  std::string resolved;                // the scene as it is understood
  std::string key;                     // SHA-256 of the resolved scene and the program's version
  double series_every = 0, profiles_every = 0;  // s
};

struct Ensemble {
  Sweep sweep;
  std::vector<Parameter> parameters;
  std::vector<Member> members;  // the seed varies fastest, then the sample, the list, the product
};

/// How much of a sweep is looked at.
struct Scrutiny {
  bool plans = true;                // also what a run would refuse before its first step
  std::optional<std::size_t> only;  // the scene of this member alone; the others have no key
};

/// Reads a sweep and the scenes of its members. Mistakes go to `problems` with their place in the
/// sweep or the scene and the members that make them.
/// Throws Error(plugin) for an operator's library that is missing or refused.
Ensemble lay_out_members(const std::string& path, scene::Problems& problems,
                         const Scrutiny& scrutiny = {});

/// A parameter's values as numbers in one unit, that of the first value that has one.
struct NumberedParameter {
  std::string unit;             // empty: bare numbers
  std::vector<double> numbers;  // NaN where a member has the scene's own
};
/// Nothing when a value is a word.
std::optional<NumberedParameter> numbers_of(const Ensemble& ensemble, std::size_t parameter);

/// "0007".
std::string index_text(std::size_t index);

}  // namespace pileus::study
