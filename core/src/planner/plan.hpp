// What a scene calls for: a verdict per effect with its reason, and what follows for the operators.
#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/operator_table.hpp"
#include "host/parameter_values.hpp"
#include "planner/rule_number.hpp"
#include "planner/rules.hpp"
#include "planner/survey.hpp"
#include "scene/scene.hpp"

namespace pileus::planner {

/// An operator the scene lists.
struct ListedOperator {
  std::string name;
  std::shared_ptr<const host::OperatorTable> table;
  const host::ParameterValues* values = nullptr;
};

/// Names of the effects it provides with its parameters.
std::vector<std::string> provided_by(const ListedOperator& op);

struct Fact {
  std::string name, unit;
  double value = 0;
  Evidence evidence = Evidence::exact;
  std::string source;  // file:line, or whose default it is
};

enum class Verdict { off, on, watch };
const char* word_of(Verdict verdict);

/// A change of one number of the scene that takes a rule to its threshold.
struct Flip {
  std::string what;
  double from = 0, to = 0;
};

struct EffectPlan {
  std::string effect, title;
  Verdict verdict = Verdict::on;
  Evidence evidence = Evidence::exact;
  std::string reason;                  // one sentence
  bool forced = false;                 // by the scene
  bool against_evidence = false;       // forced otherwise than the rules say
  bool stop_on_trip = false;           // when watched: stop instead of switching on
  bool silent = false;                 // nothing but that no operator provides it: not in tables
  std::vector<std::size_t> providers;  // positions in the list of operators
  std::vector<Fact> facts;             // what the rule looked at
  std::string remedy;                  // what to change where no number decides
  std::vector<Flip> flips;             // nearest first

  const Rule* rule = nullptr;           // into Plan::rules
  const RuleCase* rule_case = nullptr;  // that applied
  std::optional<double> number;
  std::shared_ptr<RuleNumber> formula;  // set with `number`

  bool has_number() const { return number.has_value(); }
};

struct OperatorPlan {
  std::string name, id, version;
  bool present = true;
  std::vector<std::string> on, watched, off;  // effects it provides
  bool leaves_out() const { return !watched.empty() || !off.empty(); }
};

/// What follows for memory and the mesh; filled in by whoever builds the run.
struct DataFlow {
  struct Stored {
    std::string name, units, by;
  };
  std::vector<Stored> stored;          // numbers of a parcel
  std::vector<Stored> items;           // numbers of each item of the parcels' lists
  std::vector<std::string> deposited;  // fields, per stage
  std::vector<std::string> transformed, recovered;
  int stages = 0;
  std::uint64_t parcels = 0;  // at the start
  double bytes_per_parcel = 0;
  std::optional<double> seconds_per_step;  // of one core, from measured costs
  std::string cost_source;                 // where they were measured, or how to
  std::optional<std::uint64_t> steps;      // known beforehand for a fixed time step
  // What would come on top if every effect of the listed operators were on.
  double bytes_left_out = 0;               // of each parcel
  std::optional<double> seconds_left_out;  // of one core per parcel and step, from measured costs
};

struct Plan {
  std::string scene, title;
  std::shared_ptr<const Rules> rules;
  std::vector<std::string> quantities;  // that formulas may name: height, then the carried ones
  std::vector<EffectPlan> effects;
  std::vector<OperatorPlan> operators;
  DataFlow flow;

  const EffectPlan* find(std::string_view effect) const;
};

/// Judges every effect that a rule, an operator or the scene names.
///
/// `bounds` are the extrema of the initial state (survey_initial_state).
/// Errors  Error(ExitCode::usage) for effects the scene names but nobody knows or provides
Plan make_plan(const scene::Scene& scene, const std::vector<ListedOperator>& operators,
               std::shared_ptr<const Rules> rules, const std::map<std::string, Extrema>& initial);

/// The smallest change of each number of the scene that takes an effect's rule to its threshold,
/// smallest relative change first; empty where no number decides.
std::vector<Flip> find_flips(const EffectPlan& effect, const std::vector<std::string>& quantities);

}  // namespace pileus::planner
