#include "host/operator_table.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <set>

#include "host/enum_names.hpp"
#include "host/row_rules.hpp"

namespace pileus::host {
namespace {

/// Keys of an operator's block in a scene that are not the plugin's.
constexpr std::array<std::string_view, 6> reserved_names = {"use",   "name",     "substeps",
                                                            "every", "on_error", "guard"};

/// Up to here every whole number is a double.
constexpr double largest_integer = 0x1p53;

void check_identity(const OperatorTable& t, Complaints& c) {
  const pileus_operator& op = t.op;
  c.require(is_reverse_dns(c.text(op.id, "id")), "id",
            "is not lower-case reverse DNS such as org.example.scheme");
  c.text(op.kind, "kind");
  c.require(is_semantic_version(c.text(op.version, "version")), "version",
            "is not a semantic version such as 1.0.0");
  c.text(op.title, "title");
  c.text(op.summary, "summary");
  c.text(op.authors, "authors");
  c.text(op.licence, "licence");
  c.require(words::repeatability.knows(op.repeatability), "repeatability",
            "has the unknown value " + std::to_string(op.repeatability));
  c.require(words::scope.knows(op.scope), "scope",
            "has the unknown value " + std::to_string(op.scope));
  c.require(words::form.knows(op.form), "form", "has the unknown value " + std::to_string(op.form));
  constexpr std::uint32_t known =
      PILEUS_SERIAL | PILEUS_STIFF | PILEUS_RANDOM | PILEUS_RESIZES_ITEMS;
  c.require((op.flags & ~known) == 0, "flags", "hold an unknown bit");
  c.require((op.flags & PILEUS_RESIZES_ITEMS) == 0 || op.scope == PILEUS_GLOBAL, "flags",
            "say that it resizes items, which only an operator of global scope may do");
  c.reserved(op.reserved, "operator table");
}

void check_hooks(const OperatorTable& t, Complaints& c) {
  const pileus_operator& op = t.op;
  c.require(op.create != nullptr, "create", "is NULL; every operator needs it");
  c.require(op.configure != nullptr, "configure", "is NULL; every operator needs it");
  c.require(op.destroy != nullptr, "destroy", "is NULL; every operator needs it");
  if (op.form == PILEUS_CLOSURE) {
    c.require(op.diagnose != nullptr, "diagnose", "is NULL; a closure needs it");
    c.require(op.apply == nullptr, "apply", "is set; a closure has none");
  } else {
    c.require(op.apply != nullptr, "apply", "is NULL; only a closure has none");
  }
}

/// Nothing merges or splits on the ground, and what leaves the parcels for it is a declared source.
void check_surface(const pileus_quantity& q, const std::string& place, Complaints& c) {
  c.require(q.nature == 0, place, "lies on the surface, so it has no nature");
  c.require(q.budget == nullptr, place, "lies on the surface, so it belongs to no budget");
  c.require(q.initial >= q.low && q.initial <= q.high, place,
            "has its initial value outside its range");
}

/// The run's own numbers: nobody creates them.
void check_domain(const pileus_quantity& q, const std::string& place, Complaints& c) {
  c.require(q.nature == 0 && q.budget == nullptr, place,
            "is a number of the domain, so it has no nature and belongs to no budget");
  c.require((q.access & (PILEUS_CREATE | PILEUS_ADD)) == 0, place,
            "is a number of the domain, which operators read or write");
}

void check_nature(const pileus_quantity& q, const std::string& place, Complaints& c) {
  const bool creates = (q.access & PILEUS_CREATE) != 0;
  if (q.place == PILEUS_SURFACE) return check_surface(q, place, c);
  if (q.place == PILEUS_DOMAIN) return check_domain(q, place, c);
  if (q.nature == PILEUS_DERIVED) {
    c.require(creates, place, "is derived but not owned: add PILEUS_CREATE, or leave its nature 0");
  } else if (creates) {
    c.require(q.nature != 0, place, "is owned, so its nature must be declared");
    c.require(q.initial >= q.low && q.initial <= q.high, place,
              "has its initial value outside its range");
  }
  if (q.nature == PILEUS_INTENSIVE) {
    c.require(q.weight != nullptr, place, "is intensive but names no weight");
  }
}

void check_item(const pileus_quantity& q, const std::string& place, Complaints& c) {
  c.require(q.nature != PILEUS_DERIVED, place, "belongs to items, of which nothing is derived");
  c.require((q.access & PILEUS_ADD) == 0, place, "belongs to items, which are not added to");
  c.require(q.type == PILEUS_F64 || q.type == PILEUS_I64, place,
            "belongs to items, so it is of type f64 or, as the multiplicity, i64");
  c.require(q.components == 1, place, "belongs to items, so it has one component");
}

void check_quantity(const pileus_quantity& q, const std::string& place, const OperatorTable& t,
                    Complaints& c) {
  c.require(is_identifier(c.text(q.name, place + " name")), place,
            "has a name that is not lower-case words joined by underscores");
  c.text(q.units, place + " units");
  c.optional_text(q.weight, place + " weight");
  c.optional_text(q.budget, place + " budget");
  c.optional_text(q.doc, place + " doc");
  c.require(words::place.knows(q.place), place, "has an unknown place");
  c.require(words::type.knows(q.type), place, "has an unknown type");
  c.require(words::nature.knows(q.nature), place, "has an unknown nature");
  c.require(words::rule.knows(q.on_merge) && words::rule.knows(q.on_split), place,
            "has an unknown merge or split rule");
  c.require(q.components >= 1 && q.components <= 9, place, "has no or too many components");
  constexpr std::uint32_t known =
      PILEUS_READ | PILEUS_WRITE | PILEUS_CREATE | PILEUS_ADD | PILEUS_OPTIONAL | PILEUS_ON_DEMAND;
  c.require(q.access != 0 && (q.access & ~known) == 0, place, "has no or an unknown access");
  c.require(q.low <= q.high, place, "has a range whose low end is not below its high end");
  check_nature(q, place, c);
  c.require((q.access & PILEUS_OPTIONAL) == 0 || (q.access & PILEUS_CREATE) == 0, place,
            "is owned and optional at once: what is owned always exists");
  c.require((q.access & PILEUS_ON_DEMAND) == 0 || q.nature == PILEUS_DERIVED, place,
            "is given on demand, but not derived");
  if (q.place == PILEUS_ITEM) check_item(q, place, c);
  if (q.place == PILEUS_MESH || q.place == PILEUS_MESH_AT_PARCEL) {
    c.require((q.access & ~(PILEUS_READ | PILEUS_OPTIONAL)) == 0, place,
              "lives on the mesh, which operators only read");
  }
  const bool writes = (q.access & (PILEUS_WRITE | PILEUS_CREATE | PILEUS_ADD)) != 0;
  if (q.nature == PILEUS_DERIVED) {
    c.require(t.op.diagnose != nullptr, place, "is derived but the operator has no diagnose");
  } else if (writes) {
    c.require(t.op.form != PILEUS_CLOSURE, place, "is written by a closure but not derived");
    c.require(t.op.form != PILEUS_OBSERVER, place, "is written by an observer");
    if (q.budget != nullptr) {
      c.require(std::find(t.budgets.begin(), t.budgets.end(), q.budget) != t.budgets.end(), place,
                "belongs to a budget that the operator does not list");
    }
  }
}

void check_choices(const pileus_parameter& p, const std::string& place, Complaints& c) {
  if (p.choices == nullptr || *p.choices == nullptr) {
    c.add(place, "is a choice without words to choose from");
    return;
  }
  std::size_t count = 0;
  for (const char* const* word = p.choices; *word != nullptr; ++word) {
    if (++count > longest_list) return c.add(place, "has a list of choices without end");
    c.text(*word, place + " choice");
  }
}

void check_ladder(const pileus_parameter& p, const std::string& place, Complaints& c) {
  if (p.ladder == nullptr) return;
  std::size_t count = 0;
  while (!std::isnan(p.ladder[count])) {
    if (++count > longest_list) return c.add(place, "has a ladder that no NaN ends");
  }
  c.require(count >= 2, place, "has a ladder of fewer than two values");
}

void check_parameter(const pileus_parameter& p, const std::string& place, Complaints& c) {
  const std::string_view name = c.text(p.name, place + " name");
  c.require(is_identifier(name), place,
            "has a name that is not lower-case words joined by underscores");
  c.require(std::find(reserved_names.begin(), reserved_names.end(), name) == reserved_names.end(),
            place, "has a name that is reserved for the scene");
  c.text(p.units, place + " units");
  c.optional_text(p.doc, place + " doc");
  c.optional_text(p.text_fallback, place + " default");
  c.require(words::parameter.knows(p.type), place, "has an unknown type");
  c.require(p.knob <= 1, place, "has a knob that is neither 0 nor 1");
  c.reserved(p.reserved, place);
  if (p.type == PILEUS_CHOICE) return check_choices(p, place, c);
  if (p.type == PILEUS_TEXT) return;
  c.require(std::isfinite(p.fallback), place, "has a default that is not finite");
  if (p.type == PILEUS_SWITCH) {
    c.require(p.fallback == 0 || p.fallback == 1, place,
              "is a switch with a default that is neither 0 nor 1");
  }
  if (p.type == PILEUS_INTEGER) {
    c.require(p.fallback == std::trunc(p.fallback) && std::abs(p.fallback) <= largest_integer,
              place, "is an integer with a default that is no whole number up to 2^53");
  }
  c.require(p.low <= p.high, place, "has a range whose low end is not below its high end");
  if (p.low < p.high) {
    c.require(p.fallback >= p.low && p.fallback <= p.high, place, "has a default out of its range");
  }
  check_ladder(p, place, c);
}

void check_condition(const pileus_condition& row, const std::string& place, const OperatorTable& t,
                     Complaints& c) {
  c.require(words::comparison.knows(row.op), place, "has an unknown comparison");
  c.reserved(row.reserved, place);
  const std::string quantity(c.text(row.quantity, place + " quantity"));
  const int slot = t.find_quantity(quantity);
  if (slot < 0) {
    c.add(place, "compares '" + quantity + "', which the operator does not declare");
  } else {
    const std::uint32_t where = t.quantities[static_cast<std::size_t>(slot)].place;
    c.require(where == PILEUS_PARCEL || where == PILEUS_ITEM, place,
              "compares '" + quantity + "', which is no quantity of the parcels or their items");
  }
  if (row.parameter != nullptr) {
    c.require(t.find_parameter(row.parameter) >= 0, place,
              "compares with the parameter '" + std::string(row.parameter) +
                  "', which the operator does not declare");
  } else {
    c.require(!std::isnan(row.value), place, "compares with a NaN");
  }
}

/// The number a text is from its first to its last character, or NaN.
template <class Number>
double whole_text(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc() && end == text.data() + text.size();
  return whole ? static_cast<double>(value) : std::nan("");
}

/// The number a literal of a `when` stands for, or NaN.
double literal(const pileus_parameter& p, std::string_view text) {
  if (p.type == PILEUS_SWITCH) return text == "true" ? 1 : text == "false" ? 0 : std::nan("");
  if (p.type == PILEUS_CHOICE) {
    for (int i = 0; p.choices != nullptr && p.choices[i] != nullptr; ++i) {
      if (text == p.choices[i]) return i;
    }
    return std::nan("");
  }
  return p.type == PILEUS_INTEGER  ? whole_text<int>(text)
         : p.type == PILEUS_NUMBER ? whole_text<double>(text)
                                   : std::nan("");
}

/// Parses what follows "effect.": "name == on" or "name != on".
void parse_effect_term(const std::string& name, std::string_view word, bool equal,
                       const std::string& place, const OperatorTable& t, When& when,
                       Complaints& c) {
  if (word != "on")
    return c.add(place, "has a condition on an effect that is not compared with on");
  for (std::size_t i = 0; i < t.effects.size(); ++i) {
    const pileus_effect& effect = t.effects[i];
    if (effect.role == PILEUS_PROVIDES && effect.name != nullptr && name == effect.name) {
      return when.push_back({static_cast<std::uint32_t>(i), equal, 1.0, true});
    }
  }
  c.add(place, "has a condition on the effect '" + name + "', which the operator does not provide");
}

/// Parses "parameter == literal"; adds a complaint if it is anything else.
void parse_term(std::string_view text, const std::string& place, const OperatorTable& t, When& when,
                Complaints& c) {
  const std::size_t sign = std::min(text.find(" == "), text.find(" != "));
  if (sign == std::string_view::npos) {
    return c.add(place, "has a condition that is not 'parameter == value' or 'parameter != value'");
  }
  const std::string name(text.substr(0, sign)), word(text.substr(sign + 4));
  constexpr std::string_view effect = "effect.";
  if (name.starts_with(effect)) {
    return parse_effect_term(name.substr(effect.size()), word, text[sign + 1] == '=', place, t,
                             when, c);
  }
  const int parameter = t.find_parameter(name);
  if (parameter < 0) return c.add(place, "has a condition on the unknown parameter '" + name + "'");
  const double value = literal(t.parameters[static_cast<std::size_t>(parameter)], word);
  if (std::isnan(value)) {
    return c.add(place, "has a condition with '" + word + "', which is no value of " + name);
  }
  when.push_back({static_cast<std::uint32_t>(parameter), text[sign + 1] == '=', value});
}

When parse_when(const char* text, const std::string& place, const OperatorTable& t, Complaints& c) {
  When when;
  if (text == nullptr) return when;
  std::string_view rest = c.text(text, place + " when");
  constexpr std::string_view joint = " and ";
  while (true) {
    const std::size_t end = rest.find(joint);
    parse_term(rest.substr(0, end), place, t, when, c);
    if (end == std::string_view::npos) return when;
    rest.remove_prefix(end + joint.size());
  }
}

void check_unique_parameters(const std::vector<pileus_parameter>& rows, Complaints& c) {
  std::set<std::string> seen;
  for (const pileus_parameter& row : rows) {
    if (row.name != nullptr && !seen.insert(row.name).second) {
      c.add("parameter", "'" + std::string(row.name) + "' is declared twice");
    }
  }
}

/// One quantity may be declared at several places: on the parcels and on the mesh.
void check_unique_quantities(const std::vector<pileus_quantity>& rows, Complaints& c) {
  std::set<std::pair<std::uint32_t, std::string>> seen;
  for (const pileus_quantity& row : rows) {
    if (row.name != nullptr && !seen.emplace(row.place, row.name).second) {
      c.add("quantity", "'" + std::string(row.name) + "' is declared twice");
    }
  }
}

std::vector<std::string> copy_budgets(const char* const* list, Complaints& c) {
  std::vector<std::string> budgets;
  for (; list != nullptr && *list != nullptr; ++list) {
    if (budgets.size() == longest_list) {
      c.add("budgets", "have no end: the list must close with a null pointer");
      break;
    }
    budgets.emplace_back(c.text(*list, "budget"));
  }
  return budgets;
}

std::string label(const char* what, const char* name, std::size_t index) {
  return std::string(what) + " " +
         (name != nullptr ? "'" + std::string(name) + "'" : std::to_string(index));
}

void check_rows(OperatorTable& t, Complaints& c) {
  for (std::size_t i = 0; i < t.parameters.size(); ++i) {
    check_parameter(t.parameters[i], label("parameter", t.parameters[i].name, i), c);
  }
  for (std::size_t i = 0; i < t.quantities.size(); ++i) {
    check_quantity(t.quantities[i], label("quantity", t.quantities[i].name, i), t, c);
  }
  for (std::size_t i = 0; i < t.effects.size(); ++i) {
    const std::string place = label("effect", t.effects[i].name, i);
    c.text(t.effects[i].name, place + " name");
    c.require(words::role.knows(t.effects[i].role), place, "has an unknown role");
  }
  for (std::size_t i = 0; i < t.active_if.size(); ++i) {
    check_condition(t.active_if[i], "activity condition " + std::to_string(i), t, c);
  }
  for (const pileus_reference& row : t.references) {
    c.text(row.text, "reference text");
    c.optional_text(row.doi, "reference doi");
    c.reserved(row.reserved, "reference");
  }
  check_unique_quantities(t.quantities, c);
  check_unique_parameters(t.parameters, c);
}

/// Parameters and effects are there before anybody knows which effects are on.
void require_parameters(const When& when, const std::string& place, Complaints& c) {
  const bool on_effect =
      std::any_of(when.begin(), when.end(), [](const WhenTerm& term) { return term.is_effect; });
  c.require(!on_effect, place, "depends on an effect; only quantities may");
}

void parse_conditions(OperatorTable& t, Complaints& c) {
  for (const pileus_quantity& q : t.quantities) {
    t.quantity_when.push_back(parse_when(q.when, label("quantity", q.name, 0), t, c));
  }
  for (const pileus_parameter& p : t.parameters) {
    t.parameter_when.push_back(parse_when(p.when, label("parameter", p.name, 0), t, c));
    require_parameters(t.parameter_when.back(), label("parameter", p.name, 0), c);
  }
  for (const pileus_effect& e : t.effects) {
    t.effect_when.push_back(parse_when(e.when, label("effect", e.name, 0), t, c));
    require_parameters(t.effect_when.back(), label("effect", e.name, 0), c);
  }
}

}  // namespace

int OperatorTable::find_parameter(std::string_view name) const {
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (parameters[i].name != nullptr && name == parameters[i].name) return static_cast<int>(i);
  }
  return -1;
}

