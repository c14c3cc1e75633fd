#include "authoring/plugin_reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <initializer_list>
#include <vector>

#include "authoring/embedded_texts.hpp"
#include "authoring/header_words.hpp"
#include "base/quantities.hpp"
#include "host/describe.hpp"
#include "host/enum_names.hpp"
#include "host/library.hpp"
#include "planner/rules.hpp"

namespace pileus::authoring {
namespace {

/// A line of a Markdown table; cells keep to one line and show their bars.
void add_row(std::string& page, std::initializer_list<std::string> cells) {
  page += "|";
  for (const std::string& cell : cells) {
    page += ' ';
    for (const char c : cell) {
      if (c == '|') page += '\\';
      page += c == '\n' ? ' ' : c;
    }
    page += " |";
  }
  page += '\n';
}

void begin_table(std::string& page, std::initializer_list<std::string> heads) {
  page += '\n';
  add_row(page, heads);
  page += "|";
  for (std::size_t i = 0; i < heads.size(); ++i) page += " --- |";
  page += '\n';
}

std::string code(std::string_view text) {
  return text.empty() ? std::string() : fmt::format("`{}`", text);
}

void write_interface(std::string& page) {
  page +=
      "\n## Words of the interface\n\n"
      "The enumerations of `pileus/abi.h`. A value the other side does not know is refused.\n";
  for (const Enumeration& one : enumerations(interface_text())) {
    const std::size_t colon = one.title.find(':');
    const std::string name = one.title.substr(0, one.title.find_first_of(",:;"));
    page += fmt::format("\n### {}\n", name);
    if (name.size() < one.title.size()) {
      const std::size_t from = colon == name.size() ? colon + 1 : name.size() + 1;
      page += fmt::format("\n{}\n", one.title.substr(one.title.find_first_not_of(' ', from)));
    }
    begin_table(page, {"Word", "Value", "Meaning"});
    for (const Enumerator& e : one.enumerators)
      add_row(page, {code(e.name), std::to_string(e.value), e.comment});
  }
}

void write_functions(const std::string& title, const std::vector<std::string>& types,
                     std::string& page) {
  page += fmt::format("\n### {}\n", title);
  begin_table(page, {"Function", "Meaning"});
  for (const DocumentedFunction& f : documented_functions(declaration_text(), types))
    add_row(page, {code(f.declaration), f.comment});
}

void write_declarations(std::string& page) {
  page +=
      "\n## Declarations of the C++ layer\n\n"
      "Member functions of `Declaration` and of what they return (`pileus/declaration.hpp`). "
      "Strings\n"
      "have to be literals.\n";
  write_functions("Declaration", {"Quantity", "Parameter", "Budget", "void"}, page);
  write_functions("Declaration::Quantity", {"Quantity&"}, page);
  write_functions("Declaration::Parameter", {"Parameter&"}, page);
}

void write_quantities(std::string& page) {
  page +=
      "\n## Registered quantities\n\n"
      "What operators may name (`schemas/quantities.yaml`), in exactly these units. Those that are "
      "not\n"
      "carried always follow from others, or live elsewhere than on parcels.\n";
  begin_table(page, {"Name", "Units", "Carried", "Meaning"});
  for (const Quantity& q : quantities())
    add_row(page, {code(q.name), std::string(q.units), q.carried ? "yes" : "no",
                   std::string(q.definition)});
}

void write_effects(std::string& page) {
  page +=
      "\n## Effects with rules\n\n"
      "What the planner judges by `schemas/effects.yaml`; others are on when the scene lists an\n"
      "operator that provides them, or have rules beside its library.\n";
  begin_table(page, {"Effect", "What it is", "Lost without it"});
  for (const planner::Rule& rule : planner::built_in_rules().list)
    add_row(page, {code(rule.effect), rule.title, rule.loss});
}

void write_operator(const host::OperatorTable& table, std::string& page) {
  namespace words = host::words;
  const pileus_operator& op = table.op;
  page += fmt::format("\n### `{}`\n\n{} Kind {}, form {}, scope {}, same bits for {}.", op.id,
                      op.summary, op.kind, words::form(op.form), words::scope(op.scope),
                      words::repeatability(op.repeatability));
  std::string effects;
  for (const pileus_effect& e : table.effects)
    effects +=
        fmt::format("{} {} {}", effects.empty() ? "" : ";", words::role(e.role), code(e.name));
  if (!effects.empty()) page += fmt::format(" Effects:{}.", effects);
  page += '\n';
  begin_table(page, {"Quantity", "Units", "Place", "Access", "Nature", "Exists when"});
  for (const pileus_quantity& q : table.quantities) {
    std::string nature = q.nature != 0 ? words::nature(q.nature) : "";
    if (q.budget != nullptr) nature += fmt::format(", budget {}", q.budget);
    add_row(page, {code(q.name), q.units, words::place(q.place), host::access_words(q.access),
                   nature, code(q.when != nullptr ? q.when : "")});
  }
}

void write_operators(const host::SearchPath& search, std::string& page) {
  std::vector<host::OperatorTable> tables;
  for (const host::Candidate& candidate : host::list_candidates(search)) {
    if (!candidate.refusal.empty()) continue;
    for (host::OperatorTable& table : host::load_library(candidate.path).operators)
      tables.push_back(std::move(table));
  }
  std::sort(tables.begin(), tables.end(), [](const auto& a, const auto& b) {
    return std::string_view(a.op.id) < std::string_view(b.op.id);
  });
  page +=
      "\n## Operators\n\nWhat those in this repository declare; their parameters are in the keys "
      "of a\n"
      "scene, and `pileus inspect ID` shows everything.\n";
  for (const host::OperatorTable& table : tables) write_operator(table, page);
}

}  // namespace

std::string plugin_reference(const host::SearchPath& search) {
  std::string page =
      "# Reference for plugin authors\n\n"
      "Made by `pileus schema plugin --reference` from the headers, the registers and the "
      "declarations\n"
      "of the operators; a test keeps it up to date.\n";
  write_interface(page);
  write_declarations(page);
  write_quantities(page);
  write_effects(page);
  write_operators(search, page);
  return page;
}

}  // namespace pileus::authoring
