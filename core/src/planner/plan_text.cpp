#include "planner/plan_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "base/wrap_text.hpp"
#include "scene/problems.hpp"

namespace pileus::planner {
namespace {

std::string upper(std::string word) {
  for (char& c : word) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return word;
}

std::string names_of(const std::vector<std::string>& names) {
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string effects_section(const Plan& plan) {
  constexpr std::size_t indent = 31;
  std::string text = fmt::format("\n  {:<21}{:<8}{}\n", "effect", "", "because");
  for (const EffectPlan& effect : plan.effects) {
    if (effect.silent) continue;
    text += fmt::format("  {:<20} {:<8}{}\n", effect.effect, upper(word_of(effect.verdict)),
                        wrap_text(reason_line(plan, effect), indent));
  }
  return text;
}

std::string operators_section(const Plan& plan) {
  if (plan.operators.empty()) return "\n  operators: none; the parcels are moved and deformed\n";
  std::string text = "\n  operators\n";
  for (const OperatorPlan& op : plan.operators) {
    std::vector<std::string> parts;
    if (!op.on.empty()) parts.push_back("for " + names_of(op.on));
    if (!op.watched.empty()) parts.push_back("watched: " + names_of(op.watched));
    if (!op.off.empty()) parts.push_back("without " + names_of(op.off));
    const std::string role = op.present ? fmt::format("{}", fmt::join(parts, "; "))
                                        : "left out: nothing it provides is called for";
    text += fmt::format("  {:<16} {}\n", op.name,
                        wrap_text(fmt::format("{} {}: {}", op.id, op.version, role), 19));
  }
  return text;
}

/// Time of the whole run where the number of steps is known.
std::string total_time(const DataFlow& flow) {
  if (!flow.steps) return {};
  return fmt::format(", {:.3g} s for {} steps",
                     *flow.seconds_per_step * static_cast<double>(*flow.steps), *flow.steps);
}

/// What each item of the parcels' lists carries, and how much memory that is.
std::string items_of(const DataFlow& flow) {
  std::vector<std::string> names;
  for (const auto& one : flow.items) names.push_back(one.name);
  return fmt::format("{} ({} B)", names_of(names), 8 * flow.items.size());
}

std::string saving_of(const DataFlow& flow) {
  const auto parcels = static_cast<double>(flow.parcels);
  return fmt::format("{:.0f} B per parcel, {:.3g} MB; {}", flow.bytes_left_out,
                     flow.bytes_left_out * parcels / 1e6,
                     flow.seconds_left_out ? fmt::format("{:.3g} s of one core per step",
                                                         *flow.seconds_left_out * parcels)
                                           : std::string("its time has not been measured"));
}

std::string flow_section(const Plan& plan) {
  const DataFlow& flow = plan.flow;
  std::vector<std::string> stored;
  for (const auto& one : flow.stored) stored.push_back(one.name);
  const auto line = [](const char* what, const std::string& content) {
    return fmt::format("  {:<16} {}\n", what, wrap_text(content, 19));
  };
  std::string text = "\n  data flow\n";
  text += line("stored", names_of(stored));
  if (!flow.items.empty()) text += line("per item", items_of(flow));
  text += line("deposited",
               names_of(flow.deposited) + fmt::format(", in each of {} stages", flow.stages));
  text += line("transformed", fmt::format("{}; from their spectra: {}", names_of(flow.transformed),
                                          names_of(flow.recovered)));
  text +=
      line("memory", fmt::format("{:.0f} B per parcel, {:.3g} parcels at the start: {:.3g} MB",
                                 flow.bytes_per_parcel, static_cast<double>(flow.parcels),
                                 flow.bytes_per_parcel * static_cast<double>(flow.parcels) / 1e6));
  if (flow.bytes_left_out > 0 || flow.seconds_left_out.value_or(0) > 0)
    text += line("left out", saving_of(flow));
  text +=
      line("predicted", flow.seconds_per_step ? fmt::format("{:.3g} s of one core per step{} ({})",
                                                            *flow.seconds_per_step,
                                                            total_time(flow), flow.cost_source)
                                              : "no time: " + flow.cost_source);
  return text;
}

std::string formula_lines(const EffectPlan& effect) {
  std::string text;
  const auto line = [&](const RuleFormula& f) {
    text += fmt::format("    {}\n      = {:.6g}\n",
                        wrap_text(fmt::format("{} = {}", f.name, f.text), 6),
                        effect.formula->value(f.name).value_or(0));
  };
  for (const RuleFormula& f : effect.rule_case->let) line(f);
  line(effect.rule_case->number);
  return text;
}

}  // namespace

std::string reason_line(const Plan& plan, const EffectPlan& effect) {
  std::string text = effect.reason;
  if (effect.verdict == Verdict::off && !effect.has_number() && !effect.forced)
    text += fmt::format(" ({})", word_of(effect.evidence));
  if (effect.verdict == Verdict::off) return text;
  std::vector<std::string> by;
  for (const std::size_t i : effect.providers)
    by.push_back(fmt::format("{} {}", plan.operators[i].id, plan.operators[i].version));
  if (!by.empty()) text += fmt::format("; provided by {}", fmt::join(by, ", "));
  if (effect.verdict == Verdict::watch)
    text += effect.stop_on_trip ? "; the run stops when that ceases to hold"
                                : "; switched on when that ceases to hold";
  return text;
}

std::string plan_page(const Plan& plan) {
  return fmt::format("{}{}\n", plan.scene, plan.title.empty() ? "" : ": " + plan.title) +
         effects_section(plan) + operators_section(plan) + flow_section(plan);
}

std::string explain_effect(const Plan& plan, const EffectPlan& effect) {
  std::string text =
      wrap_text(fmt::format("{} is {}: {}", effect.effect, upper(word_of(effect.verdict)),
                            reason_line(plan, effect)),
                2) +
      "\n";
  if (effect.rule != nullptr) {
    text += fmt::format("\n  rule ({})\n    {}\n", scene::describe(effect.rule->where),
                        effect.rule->title);
    if (!effect.rule->loss.empty())
      text += "    " + wrap_text("left out wrongly, a run lacks " + effect.rule->loss, 4) + "\n";
    if (!effect.rule->source.empty())
      text += "    " + wrap_text("because " + effect.rule->source, 4) + "\n";
  }
  if (effect.formula) {
    text += fmt::format("\n  number ({}, {})\n", scene::describe(effect.rule_case->where),
                        word_of(effect.evidence));
    text += formula_lines(effect);
    text += fmt::format(
        "    {}\n",
        wrap_text(fmt::format("{}: {:.6g}; called for above {:.6g}", effect.rule_case->quantity,
                              *effect.number, effect.rule_case->threshold),
                  4));
    text += "\n  facts\n";
    for (const Fact& fact : effect.facts)
      text += fmt::format("    {} = {:.6g}{}\n      {}: {}\n", fact.name, fact.value,
                          fact.unit == "1" || fact.unit.empty() ? "" : " " + fact.unit,
                          word_of(fact.evidence), fact.source);
  }
  text += "\n  what would change the verdict, the smallest change first\n";
  for (const Flip& flip : effect.flips)
    text += fmt::format("    {}: {:.6g} instead of {:.6g} ({:+.3g} %)\n", flip.what, flip.to,
                        flip.from, 100 * (flip.to / flip.from - 1));
  if (!effect.remedy.empty()) text += fmt::format("    {}\n", effect.remedy);
  if (effect.rule != nullptr && effect.rule->always) text += "    nothing\n";
  if (effect.flips.empty() && effect.remedy.empty() &&
      !(effect.rule != nullptr && effect.rule->always))
    text += fmt::format("    effects: {{{}: {}}}\n", effect.effect,
                        effect.verdict == Verdict::off ? "on" : "off");
  return text;
}

std::string compare_plans(const Plan& first, const Plan& second) {
  std::string text;
  const auto say = [&](const std::string& what, const std::string& a, const std::string& b) {
    if (a != b)
      text += fmt::format("  {}\n    - {}\n    + {}\n", what, wrap_text(a, 6), wrap_text(b, 6));
  };
  const auto describe = [](const Plan& plan, const std::string& name) {
    const EffectPlan* effect = plan.find(name);
    return effect == nullptr ? std::string("no such effect")
                             : upper(word_of(effect->verdict)) + "  " + reason_line(plan, *effect);
  };
  std::vector<std::string> names;
  for (const Plan* plan : {&first, &second})
    for (const EffectPlan& effect : plan->effects)
      if (std::find(names.begin(), names.end(), effect.effect) == names.end())
        names.push_back(effect.effect);
  for (const std::string& name : names) say(name, describe(first, name), describe(second, name));
  const auto stored = [](const Plan& plan) {
    std::vector<std::string> list;
    for (const auto& one : plan.flow.stored) list.push_back(one.name);
    return names_of(list);
  };
  say("stored", stored(first), stored(second));
  const auto memory = [](const Plan& plan) {
    return fmt::format("{:.0f} B per parcel, {} parcels at the start", plan.flow.bytes_per_parcel,
                       plan.flow.parcels);
  };
  say("memory", memory(first), memory(second));
  const std::string head = fmt::format("- {}\n+ {}\n", first.scene, second.scene);
  return text.empty() ? head + "  the plans are the same\n" : head + text;
}

}  // namespace pileus::planner