int OperatorTable::find_quantity(std::string_view name) const {
  int elsewhere = -1;
  for (std::size_t i = 0; i < quantities.size(); ++i) {
    if (quantities[i].name == nullptr || name != quantities[i].name) continue;
    if (quantities[i].place == PILEUS_PARCEL) return static_cast<int>(i);
    if (elsewhere < 0) elsewhere = static_cast<int>(i);
  }
  return elsewhere;
}

bool holds(const When& when, const double* numbers, const std::uint8_t* effects) {
  return std::all_of(when.begin(), when.end(), [&](const WhenTerm& term) {
    if (term.is_effect) return (effects == nullptr || effects[term.index] != 0) == term.equal;
    return (numbers[term.index] == term.value) == term.equal;
  });
}

std::optional<When> read_condition(const std::string& text, const OperatorTable& table) {
  std::vector<std::string> list;
  Complaints complaints(list);
  const When when = parse_when(text.c_str(), "condition", table, complaints);
  return list.empty() ? std::optional<When>(when) : std::nullopt;
}

OperatorTable read_operator(const pileus_operator* row, std::vector<std::string>& list) {
  OperatorTable t;
  Complaints c(list);
  if (row->size < first_size<pileus_operator> || row->size > largest_row) {
    c.add("operator table", "has size " + std::to_string(row->size) + " where at least " +
                                std::to_string(first_size<pileus_operator>) + " is needed");
    return t;
  }
  t.op = widened(*row);
  t.references = copy_rows(t.op.references, "reference", c);
  t.quantities = copy_rows(t.op.quantities, "quantity", c);
  t.parameters = copy_rows(t.op.parameters, "parameter", c);
  t.effects = copy_rows(t.op.effects, "effect", c);
  t.active_if = copy_rows(t.op.active_if, "activity condition", c);
  t.budgets = copy_budgets(t.op.budgets, c);
  check_identity(t, c);
  check_hooks(t, c);
  check_rows(t, c);
  parse_conditions(t, c);
  return t;
}

}  // namespace pileus::host
