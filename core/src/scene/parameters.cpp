#include "scene/parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "base/nearest_word.hpp"
#include "scene/tree.hpp"

namespace pileus::scene {
namespace {

/// Checks the values of one operator's block against its declarations.
class Checker {
 public:
  Checker(const OperatorBlock& block, const Constants& constants, Problems& problems)
      : block_(block), constants_(constants), problems_(problems) {}

  void report(const ParameterDeclaration& declared, const Location& where, const std::string& text,
              const std::string& value) {
    problems_.add(
        where, fmt::format("parameter '{}' of operator '{}': {}", declared.name, block_.name, text),
        std::max(1, character_count(value)));
  }

  bool number(const ParameterDeclaration& declared, const std::string& text, const Location& where,
              double& value) {
    const NumberResult result = read_number(text, declared.units, constants_);
    if (!result.ok()) {
      report(declared, where, result.problem, text);
      return false;
    }
    if (!in_range(declared, result.value, text, where)) return false;
    value = result.value;
    return true;
  }

  void integer(const ParameterDeclaration& declared, const RawValue& raw, double& value) {
    constexpr std::int64_t largest = std::int64_t{1} << 53;  // plugins get it as a double
    const auto whole = raw.is_list ? std::optional<std::int64_t>() : read_integer(raw.text);
    if (whole && (*whole > largest || *whole < -largest))
      report(declared, raw.where, fmt::format("expected at most 2^53, found {}", found(raw)),
             raw.text);
    else if (!whole)
      report(declared, raw.where, fmt::format("expected a whole number, found {}", found(raw)),
             raw.text);
    else if (in_range(declared, static_cast<double>(*whole), raw.text, raw.where))
      value = static_cast<double>(*whole);
  }

  void toggle(const ParameterDeclaration& declared, const RawValue& raw, double& value) {
    if (const auto state = raw.is_list ? std::optional<bool>() : read_switch(raw.text))
      value = *state ? 1 : 0;
    else
      report(declared, raw.where, fmt::format("expected 'true' or 'false', found {}", found(raw)),
             raw.text);
  }

  void choice(const ParameterDeclaration& declared, const RawValue& raw, double& value,
              std::string& word) {
    const auto& choices = declared.choices;
    const auto place = std::find(choices.begin(), choices.end(), raw.text);
    if (!raw.is_list && place != choices.end()) {
      value = static_cast<double>(place - choices.begin());
      word = raw.text;
      return;
    }
    const std::string nearest = raw.is_list ? std::string() : nearest_word(raw.text, choices);
    report(declared, raw.where,
           fmt::format("expected {}, found {}{}", alternatives(choices), found(raw),
                       nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest)),
           raw.text);
  }

  void numbers(const ParameterDeclaration& declared, const RawValue& raw,
               std::vector<double>& values) {
    const std::vector<std::string> items =
        raw.is_list ? raw.list : std::vector<std::string>{raw.text};
    std::vector<double> result(items.size(), declared.fallback);
    bool good = !items.empty();
    if (!good) report(declared, raw.where, "the list is empty", "");
    for (std::size_t i = 0; i < items.size(); ++i)
      good = number(declared, items[i], raw.where, result[i]) && good;
    if (good) values = std::move(result);
  }

  /// A function of height or time: one value, or columns of places and values.
  void function(const ParameterDeclaration& declared, const RawValue& raw,
                std::vector<double>& pairs) {
    if (raw.columns.empty()) {
      double value = declared.fallback;
      if (raw.is_list)
        report(declared, raw.where,
               fmt::format("expected a value or {}, found {}", columns_of(declared), found(raw)),
               "");
      else if (number(declared, raw.text, raw.where, value))
        pairs = {0.0, value};
      return;
    }
    const bool over_height = declared.type == ParameterType::profile;
    ParameterDeclaration places = declared;
    places.units = over_height ? "m" : "s";
    places.low = places.high = 0;
    std::vector<double> at, value;
    bool good = true;
    for (const auto& [name, texts] : raw.columns) {
      const bool is_value = name == "value";
      if (!is_value && name != (over_height ? "height" : "time")) {
        report(declared, raw.where,
               fmt::format("expected {}, found '{}'", columns_of(declared), name), "");
        good = false;
        continue;
      }
      std::vector<double>& column = is_value ? value : at;
      column.resize(texts.size());
      for (std::size_t i = 0; i < texts.size(); ++i)
        good = number(is_value ? declared : places, texts[i], raw.where, column[i]) && good;
    }
    if (good && fits(declared, raw, at, value)) {
      pairs.clear();
      for (std::size_t i = 0; i < at.size(); ++i) pairs.insert(pairs.end(), {at[i], value[i]});
    }
  }

  static std::string found(const RawValue& raw) {
    if (!raw.columns.empty()) return "a mapping";
    return raw.is_list ? fmt::format("a list of {}", raw.list.size())
                       : fmt::format("'{}'", raw.text);
  }

 private:
  static std::string columns_of(const ParameterDeclaration& declared) {
    return fmt::format("the lists '{}' and 'value'",
                       declared.type == ParameterType::profile ? "height" : "time");
  }

