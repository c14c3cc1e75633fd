#include "planner/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "base/error.hpp"
#include "base/nearest_word.hpp"
#include "base/quantities.hpp"
#include "planner/places.hpp"
#include "planner/requested.hpp"
#include "scene/problems.hpp"

namespace pileus::planner {
namespace {

bool provides(const ListedOperator& op, const std::string& effect) {
  for (std::size_t i = 0; i < op.table->effects.size(); ++i) {
    const pileus_effect& row = op.table->effects[i];
    if (row.role == PILEUS_PROVIDES && effect == row.name &&
        host::holds(op.table->effect_when[i], op.values->numbers()))
      return true;
  }
  return false;
}

/// Whether a row is a quantity of the parcels that `apply` changes.
bool is_written(const pileus_quantity& row) {
  return row.place == PILEUS_PARCEL && row.nature != PILEUS_DERIVED &&
         (row.access & (PILEUS_WRITE | PILEUS_CREATE | PILEUS_ADD)) != 0;
}

class Judge {
 public:
  Judge(const scene::Scene& scene, const std::vector<ListedOperator>& operators, const Rules& rules,
        const std::map<std::string, Extrema>& initial, Plan& plan)
      : scene_(scene), operators_(operators), rules_(rules), plan_(plan), places_(scene) {
    const auto vertical = static_cast<std::size_t>(scene.domain.dimension - 1);
    const double bottom = scene.domain.lower[vertical];
    extrema_.push_back(
        {bottom, bottom + scene.domain.extent[vertical], true, places_.of("domain.extent")});
    plan_.quantities = {"height"};
    for (const auto& [name, range] : initial) add_quantity(name, range);
    for (const ListedOperator& op : operators) add_owned(op);
  }

  /// The verdict the rules give, whatever the scene says.
  void judge(EffectPlan& effect) {
    effect.rule = rules_.find(effect.effect);
    effect.title = effect.rule != nullptr ? effect.rule->title : "";
    for (std::size_t i = 0; i < operators_.size(); ++i)
      if (provides(operators_[i], effect.effect)) effect.providers.push_back(i);
    decide(effect);
    if (!effect.providers.empty()) return;
    const bool wanted = effect.verdict != Verdict::off;
    effect.remedy =
        fmt::format("list an operator that provides '{}' (pileus plugins)", effect.effect);
    if (wanted) {
      effect.verdict = Verdict::off;
      effect.evidence = Evidence::exact;
      effect.reason = effect.number
                          ? "called for, but no operator of the scene provides it: " + effect.reason
                          : "no operator of the scene provides it";
    }
  }

 private:
  void add_quantity(const std::string& name, const Extrema& range) {
    plan_.quantities.push_back(name);
    extrema_.push_back(range);
  }

  /// What an operator owns and nobody sets starts at its declared value.
  void add_owned(const ListedOperator& op) {
    for (std::size_t i = 0; i < op.table->quantities.size(); ++i) {
      const pileus_quantity& row = op.table->quantities[i];
      const bool known = std::find(plan_.quantities.begin(), plan_.quantities.end(), row.name) !=
                         plan_.quantities.end();
      if (known || !is_written(row) || (row.access & PILEUS_CREATE) == 0 ||
          !host::holds(op.table->quantity_when[i], op.values->numbers()))
        continue;
      add_quantity(row.name, {row.initial, row.initial, true, {op.name, 0, 0}});
    }
  }

  void decide(EffectPlan& effect) {
    effect.verdict = Verdict::on;
    effect.evidence = Evidence::exact;
    const Rule* rule = effect.rule;
    if (rule == nullptr) {
      effect.reason = "the scene lists its operator, and no rule speaks of it";
      return;
    }
    if (rule->always) {
      effect.reason = "no run can be without it: " + rule->loss;
      return;
    }
    for (const std::string& need : rule->needs) {
      const EffectPlan* other = plan_.find(need);
      if (other == nullptr || other->verdict != Verdict::off) continue;
      effect.verdict = Verdict::off;
      effect.evidence = other->evidence;
      effect.reason = fmt::format("it needs {}, which is off", need);
      effect.remedy = fmt::format("switch {} on: {}: on under 'effects'", need, need);
      return;
    }
    if (is_fed(effect)) return;
    for (const RuleCase& c : rule->cases)
      if (applies(c, effect)) return apply(c, effect);
    const bool any_number = std::any_of(rule->cases.begin(), rule->cases.end(),
                                        [](const RuleCase& c) { return !c.always_off; });
    effect.reason = any_number ? "the scene lists its operator, and no case of its rule applies"
                               : "the scene lists its operator";
  }

