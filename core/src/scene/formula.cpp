#include "scene/formula.hpp"

#include <fmt/format.h>
#include <muParser.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <regex>

#include "base/nearest_word.hpp"
#include "pileus/thermo.hpp"

namespace pileus::scene {
namespace {

double select(double condition, double yes, double no) {
  return condition != 0 ? yes : no;
}
double clip(double value, double low, double high) {
  return value < low ? low : (value > high ? high : value);
}
double heaviside(double value) {
  return value >= 0 ? 1 : 0;
}
double modulo(double a, double b) {
  return a - b * std::floor(a / b);
}
double round_down(double value) {
  return std::floor(value);
}
double round_up(double value) {
  return std::ceil(value);
}
/// Over liquid water, Pa; zero from the formula's pole at 29.65 K down.
double saturation_pressure(double kelvin) {
  return kelvin > 29.65 ? thermo::saturation_pressure(kelvin).value : 0.0;
}

void define_vocabulary(mu::Parser& parser) {
  // The classic locale whatever the environment says: "0.5" must stay a half.
  parser.ResetLocale();
  parser.DefineFun("if", select);
  parser.DefineFun("clip", clip);
  parser.DefineFun("step", heaviside);
  parser.DefineFun("mod", modulo);
  parser.DefineFun("floor", round_down);
  parser.DefineFun("ceil", round_up);
  parser.DefineFun("saturation_pressure", saturation_pressure);
  parser.DefineConst("pi", std::numbers::pi);
}

const std::vector<std::string>& function_names() {
  static const std::vector<std::string> names = [] {
    mu::Parser parser;
    define_vocabulary(parser);
    std::vector<std::string> all;
    for (const auto& entry : parser.GetFunDef()) all.push_back(entry.first);
    return all;
  }();
  return names;
}

/// The name at `position`, or an empty string.
std::string name_at(const std::string& text, std::size_t position) {
  std::size_t end = position;
  while (end < text.size() &&
         (std::isalnum(static_cast<unsigned char>(text[end])) != 0 || text[end] == '_'))
    ++end;
  return position < text.size() ? text.substr(position, end - position) : std::string();
}

/// muParser would take "a = 1" for an assignment.
std::size_t find_assignment(const std::string& text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '=') continue;
    const bool comparison =
        (i + 1 < text.size() && text[i + 1] == '=') ||
        (i > 0 && std::string_view("=<>!").find(text[i - 1]) != std::string_view::npos);
    if (!comparison) return i;
    if (i + 1 < text.size() && text[i + 1] == '=') ++i;
  }
  return std::string::npos;
}

FormulaProblem explain(const mu::ParserError& error, const std::string& text,
                       const std::vector<std::string>& names) {
  const auto position =
      std::min(static_cast<std::size_t>(std::max(0, int(error.GetPos()))), text.size());
  const std::string word = name_at(text, position);
  const bool is_name = !word.empty() && std::isdigit(static_cast<unsigned char>(word[0])) == 0;
  if (is_name && error.GetCode() == mu::ecUNASSIGNABLE_TOKEN) {
    const auto& functions = function_names();
    std::vector<std::string> known = names;
    known.insert(known.end(), functions.begin(), functions.end());
    known.emplace_back("pi");
    const std::string nearest = nearest_word(word, known);
    std::string list;
    for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
    return {fmt::format("unknown name '{}' in the formula; {}", word,
                        !nearest.empty() ? fmt::format("did you mean '{}'?", nearest)
                        : names.empty()  ? std::string("no constants are declared before it")
                                         : fmt::format("known are {}, pi and functions", list)),
            position};
  }
  // The place is shown under the formula; muParser's own count of it is left out.
  static const std::regex place("( found)? at (expression )?position [0-9]+");
  static const std::regex blank_in_quotes("\"([^\"]*[^\" ]) +\"");
  std::string message = std::regex_replace(error.GetMsg(), place, "");
  message = std::regex_replace(message, blank_in_quotes, "\"$1\"");
  std::replace(message.begin(), message.end(), '"', '\'');
  if (!message.empty() && message.back() == '.') message.pop_back();
  if (!message.empty()) message[0] = static_cast<char>(std::tolower(message[0]));
  return {fmt::format("formula error: {}", message), position};
}

}  // namespace

