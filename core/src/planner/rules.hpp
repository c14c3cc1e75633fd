// The rules by which effects are judged: schemas/effects.yaml, whose head describes the form.
#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/scene.hpp"

namespace pileus::planner {

/// How firmly a statement stands.
enum class Evidence {
  exact,    // follows from the scene
  bound,    // a rigorous inequality
  estimate  // scale analysis
};
const char* word_of(Evidence evidence);

struct RuleFormula {
  std::string name, text;
  scene::Location where;
};

/// One case of a rule: when it applies and how it decides.
struct RuleCase {
  std::string when;                          // on an operator's parameters; empty: always
  std::vector<std::string> carried, absent;  // quantities of the parcels
  std::string potential_temperature;         // the one lowest_saturation_humidity is for
  bool always_off = false;                   // decides without a number
  Evidence evidence = Evidence::estimate;
  std::vector<RuleFormula> let;
  RuleFormula number;
  double threshold = 0;
  std::string quantity;  // what the number is
  std::string says;      // the reason, with {names}
  scene::Location where;
};

struct Rule {
  std::string effect, title, loss, source;
  bool always = false, keeps_extrema = false;
  std::vector<std::string> needs;     // effects it requires
  std::vector<std::string> fed_by;    // effects that alone bring about what it acts on
  std::vector<std::string> spreads;   // parameters that, unless zero, end `keeps_extrema`
  std::vector<std::string> shown_by;  // diagnostics
  std::vector<RuleCase> cases;
  scene::Location where;
};

struct Rules {
  std::vector<Rule> list;
  const Rule* find(std::string_view effect) const;
  /// Whether `effect` requires `other` or is fed by it, at once or through others.
  bool follows(std::string_view effect, std::string_view other) const;
};

/// Reads rules from YAML text; `file` names it in messages.
/// Errors  Error(ExitCode::usage) with every mistake, its line and column
Rules read_rules(const std::string& file, std::string_view text);

/// Adds the rules of a file that a plugin brings.
/// Errors  as read_rules, and for an effect that already has a rule; Error(ExitCode::file)
void add_rules_of_file(Rules& rules, const std::string& path);

/// schemas/effects.yaml as it was when the program was built.
Rules built_in_rules();
std::string_view built_in_rules_text();

}  // namespace pileus::planner