  /// Whether an effect that is not off brings about what this one acts on: then it is on.
  bool is_fed(EffectPlan& effect) const {
    for (const std::string& feeder : effect.rule->fed_by) {
      const EffectPlan* other = plan_.find(feeder);
      if (other == nullptr || other->verdict == Verdict::off) continue;
      effect.reason = fmt::format("{} is {}", feeder, word_of(other->verdict));
      effect.remedy = fmt::format("switch {} off: {}: off under 'effects'", feeder, feeder);
      return true;
    }
    return false;
  }

  /// The operator whose parameters a case looks at, or null; `applies` when its condition holds.
  const ListedOperator* subject(const RuleCase& c, const EffectPlan& effect, bool& holds) const {
    const auto fits = [&](const ListedOperator& op) {
      const auto when = host::read_condition(c.when, *op.table);
      return when && host::holds(*when, op.values->numbers());
    };
    const ListedOperator* first =
        effect.providers.empty() ? nullptr : &operators_[effect.providers.front()];
    holds = c.when.empty();
    if (holds) return first;
    for (const ListedOperator& op : operators_) {
      if (first != nullptr && &op != first) continue;
      if (fits(op)) {
        holds = true;
        return &op;
      }
    }
    return nullptr;
  }

  int quantity(const std::string& name) const {
    const auto found = std::find(plan_.quantities.begin(), plan_.quantities.end(), name);
    return found == plan_.quantities.end() ? -1
                                           : static_cast<int>(found - plan_.quantities.begin());
  }

  bool applies(const RuleCase& c, const EffectPlan& effect) const {
    bool holds = false;
    const ListedOperator* op = subject(c, effect, holds);
    if (!c.potential_temperature.empty() &&
        (op == nullptr || !inputs_of(op->table.get(), op->values, {}, 0).saturation))
      return false;
    const auto carried = [&](const std::string& name) { return quantity(name) >= 0; };
    return holds && std::all_of(c.carried.begin(), c.carried.end(), carried) &&
           std::none_of(c.absent.begin(), c.absent.end(), carried);
  }

  void apply(const RuleCase& c, EffectPlan& effect) {
    effect.rule_case = &c;
    effect.evidence = c.evidence;
    if (c.always_off) {
      effect.verdict = Verdict::off;
      effect.reason = c.says;
      if (!c.absent.empty())
        effect.remedy = fmt::format("set {} in the initial state", scene::alternatives(c.absent));
      return;
    }
    bool holds = false;
    const ListedOperator* op = subject(c, effect, holds);
    RuleInputs inputs =
        inputs_of(op != nullptr ? op->table.get() : nullptr, op != nullptr ? op->values : nullptr,
                  plan_.quantities, scene_.time.end);
    effect.formula = std::make_shared<RuleNumber>(c, std::move(inputs));
    std::vector<double> extrema;
    for (const Extrema& e : extrema_) {
      extrema.push_back(e.low);
      extrema.push_back(e.high);
    }
    effect.number = (*effect.formula)(extrema.data());
    collect_facts(effect, op);
    const bool called = effect.formula->calls(*effect.number);
    effect.verdict = called                                  ? Verdict::on
                     : effect.evidence == Evidence::estimate ? Verdict::watch
                                                             : Verdict::off;
    effect.reason = fill_in(c.says, *effect.formula) +
                    fmt::format(" ({:.4g} {} {:.4g}, {})", *effect.number,
                                called ? ">" : "<=", c.threshold, word_of(effect.evidence));
    effect.flips = find_flips(effect, plan_.quantities);
  }

  /// The facts a number used. One that does not bound what comes later weakens the evidence.
  void collect_facts(EffectPlan& effect, const ListedOperator* op) {
    const RuleNumber& formula = *effect.formula;
    for (std::size_t i = 0; i < formula.input_count(); ++i) {
      if (!formula.uses(i)) continue;
      Fact fact;
      fact.name = formula.name(i);
      fact.value = formula.value(i);
      const std::size_t q = i / 2;
      if (q < plan_.quantities.size()) {
        describe_extremum(q, effect, fact);
        effect.evidence = std::max(effect.evidence, fact.evidence);
      } else {
        describe_parameter(op, fact);
      }
      effect.facts.push_back(std::move(fact));
    }
  }

