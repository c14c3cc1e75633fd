#include "scene/value.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string_view>

#include "scene/formula.hpp"

namespace pileus::scene {
namespace {

std::string expected(const std::string& units, const std::string& text) {
  const DimensionName dimension = describe_dimension(units);
  return fmt::format("expected {} such as '{}', found '{}'", dimension.name, dimension.example,
                     text);
}

/// Digits with a needless zero in front: ten to a reader, eight to YAML 1.1.
bool looks_octal(std::string_view text) {
  if (!text.empty() && (text[0] == '-' || text[0] == '+')) text.remove_prefix(1);
  return text.size() > 1 && text[0] == '0' &&
         std::isdigit(static_cast<unsigned char>(text[1])) != 0;
}

NumberResult evaluate(const std::string& text, const Constants& constants) {
  try {
    Formula formula(text, {}, constants);
    const double value = formula(nullptr);
    if (!std::isfinite(value)) return {0, fmt::format("'{}' has no finite value", text), 0};
    return {value, {}, 0};
  } catch (const FormulaProblem& problem) {
    return {0, problem.text, problem.position};
  }
}

/// "4*pi m s-1": a formula, blanks, a unit.
NumberResult evaluate_with_unit(const std::string& text, const std::string& units,
                                const Constants& constants, Temperature kind) {
  const NumberResult whole = evaluate(text, constants);
  if (whole.ok()) return whole;
  for (std::size_t blank = text.find(' '); blank != std::string::npos;
       blank = text.find(' ', blank + 1)) {
    const std::string tail = text.substr(blank + 1);
    if (!is_unit(tail)) continue;
    const NumberResult head = evaluate(text.substr(0, blank), constants);
    if (!head.ok()) continue;
    const UnitConversion converted = convert_units(head.value, tail, units, kind);
    return {converted.value, converted.problem, converted.ok() ? 0 : blank + 1};
  }
  return whole;
}

}  // namespace

NumberResult read_number(const std::string& text, const std::string& units,
                         const Constants& constants, Temperature kind) {
  if (looks_octal(text))
    return {0,
            fmt::format("{}: leading zeros make an octal number in YAML; leave them out",
                        expected(units, text)),
            0};
  if (const auto written = split_quantity(text)) {
    if (written->unit.empty()) return {written->number, {}, 0};
    if (std::string_view("*/+-^(<>=?&|!").find(written->unit[0]) == std::string_view::npos) {
      const UnitConversion converted = convert_units(written->number, written->unit, units, kind);
      return {converted.value,
              converted.ok() ? "" : fmt::format("in '{}' {}", text, converted.problem), 0};
    }
  }
  NumberResult result = evaluate_with_unit(text, units, constants, kind);
  if (!result.ok()) result.problem = fmt::format("{}: {}", expected(units, text), result.problem);
  return result;
}

std::optional<std::int64_t> read_integer(const std::string& text) {
  if (looks_octal(text) || text.empty()) return std::nullopt;
  std::int64_t value = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (status != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<bool> read_switch(const std::string& text) {
  static constexpr std::array<std::string_view, 9> yes = {"true", "True", "TRUE", "yes", "Yes",
                                                          "YES",  "on",   "On",   "ON"};
  static constexpr std::array<std::string_view, 9> no = {"false", "False", "FALSE", "no", "No",
                                                         "NO",    "off",   "Off",   "OFF"};
  if (std::find(yes.begin(), yes.end(), text) != yes.end()) return true;
  if (std::find(no.begin(), no.end(), text) != no.end()) return false;
  return std::nullopt;
}

}  // namespace pileus::scene
