#include "planner/requested.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "base/error.hpp"
#include "base/nearest_word.hpp"
#include "scene/problems.hpp"

namespace pileus::planner {
namespace {

/// A name the scene wants to see, and where it says so.
struct Wanted {
  std::string name, where;
};

std::vector<Wanted> wanted_names(const scene::Scene& scene) {
  std::vector<Wanted> names;
  const auto add = [&](const std::string& name, const std::string& where) {
    names.push_back({name, where});
  };
  const auto stream = [&](const scene::OutputStream& output, const char* where) {
    for (const std::string& name : output.variables) add(name, where);
  };
  stream(scene.output.fields, "output.fields");
  stream(scene.output.parcels, "output.parcels");
  stream(scene.output.profiles, "output.profiles");
  stream(scene.output.series, "output.series");
  const scene::DiagnosticControl& d = scene.diagnostics;
  for (const auto& one : d.exact) add(one.variable, scene::describe(one.where));
  for (const auto& one : d.modes) add(one.variable, scene::describe(one.where));
  for (const auto& one : d.fronts) add(one.variable, scene::describe(one.where));
  for (const auto& one : d.mirrors) add(one.variable, scene::describe(one.where));
  for (const auto& one : d.histograms) add(one.variable, scene::describe(one.where));
  for (const auto& one : d.variance_budgets) add(one.variable, scene::describe(one.where));
  for (const auto& one : scene.expect) add(one.diagnostic, scene::describe(one.where));
  return names;
}

/// Quantities that exist only where an effect is on: those whose `when` asks for it, and all that
/// an operator owns, or adds up on the ground, which provides nothing else.
std::vector<std::string> quantities_of(const ListedOperator& op, const std::string& effect) {
  std::vector<std::string> names;
  bool alone = true;
  for (const pileus_effect& row : op.table->effects)
    alone = alone && (row.role != PILEUS_PROVIDES || effect == row.name);
  for (std::size_t i = 0; i < op.table->quantities.size(); ++i) {
    const pileus_quantity& row = op.table->quantities[i];
    const bool on_the_ground = row.place == PILEUS_SURFACE && (row.access & PILEUS_ADD) != 0;
    bool gated = alone && (on_the_ground || (row.access & PILEUS_CREATE) != 0);
    for (const host::WhenTerm& term : op.table->quantity_when[i])
      gated = gated || (term.is_effect && effect == op.table->effects[term.index].name);
    if (gated) names.emplace_back(row.name);
  }
  return names;
}

/// Names that show an effect, or one that cannot happen without it.
std::vector<std::string> names_showing(const std::vector<ListedOperator>& operators,
                                       const Rules& rules, const std::string& effect) {
  std::vector<std::string> shows;
  for (const ListedOperator& op : operators)
    for (const std::string& provided : provided_by(op)) {
      if (provided != effect && !rules.follows(provided, effect)) continue;
      if (const Rule* rule = rules.find(provided))
        shows.insert(shows.end(), rule->shown_by.begin(), rule->shown_by.end());
      for (const std::string& quantity : quantities_of(op, provided)) {
        shows.push_back(quantity);
        for (const char* start : {"mean_", "min_", "max_"}) shows.push_back(start + quantity);
      }
    }
  return shows;
}

/// Whether an operator can be run without an effect it provides: it has quantities that exist only
/// with it.
bool can_leave_out(const ListedOperator& op, const std::string& effect) {
  for (const host::When& when : op.table->quantity_when)
    for (const host::WhenTerm& term : when)
      if (term.is_effect && effect == op.table->effects[term.index].name) return true;
  return false;
}

}  // namespace

void check_requests(const scene::EffectRequests& requests, const std::vector<std::string>& known) {
  for (const auto& request : requests.requests) {
    if (std::find(known.begin(), known.end(), request.name) != known.end()) continue;
    const std::string nearest = nearest_word(request.name, known);
    throw Error(ExitCode::usage,
                fmt::format("{}: error: unknown effect '{}'; {}", scene::describe(request.where),
                            request.name,
                            nearest.empty() ? "known are " + scene::alternatives(known)
                                            : "did you mean '" + nearest + "'?"));
  }
}

void call_for_requested_output(const scene::Scene& scene,
                               const std::vector<ListedOperator>& operators, const Rules& rules,
                               EffectPlan& effect) {
  if (effect.verdict == Verdict::on || effect.providers.empty()) return;
  const std::vector<std::string> shows = names_showing(operators, rules, effect.effect);
  for (const Wanted& wanted : wanted_names(scene)) {
    if (std::find(shows.begin(), shows.end(), wanted.name) == shows.end()) continue;
    effect.verdict = Verdict::on;
    effect.reason = fmt::format("the scene asks for {} ({}), though {}", wanted.name, wanted.where,
                                effect.reason);
    effect.evidence = Evidence::exact;
    return;
  }
}

namespace {

/// An effect without which a demanded one cannot happen, and which is off.
const EffectPlan* missing_need(const Plan& plan, const EffectPlan& effect) {
  if (effect.rule == nullptr) return nullptr;
  for (const std::string& need : effect.rule->needs) {
    const EffectPlan* other = plan.find(need);
    if (other != nullptr && other->verdict == Verdict::off) return other;
  }
  return nullptr;
}

}  // namespace

void obey_request(const scene::EffectRequests& requests, const Plan& plan, EffectPlan& effect) {
  using Mode = scene::EffectRequests::Mode;
  const auto found =
      std::find_if(requests.requests.begin(), requests.requests.end(),
                   [&](const auto& request) { return request.name == effect.effect; });
  const bool named = found != requests.requests.end();
  const bool exclusive = requests.form == scene::EffectRequests::Form::list;
  if (!named && !(exclusive && !effect.providers.empty())) return;
  if (effect.rule != nullptr && effect.rule->always) return;
  const Mode mode = named ? found->mode : Mode::off;
  if (mode != Mode::off && effect.providers.empty())
    throw Error(
        ExitCode::usage,
        fmt::format("{}: error: no operator of the scene provides the effect '{}'; list one "
                    "under 'operators' ('pileus plugins' shows what is installed)",
                    scene::describe(found->where), effect.effect));
  if (mode == Mode::watch && !effect.formula)
    throw Error(
        ExitCode::usage,
        fmt::format("{}: error: nothing is known by which '{}' could be watched: {}; say on "
                    "or off",
                    scene::describe(found->where), effect.effect, effect.reason));
  if (const EffectPlan* need = mode == Mode::off ? nullptr : missing_need(plan, effect))
    throw Error(ExitCode::usage,
                fmt::format("{}: error: '{}' needs '{}', which is off ({}); demand it as well, or "
                            "leave '{}' to the rules",
                            scene::describe(found->where), effect.effect, need->effect,
                            need->reason, effect.effect));
  const Verdict verdict = mode == Mode::on      ? Verdict::on
                          : mode == Mode::watch ? Verdict::watch
                                                : Verdict::off;
  if (named) effect.stop_on_trip = found->stop_on_trip;
  if (verdict == effect.verdict) return;
  effect.against_evidence = verdict == Verdict::off;
  effect.reason = fmt::format("demanded by the scene{}; the rules say {}: {}",
                              named ? " (" + scene::describe(found->where) + ")" : "",
                              word_of(effect.verdict), effect.reason);
  effect.verdict = verdict;
  effect.forced = true;
}

bool keep_inseparable(const scene::EffectRequests& requests,
                      const std::vector<ListedOperator>& operators, Plan& plan) {
  bool any = false;
  for (EffectPlan& effect : plan.effects) {
    for (const std::size_t i : effect.providers) {
      const OperatorPlan& op = plan.operators[i];
      if (!effect.forced || effect.verdict != Verdict::off || !op.present ||
          can_leave_out(operators[i], effect.effect))
        continue;
      std::vector<std::string> others = op.on;
      others.insert(others.end(), op.watched.begin(), op.watched.end());
      const std::string reason = fmt::format("operator '{}' ({}) cannot leave it out without {}",
                                             op.name, op.id, fmt::join(others, ", "));
      for (const auto& request : requests.requests)
        if (request.name == effect.effect)
          throw Error(ExitCode::usage,
                      fmt::format("{}: error: '{}' cannot be off here: {}",
                                  scene::describe(request.where), effect.effect, reason));
      effect.verdict = Verdict::on;
      effect.forced = effect.against_evidence = false;
      effect.reason = reason;
      any = true;
    }
  }
  return any;
}

}  // namespace pileus::planner