  void describe_extremum(std::size_t q, const EffectPlan& effect, Fact& fact) const {
    const Extrema& range = extrema_[q];
    fact.source = scene::describe(range.where);
    if (q == 0) {
      fact.unit = "m";
      return;
    }
    const std::string& name = plan_.quantities[q];
    if (const Quantity* known = find_quantity(name)) fact.unit = std::string(known->units);
    fact.evidence = Evidence::bound;
    if (!range.exact) {
      fact.evidence = Evidence::estimate;
      fact.source += " (parcels are scattered at the start)";
    }
    for (const ListedOperator& op : operators_)
      if (may_take_beyond(op, name, effect)) {
        fact.evidence = Evidence::estimate;
        fact.source += fmt::format(" (operator '{}' changes it)", op.name);
      }
  }

  /// Whether an operator may take a quantity beyond its initial extrema although the effect is off.
  bool may_take_beyond(const ListedOperator& op, const std::string& name,
                       const EffectPlan& effect) const {
    const int row = op.table->find_quantity(name);
    if (row < 0) return false;
    const pileus_quantity& q = op.table->quantities[static_cast<std::size_t>(row)];
    if (q.nature == PILEUS_EXTENSIVE) return true;  // amounts add up when parcels merge
    if (!is_written(q) || is_left_out(op, row, effect)) return false;
    for (const std::string& other : provided_by(op)) {
      const Rule* rule = rules_.find(other);
      if (other == effect.effect || rules_.follows(other, effect.effect)) continue;
      if (rule != nullptr && (rule->always || keeps_extrema(*rule, op))) continue;
      const EffectPlan* judged = plan_.find(other);
      if (judged != nullptr && judged->verdict == Verdict::off) continue;
      return true;
    }
    return provided_by(op).empty();
  }

  /// Whether a row of an operator is not there while the effect that is judged is off.
  bool is_left_out(const ListedOperator& op, int row, const EffectPlan& effect) const {
    const host::When& when = op.table->quantity_when[static_cast<std::size_t>(row)];
    return std::any_of(when.begin(), when.end(), [&](const host::WhenTerm& term) {
      if (!term.is_effect) return !host::holds({term}, op.values->numbers());
      const std::string name = op.table->effects[term.index].name;
      const EffectPlan* judged = plan_.find(name);
      const bool off = name == effect.effect || rules_.follows(name, effect.effect) ||
                       (judged != nullptr && judged->verdict == Verdict::off);
      return off && term.equal;
    });
  }

  static bool keeps_extrema(const Rule& rule, const ListedOperator& op) {
    return rule.keeps_extrema &&
           std::none_of(rule.spreads.begin(), rule.spreads.end(), [&](const std::string& name) {
             const int index = op.table->find_parameter(name);
             return index >= 0 && !is_zero(op, index);
           });
  }

  static bool is_zero(const ListedOperator& op, int parameter) {
    const std::uint32_t type = op.table->parameters[static_cast<std::size_t>(parameter)].type;
    const bool function = type == PILEUS_PROFILE || type == PILEUS_SERIES;
    if (type != PILEUS_NUMBERS && !function) return op.values->numbers()[parameter] == 0;
    const std::vector<double>& list = op.values->list(parameter);
    for (std::size_t i = function ? 1 : 0; i < list.size(); i += function ? 2 : 1)
      if (list[i] != 0) return false;
    return true;
  }

  void describe_parameter(const ListedOperator* op, Fact& fact) const {
    if (fact.name == "duration") {
      fact.unit = "s";
      fact.source = scene::describe(places_.of("time.end"));
      return;
    }
    if (op == nullptr) return;
    const int index = op->table->find_parameter(fact.name);
    if (index >= 0) fact.unit = op->table->parameters[static_cast<std::size_t>(index)].units;
    fact.source = fmt::format("default of {}", op->table->op.id);
    const auto at = static_cast<std::size_t>(op - operators_.data());
    if (at >= scene_.operators.size()) return;
    for (const auto& [key, raw] : scene_.operators[at].parameters)
      if (key == fact.name) fact.source = scene::describe(raw.where);
  }

