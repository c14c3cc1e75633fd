#include "planner/rules.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "base/error.hpp"
#include "base/nearest_word.hpp"
#include "scene/document.hpp"
#include "scene/value.hpp"

namespace pileus::planner {
namespace {

using scene::Entry;
using scene::Node;
using scene::Problems;

/// Reads one entry of the file; complaints carry its place.
class RuleReader {
 public:
  explicit RuleReader(Problems& problems) : problems_(problems) {}

  Rule rule(const Entry& entry) {
    Rule rule;
    rule.effect = entry.key;
    rule.where = entry.where;
    if (!is_mapping(entry.value)) return rule;
    for (const Entry& e : entry.value.entries) {
      if (e.key == "title") {
        rule.title = text(e);
      } else if (e.key == "loss") {
        rule.loss = text(e);
      } else if (e.key == "source") {
        rule.source = text(e);
      } else if (e.key == "always") {
        rule.always = toggle(e);
      } else if (e.key == "keeps_extrema") {
        rule.keeps_extrema = toggle(e);
      } else if (e.key == "keeps_extrema_unless") {
        rule.keeps_extrema = true;
        rule.spreads = texts(e);
      } else if (e.key == "requires") {
        rule.needs = texts(e);
      } else if (e.key == "fed_by") {
        rule.fed_by = texts(e);
      } else if (e.key == "shown_by") {
        rule.shown_by = texts(e);
      } else if (e.key == "cases") {
        for (const Node& item : e.value.items) rule.cases.push_back(one_case(item));
      } else {
        unknown(e, {"title", "loss", "source", "always", "keeps_extrema", "keeps_extrema_unless",
                    "requires", "fed_by", "shown_by", "cases"});
      }
    }
    if (rule.title.empty()) problems_.add(rule.where, "the rule has no 'title'");
    return rule;
  }

 private:
  RuleCase one_case(const Node& node) {
    RuleCase found;
    found.where = node.where;
    if (!is_mapping(node)) return found;
    for (const Entry& e : node.entries) read_case_entry(e, found);
    if (found.always_off == !found.number.text.empty())
      problems_.add(node.where, "a case decides by 'verdict: off' or by a 'number'");
    if (!found.number.text.empty() && node.find("threshold") == nullptr)
      problems_.add(node.where, "the case has a 'number' but no 'threshold'");
    if (node.find("evidence") == nullptr) problems_.add(node.where, "the case has no 'evidence'");
    if (found.always_off) found.evidence = Evidence::exact;
    if (found.says.empty()) problems_.add(node.where, "the case has no reason ('says')");
    return found;
  }

  void read_case_entry(const Entry& e, RuleCase& found) {
    if (e.key == "when") {
      found.when = text(e);
    } else if (e.key == "carried") {
      found.carried = texts(e);
    } else if (e.key == "absent") {
      found.absent = texts(e);
    } else if (e.key == "potential_temperature") {
      found.potential_temperature = text(e);
    } else if (e.key == "verdict") {
      found.always_off = choice(e, {"off"}) == 0;
    } else if (e.key == "evidence") {
      found.evidence =
          static_cast<Evidence>(std::max(0, choice(e, {"exact", "bound", "estimate"})));
    } else if (e.key == "let") {
      if (is_mapping(e.value))
        for (const Entry& l : e.value.entries) found.let.push_back({l.key, text(l), l.value.where});
    } else if (e.key == "number") {
      found.number = {"number", text(e), e.value.where};
    } else if (e.key == "threshold") {
      const scene::NumberResult number = scene::read_number(text(e), "1", {});
      if (!number.ok()) problems_.add(e.value.where, number.problem, e.value.width());
      found.threshold = number.value;
    } else if (e.key == "quantity") {
      found.quantity = text(e);
    } else if (e.key == "says") {
      found.says = text(e);
    } else {
      unknown(e, {"when", "carried", "absent", "potential_temperature", "verdict", "evidence",
                  "let", "number", "threshold", "quantity", "says"});
    }
  }