  bool fits(const ParameterDeclaration& declared, const RawValue& raw,
            const std::vector<double>& at, const std::vector<double>& value) {
    const auto ascends = [&] {
      for (std::size_t i = 1; i < at.size(); ++i)
        if (!(at[i] > at[i - 1])) return false;
      return true;
    };
    std::string problem;
    if (at.empty() || at.size() != value.size())
      problem = fmt::format("it needs {}, equally long: they have {} and {} entries",
                            columns_of(declared), at.size(), value.size());
    else if (!ascends())
      problem = fmt::format("its {} must ascend",
                            declared.type == ParameterType::profile ? "heights" : "times");
    if (!problem.empty()) report(declared, raw.where, problem, "");
    return problem.empty();
  }

  bool in_range(const ParameterDeclaration& declared, double value, const std::string& text,
                const Location& where) {
    if (declared.low == declared.high || (value >= declared.low && value <= declared.high))
      return true;
    report(declared, where,
           fmt::format("{} must be between {} and {}", with_units(value, declared.units),
                       shortest(declared.low), with_units(declared.high, declared.units)),
           text);
    return false;
  }

  const OperatorBlock& block_;
  const Constants& constants_;
  Problems& problems_;
};

bool is_function(const ParameterDeclaration& parameter) {
  return parameter.type == ParameterType::profile || parameter.type == ParameterType::series;
}

void set_defaults(std::span<const ParameterDeclaration> declared, ParameterValues& values) {
  for (const ParameterDeclaration& parameter : declared) {
    const bool is_choice = parameter.type == ParameterType::choice;
    values.number.push_back(is_choice ? 0 : parameter.fallback);
    values.text.push_back(is_choice && !parameter.choices.empty() ? parameter.choices.front()
                                                                  : parameter.text_fallback);
    values.list.emplace_back();
    if (parameter.type == ParameterType::numbers) values.list.back() = {parameter.fallback};
    if (is_function(parameter)) values.list.back() = {0.0, parameter.fallback};
    values.given.push_back(false);
  }
}

}  // namespace

ParameterValues validate_parameters(const OperatorBlock& block,
                                    std::span<const ParameterDeclaration> declared,
                                    const Constants& constants, Problems& problems) {
  ParameterValues values;
  set_defaults(declared, values);
  Checker checker(block, constants, problems);
  std::vector<std::string> names;
  for (const ParameterDeclaration& parameter : declared) names.push_back(parameter.name);
  for (const auto& [name, raw] : block.parameters) {
    if (name.starts_with("x-")) continue;
    const auto place = std::find(names.begin(), names.end(), name);
    if (place == names.end()) {
      const std::string nearest = nearest_word(name, names);
      problems.add(raw.key_where,
                   fmt::format("operator '{}' has no parameter '{}'; {}", block.name, name,
                               !nearest.empty() ? fmt::format("did you mean '{}'?", nearest)
                               : names.empty()  ? std::string("it has none")
                                                : "it has " + alternatives(names)),
                   character_count(name));
      continue;
    }
    const auto i = static_cast<std::size_t>(place - names.begin());
    const ParameterDeclaration& parameter = declared[i];
    values.given[i] = true;
    if (is_function(parameter))
      checker.function(parameter, raw, values.list[i]);
    else if (!raw.columns.empty())
      checker.report(parameter, raw.where, "expected a value, found a mapping", "");
    else if (parameter.type == ParameterType::integer)
      checker.integer(parameter, raw, values.number[i]);
    else if (parameter.type == ParameterType::toggle)
      checker.toggle(parameter, raw, values.number[i]);
    else if (parameter.type == ParameterType::choice)
      checker.choice(parameter, raw, values.number[i], values.text[i]);
    else if (parameter.type == ParameterType::numbers)
      checker.numbers(parameter, raw, values.list[i]);
    else if (raw.is_list)
      checker.report(parameter, raw.where,
                     fmt::format("expected one value, found {}", Checker::found(raw)), "");
    else if (parameter.type == ParameterType::text)
      values.text[i] = raw.text;
    else
      checker.number(parameter, raw.text, raw.where, values.number[i]);
  }
  for (const auto& [name, raw] : block.parameters) {
    const auto place = std::find(names.begin(), names.end(), name);
    if (place == names.end()) continue;
    const auto& condition = declared[static_cast<std::size_t>(place - names.begin())].when;
    if (!condition_holds(condition, declared, values))
      problems.add(raw.key_where,
                   fmt::format("parameter '{}' of operator '{}' means something only when {}", name,
                               block.name, condition),
                   character_count(name));
  }
  return values;
}

bool condition_holds(const std::string& condition, std::span<const ParameterDeclaration> declared,
                     const ParameterValues& values) {
  std::istringstream words(condition);
  std::string name, comparison, literal, joint;
  while (words >> name >> comparison >> literal) {
    const auto parameter =
        std::find_if(declared.begin(), declared.end(),
                     [&](const ParameterDeclaration& other) { return other.name == name; });
    if (parameter == declared.end()) return false;
    const auto i = static_cast<std::size_t>(parameter - declared.begin());
    bool equal = false;
    if (parameter->type == ParameterType::choice || parameter->type == ParameterType::text)
      equal = values.text[i] == literal;
    else if (parameter->type == ParameterType::toggle)
      equal = read_switch(literal) == (values.number[i] != 0);
    else if (const auto number = split_quantity(literal))
      equal = number->number == values.number[i];
    if (equal != (comparison == "==")) return false;
    words >> joint;
  }
  return true;
}

}  // namespace pileus::scene