struct Formula::Compiled {
  std::string text;
  std::vector<std::string> variables;
  std::map<std::string, double> constants;
  std::vector<double> values;
  std::vector<bool> used;
  mu::Parser parser;

  Compiled(std::string formula, std::vector<std::string> names,
           const std::map<std::string, double>& fixed)
      : text(std::move(formula)),
        variables(std::move(names)),
        constants(fixed),
        values(variables.size(), 0.0),
        used(variables.size(), false) {
    if (text.find_first_not_of(" \t\r\n") == std::string::npos)
      throw FormulaProblem{"the formula is empty", 0};
    if (const std::size_t sign = find_assignment(text); sign != std::string::npos)
      throw FormulaProblem{"'=' assigns nothing in a formula; compare with '=='", sign};
    try {
      compile();
    } catch (const mu::ParserError& error) {
      std::vector<std::string> known = variables;
      for (const auto& constant : constants) known.push_back(constant.first);
      throw explain(error, text, known);
    }
  }

  void compile() {
    define_vocabulary(parser);
    for (const auto& [name, value] : constants) parser.DefineConst(name, value);
    for (std::size_t i = 0; i < variables.size(); ++i) parser.DefineVar(variables[i], &values[i]);
    // Line breaks are spaces, byte for byte, so that places stay right.
    std::string line = text;
    std::replace_if(
        line.begin(), line.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
    parser.SetExpr(line);
    // First evaluate, which refuses unknown names; asking for the variables would accept them.
    parser.Eval();
    const int results = parser.GetNumResults();
    if (results != 1)
      throw FormulaProblem{
          fmt::format("the formula has {} values separated by commas; one is wanted", results), 0};
    const auto& occurring = parser.GetUsedVar();
    for (std::size_t i = 0; i < variables.size(); ++i) used[i] = occurring.contains(variables[i]);
    parser.Eval();
  }
};

Formula::Formula(std::string text, std::vector<std::string> variables,
                 const std::map<std::string, double>& constants)
    : compiled_(std::make_unique<Compiled>(std::move(text), std::move(variables), constants)) {}
Formula::Formula(const Formula& other)
    : Formula(other.compiled_->text, other.compiled_->variables, other.compiled_->constants) {}
Formula::Formula(Formula&&) noexcept = default;
Formula& Formula::operator=(const Formula& other) {
  return *this = Formula(other);
}
Formula& Formula::operator=(Formula&&) noexcept = default;
Formula::~Formula() = default;

double Formula::operator()(const double* values) {
  std::copy_n(values, compiled_->values.size(), compiled_->values.data());
  return compiled_->parser.Eval();
}

bool Formula::uses(std::size_t variable) const {
  return compiled_->used[variable];
}
const std::string& Formula::text() const {
  return compiled_->text;
}

std::optional<FormulaProblem> check_formula(const std::string& text,
                                            const std::vector<std::string>& variables,
                                            const std::map<std::string, double>& constants) {
  try {
    const Formula formula(text, variables, constants);
    return std::nullopt;
  } catch (const FormulaProblem& problem) {
    return problem;
  }
}

bool is_free_name(std::string_view word) {
  if (word.empty() || std::isdigit(static_cast<unsigned char>(word[0])) != 0) return false;
  if (name_at(std::string(word), 0).size() != word.size()) return false;
  static constexpr std::array<std::string_view, 6> taken = {"x", "y", "z", "pi", "_pi", "_e"};
  if (std::find(taken.begin(), taken.end(), word) != taken.end()) return false;
  const auto& functions = function_names();
  return std::find(functions.begin(), functions.end(), word) == functions.end();
}

}  // namespace pileus::scene