  void unknown(const Entry& e, const std::vector<std::string>& known) {
    const std::string nearest = nearest_word(e.key, known);
    problems_.add(e.where,
                  fmt::format("unknown key '{}' of a rule{}", e.key,
                              nearest.empty() ? "; known are " + scene::alternatives(known)
                                              : "; did you mean '" + nearest + "'?"),
                  static_cast<int>(e.key.size()));
  }
  bool is_mapping(const Node& node) {
    if (node.kind == Node::Kind::mapping) return true;
    problems_.add(node.where, "expected keys and values, found " + scene::describe(node));
    return false;
  }
  std::string text(const Entry& e) {
    if (e.value.kind == Node::Kind::scalar && !e.value.text.empty()) return e.value.text;
    problems_.add(e.value.where,
                  fmt::format("'{}' is a text, found {}", e.key, scene::describe(e.value)));
    return {};
  }
  std::vector<std::string> texts(const Entry& e) {
    std::vector<std::string> all;
    for (const Node& item : e.value.items) all.push_back(item.text);
    if (e.value.kind != Node::Kind::list)
      problems_.add(e.value.where,
                    fmt::format("'{}' is a list, found {}", e.key, scene::describe(e.value)));
    return all;
  }
  bool toggle(const Entry& e) { return choice(e, {"no", "yes"}) == 1; }
  int choice(const Entry& e, const std::vector<std::string>& words) {
    const auto found = std::find(words.begin(), words.end(), e.value.text);
    if (found != words.end()) return static_cast<int>(found - words.begin());
    problems_.add(e.value.where,
                  fmt::format("'{}' is {}, found {}", e.key, scene::alternatives(words),
                              scene::describe(e.value)),
                  e.value.width());
    return -1;
  }

  Problems& problems_;
};

}  // namespace

const char* word_of(Evidence evidence) {
  switch (evidence) {
    case Evidence::exact:
      return "exact";
    case Evidence::bound:
      return "bound";
    case Evidence::estimate:
      return "estimate";
  }
  return "";
}

const Rule* Rules::find(std::string_view effect) const {
  const auto found =
      std::find_if(list.begin(), list.end(), [&](const Rule& r) { return r.effect == effect; });
  return found == list.end() ? nullptr : &*found;
}

bool Rules::follows(std::string_view effect, std::string_view other) const {
  const Rule* rule = find(effect);
  if (rule == nullptr) return false;
  const auto leads_back = [&](const std::string& name) {
    const Rule* before = find(name);  // rules stand after those they name, which ends the search
    return name == other || (before != nullptr && before < rule && follows(name, other));
  };
  return std::any_of(rule->needs.begin(), rule->needs.end(), leads_back) ||
         std::any_of(rule->fed_by.begin(), rule->fed_by.end(), leads_back);
}

Rules read_rules(const std::string& file, std::string_view text) {
  Problems problems;
  const Node root = scene::parse_document(file, text, problems);
  Rules rules;
  RuleReader reader(problems);
  for (const Entry& entry : root.entries) rules.list.push_back(reader.rule(entry));
  problems.throw_if_any();
  return rules;
}

void add_rules_of_file(Rules& rules, const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream.is_open() || stream.bad())
    throw Error(ExitCode::file, fmt::format("The rules '{}' cannot be read.", path));
  for (Rule& rule : read_rules(path, text).list) {
    if (rules.find(rule.effect) != nullptr)
      throw Error(ExitCode::usage,
                  fmt::format("{}: error: the effect '{}' already has a rule; give it another name",
                              scene::describe(rule.where), rule.effect));
    rules.list.push_back(std::move(rule));
  }
}

Rules built_in_rules() {
  return read_rules("schemas/effects.yaml", built_in_rules_text());
}

}  // namespace pileus::planner
