#include "host/describe.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/units.hpp"
#include "host/enum_names.hpp"

namespace pileus::host {

std::string access_words(std::uint32_t access) {
  std::string text;
  const auto add = [&](std::uint32_t bit, const char* word) {
    if ((access & bit) != 0) text += (text.empty() ? "" : ", ") + std::string(word);
  };
  add(PILEUS_CREATE, "owns");
  add(PILEUS_READ, "reads");
  add(PILEUS_WRITE, "writes");
  add(PILEUS_ADD, "adds");
  add(PILEUS_OPTIONAL, "if there");
  add(PILEUS_ON_DEMAND, "on demand");
  return text;
}

namespace {

/// "[0, 1]"; empty when the range is every number.
std::string range_text(double low, double high) {
  constexpr double all = std::numeric_limits<double>::max();
  if (low <= -all && high >= all) return {};
  return fmt::format("[{}, {}]", shortest(low), shortest(high));
}

std::string choice_words(const pileus_parameter& p) {
  std::string words;
  for (const char* const* word = p.choices; *word != nullptr; ++word) {
    words += (words.empty() ? "" : " | ") + std::string(*word);
  }
  return words;
}

std::string default_text(const pileus_parameter& p) {
  switch (p.type) {
    case PILEUS_CHOICE:
      return p.choices[0];
    case PILEUS_TEXT:
      return p.text_fallback != nullptr ? p.text_fallback : "''";
    case PILEUS_SWITCH:
      return p.fallback != 0 ? "true" : "false";
    case PILEUS_INTEGER:
      return fmt::format("{:.0f}", p.fallback);
    default:
      return with_units(p.fallback, p.units);
  }
}

std::string or_empty(const char* text) {
  return text != nullptr ? text : "";
}

/// Rows of texts with aligned columns; the last column is free text.
class TextTable {
 public:
  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
  void print(std::string& out) const {
    std::vector<std::size_t> width;
    for (const auto& row : rows_) {
      width.resize(std::max(width.size(), row.size()));
      for (std::size_t i = 0; i < row.size(); ++i) width[i] = std::max(width[i], row[i].size());
    }
    for (const auto& row : rows_) {
      std::string line = "   ";
      for (std::size_t i = 0; i < row.size(); ++i)
        line += fmt::format(" {:<{}} ", row[i], width[i]);
      line.erase(line.find_last_not_of(' ') + 1);
      out += line + "\n";
    }
  }

 private:
  std::vector<std::vector<std::string>> rows_;
};

void print_quantities(const OperatorTable& t, std::string& out) {
  if (t.quantities.empty()) return;
  out += "  quantities\n";
  TextTable table;
  for (const pileus_quantity& q : t.quantities) {
    std::string nature = q.nature != 0 ? words::nature(q.nature) : "";
    if (q.budget != nullptr) nature += fmt::format(" (budget {})", q.budget);
    std::string note = or_empty(q.doc);
    if (q.place != PILEUS_PARCEL) note += fmt::format(" (place: {})", words::place(q.place));
    if (q.when != nullptr) note += fmt::format(" (when {})", q.when);
    table.add({q.name, q.units, access_words(q.access), nature, range_text(q.low, q.high), note});
  }
  table.print(out);
}

void print_parameters(const OperatorTable& t, std::string& out) {
  if (t.parameters.empty()) return;
  out += "  parameters\n";
  TextTable table;
  for (const pileus_parameter& p : t.parameters) {
    std::string allowed = p.type == PILEUS_CHOICE ? choice_words(p)
                          : p.low < p.high        ? range_text(p.low, p.high)
                                                  : "";
    std::string note = or_empty(p.doc);
    if (p.when != nullptr) note += fmt::format(" (when {})", p.when);
    if (p.knob != 0) note += " (knob)";
    table.add({p.name, words::parameter(p.type), default_text(p), allowed, note});
  }
  table.print(out);
}

void print_effects(const OperatorTable& t, std::string& out) {
  if (!t.effects.empty()) out += "  effects\n";
  TextTable table;
  for (const pileus_effect& e : t.effects) {
    table.add({words::role(e.role), e.name,
               e.when != nullptr ? fmt::format("(when {})", e.when) : std::string()});
  }
  table.print(out);
}

std::string condition_text(const pileus_condition& c) {
  return fmt::format("{} {} {}", c.quantity, words::comparison(c.op),
                     c.parameter != nullptr ? std::string(c.parameter) : shortest(c.value));
}

void print_activity(const OperatorTable& t, std::string& out) {
  if (t.active_if.empty()) return;
  out += "  active if any line holds\n";
  std::vector<std::uint32_t> clauses;
  for (const pileus_condition& c : t.active_if) {
    if (std::find(clauses.begin(), clauses.end(), c.clause) == clauses.end())
      clauses.push_back(c.clause);
  }
  for (const std::uint32_t clause : clauses) {
    std::string line;
    for (const pileus_condition& c : t.active_if) {
      if (c.clause == clause) line += (line.empty() ? "" : " and ") + condition_text(c);
    }
    out += "    " + line + "\n";
  }
}

void print_references(const OperatorTable& t, std::string& out) {
  if (!t.references.empty()) out += "  references\n";
  for (const pileus_reference& r : t.references) {
    out +=
        fmt::format("    {}{}\n", r.text, r.doi != nullptr ? fmt::format(" (doi:{})", r.doi) : "");
  }
}

void print_operator(const OperatorTable& t, std::string& out) {
  const pileus_operator& op = t.op;
  out += fmt::format("\n{} {}: {}\n  {}\n", op.id, op.version, op.title, op.summary);
  out += fmt::format("  {}, {}, {}; same bits for: {}; {}; {}\n", op.kind, words::form(op.form),
                     words::scope(op.scope), words::repeatability(op.repeatability), op.licence,
                     op.authors);
  print_quantities(t, out);
  print_parameters(t, out);
  print_effects(t, out);
  print_activity(t, out);
  print_references(t, out);
}

}  // namespace

std::string describe_text(const Library& library) {
  const LibraryNote& note = library.note;
  std::string out = fmt::format("{} {} ({})\n  plugin interface {}.{}, built with {}\n",
                                note.module, note.version, library.path.string(), note.abi_major,
                                note.abi_minor_built, note.toolchain);
  for (const OperatorTable& table : library.operators) print_operator(table, out);
  return out;
}

std::string describe_candidates(const SearchPath& search) {
  const std::vector<Candidate> all = list_candidates(search);
  std::string out;
  TextTable table;
  for (const Candidate& c : all) {
    if (c.refusal.empty()) table.add({c.module, c.version, c.path.string()});
  }
  table.print(out);
  for (const Candidate& c : all) {
    if (!c.refusal.empty()) out += c.refusal + "\n";
  }
  if (all.empty()) {
    out += "no plugin libraries in:\n";
    for (const auto& folder : search.folders) out += "    " + folder.string() + "\n";
  }
  return out;
}

}  // namespace pileus::host
