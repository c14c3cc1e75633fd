// What a parcel and step costs on this machine: measured, kept in a file, never guessed.
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "planner/plan.hpp"

namespace pileus::planner {

/// A measured cost and where it comes from.
struct Cost {
  double seconds = 0;  // of one core, per parcel and step
  std::string scene;   // with which it was measured
  std::string when;    // date
  std::string commit;  // of the program
};

/// Costs by part: "core 3 rk4" (everything but the operators) and operator ids with the effects
/// that were on.
class Costs {
 public:
  /// $XDG_CACHE_HOME/pileus/costs-HOST.json, else the same in ~/.cache; empty without a home.
  static std::filesystem::path default_path();
  /// Reads a file; an absent or damaged one has no costs.
  static Costs read(const std::filesystem::path& path);
  /// The file's content. The caller replaces the file.
  std::string text() const;

  void set(const std::string& part, Cost cost) { parts_[part] = std::move(cost); }
  const Cost* find(const std::string& part) const;

 private:
  std::map<std::string, Cost> parts_;
};

/// Name of the core's part for a scene.
std::string core_part(const scene::Scene& scene);
/// Name of an operator's part: its id and which of its effects are on, or all of them.
std::string operator_part(const OperatorPlan& op, bool everything = false);

/// Fills in the predicted time of a step, and what is saved by what was left out, where every part
/// has been measured; else says how to measure.
void predict_time(const scene::Scene& scene, const Costs& costs, Plan& plan);

}  // namespace pileus::planner