  static std::string fill_in(const std::string& text, const RuleNumber& formula) {
    std::string filled;
    for (std::size_t i = 0; i < text.size(); ++i) {
      const std::size_t end = text[i] == '{' ? text.find('}', i) : std::string::npos;
      const auto value = end == std::string::npos ? std::optional<double>()
                                                  : formula.value(text.substr(i + 1, end - i - 1));
      filled += value ? fmt::format("{:.4g}", *value) : std::string(1, text[i]);
      if (value) i = end;
    }
    return filled;
  }

  const scene::Scene& scene_;
  const std::vector<ListedOperator>& operators_;
  const Rules& rules_;
  Plan& plan_;
  Places places_;
  std::vector<Extrema> extrema_;  // of plan_.quantities
};

/// Whether an effect is not there because the scene lists no operator for it, and for no other
/// reason that the rules know.
bool has_nothing_to_say(const EffectPlan& effect) {
  return effect.providers.empty() && effect.rule_case == nullptr && effect.rule != nullptr &&
         effect.rule->needs.empty() && effect.rule->fed_by.empty();
}

/// Rules in their order, then what operators provide beside.
std::vector<std::string> known_effects(const Rules& rules,
                                       const std::vector<ListedOperator>& operators) {
  std::vector<std::string> names;
  for (const Rule& rule : rules.list) names.push_back(rule.effect);
  for (const ListedOperator& op : operators)
    for (const std::string& effect : provided_by(op))
      if (std::find(names.begin(), names.end(), effect) == names.end()) names.push_back(effect);
  return names;
}

void describe_operators(const std::vector<ListedOperator>& operators, Plan& plan) {
  plan.operators.clear();
  for (const ListedOperator& op : operators) {
    OperatorPlan entry{op.name, op.table->op.id, op.table->op.version, false, {}, {}, {}};
    for (const std::string& name : provided_by(op)) {
      const Verdict verdict = plan.find(name)->verdict;
      auto& list = verdict == Verdict::on      ? entry.on
                   : verdict == Verdict::watch ? entry.watched
                                               : entry.off;
      list.push_back(name);
    }
    entry.present = entry.off.empty() || !entry.on.empty() || !entry.watched.empty();
    plan.operators.push_back(std::move(entry));
  }
}

}  // namespace

std::vector<std::string> provided_by(const ListedOperator& op) {
  std::vector<std::string> names;
  for (const pileus_effect& row : op.table->effects)
    if (row.role == PILEUS_PROVIDES && provides(op, row.name)) names.emplace_back(row.name);
  return names;
}

const char* word_of(Verdict verdict) {
  return verdict == Verdict::on ? "on" : verdict == Verdict::off ? "off" : "watch";
}

const EffectPlan* Plan::find(std::string_view effect) const {
  const auto found = std::find_if(effects.begin(), effects.end(),
                                  [&](const EffectPlan& e) { return e.effect == effect; });
  return found == effects.end() ? nullptr : &*found;
}

Plan make_plan(const scene::Scene& scene, const std::vector<ListedOperator>& operators,
               std::shared_ptr<const Rules> rules, const std::map<std::string, Extrema>& initial) {
  Plan plan;
  plan.scene = scene.name;
  plan.title = scene.title;
  plan.rules = std::move(rules);
  const std::vector<std::string> names = known_effects(*plan.rules, operators);
  check_requests(scene.effects, names);
  Judge judge(scene, operators, *plan.rules, initial, plan);
  plan.effects.reserve(names.size());
  for (const std::string& name : names) {
    EffectPlan effect;
    effect.effect = name;
    judge.judge(effect);
    // Where nothing derives what no run can be without, the parcels carry it.
    if (effect.providers.empty() && effect.rule != nullptr && effect.rule->always) continue;
    call_for_requested_output(scene, operators, *plan.rules, effect);
    obey_request(scene.effects, plan, effect);
    effect.silent = has_nothing_to_say(effect);
    plan.effects.push_back(std::move(effect));
  }
  describe_operators(operators, plan);
  if (keep_inseparable(scene.effects, operators, plan)) describe_operators(operators, plan);
  return plan;
}

}  // namespace pileus::planner
