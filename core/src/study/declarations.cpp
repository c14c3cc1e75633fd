#include "study/declarations.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "coupling/parameters.hpp"
#include "host/library.hpp"
#include "scene/schema.hpp"

namespace pileus::study {

using Json = nlohmann::ordered_json;

namespace {

/// A cell of a Markdown table.
std::string cell(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '|') result += '\\';
    result += c == '\n' ? ' ' : c;
  }
  return result;
}

bool is_section(const Json& schema) {
  return schema.contains("properties");
}

/// "`a`, `b`" of an enumeration; empty for anything else.
std::string choices_of(const Json& schema) {
  if (!schema.contains("enum")) return {};
  std::string text;
  for (const Json& word : schema.at("enum")) {
    if (!word.is_string()) continue;
    text += (text.empty() ? "`" : ", `") + word.get<std::string>() + "`";
  }
  return text;
}

std::string row(const std::string& key, const Json& schema) {
  std::string meaning = schema.value("description", "");
  if (const std::string choices = choices_of(schema); !choices.empty()) {
    meaning += " One of " + choices + ".";
  }
  return fmt::format("| `{}` | {} |\n", key, cell(meaning));
}

/// What a key's list has in it, where that is a section; null otherwise.
const Json* inner_section(const Json& value) {
  if (is_section(value)) return &value;
  return value.contains("items") && is_section(value.at("items")) ? &value.at("items") : nullptr;
}

/// A section's table, and below it the tables of the sections in it.
void write_section(const std::string& path, const Json& schema, std::string& page) {
  page += fmt::format("\n## `{}`\n\n{}\n", path, schema.value("description", ""));
  std::string rows;
  std::vector<std::pair<std::string, const Json*>> inner;
  for (const auto& [key, value] : schema.at("properties").items()) {
    if (const Json* within = inner_section(value)) {
      inner.emplace_back(path + "." + key, within);
      // Headings lose everything but letters, digits, _ and - in anchors.
      std::string anchor = path + key;
      std::erase(anchor, '.');
      rows += fmt::format("| `{}` | A {}: [{}.{}](#{}). |\n", key,
                          within == &value ? "section" : "list of sections", path, key, anchor);
    } else {
      rows += row(key, value);
    }
  }
  if (!rows.empty()) page += "\n| Key | Meaning |\n| --- | --- |\n" + rows;
  for (const auto& [name, value] : inner) write_section(name, *value, page);
}

/// The table of a key's value, its list entry or what it refers to; null for a plain value.
const Json* section_of(const Json& value, const Json& definitions) {
  if (is_section(value)) return &value;
  if (!value.contains("items")) return nullptr;
  const Json& item = value.at("items");
  if (item.contains("$ref")) {
    const std::string name = item.at("$ref").get<std::string>();
    return &definitions.at(name.substr(name.rfind('/') + 1));
  }
  return is_section(item) ? &item : nullptr;
}

void write_operators(const Json& definition, std::string& page) {
  for (const Json& branch : definition.value("allOf", Json::array())) {
    const std::string id =
        branch.at("if").at("properties").at("use").at("const").get<std::string>();
    const Json& then = branch.at("then");
    page += fmt::format("\n### `{}`\n\n{}\n\n| Key | Meaning |\n| --- | --- |\n", id,
                        then.value("description", ""));
    for (const auto& [key, value] : then.at("properties").items()) {
      // The keys that every operator has stand in the table above.
      if (!definition.at("properties").contains(key)) page += row(key, value);
    }
  }
}

}  // namespace

std::string scene_schema(const host::SearchPath& search) {
  std::vector<scene::OperatorSchema> operators;
  for (const host::Candidate& candidate : host::list_candidates(search)) {
    if (!candidate.refusal.empty()) continue;
    for (const host::OperatorTable& table : host::load_library(candidate.path).operators) {
      operators.push_back({table.op.id, table.op.summary == nullptr ? "" : table.op.summary,
                           coupling::declared_parameters(table)});
    }
  }
  std::sort(operators.begin(), operators.end(),
            [](const auto& a, const auto& b) { return a.id < b.id; });
  return scene::scene_schema(operators);
}

std::string key_reference(const std::string& kind, const std::string& schema) {
  const Json root = Json::parse(schema);
  const Json definitions = root.value("definitions", Json::object());
  std::string page = fmt::format(
      "# Keys of a {0}\n\n"
      "Made by `pileus schema {1}--reference` from the declarations that validate them; a test\n"
      "keeps it up to date. Numbers may carry a unit (`33 m`) and may be formulas of the scene's\n"
      "constants. Keys that begin with `x-` are notes and are not read.\n",
      kind, kind == "scene" ? "" : kind + " ");
  std::string top;
  for (const auto& [key, value] : root.at("properties").items()) {
    if (section_of(value, definitions) == nullptr) top += row(key, value);
  }
  if (!top.empty()) page += "\n| Key | Meaning |\n| --- | --- |\n" + top;
  for (const auto& [key, value] : root.at("properties").items()) {
    const Json* section = section_of(value, definitions);
    if (section == nullptr) continue;
    write_section(key, *section, page);
    if (section->contains("allOf")) write_operators(*section, page);
  }
  if (definitions.contains("field")) {
    const Json& field = definitions.at("field");
    page += fmt::format("\n## Fields\n\n{}\n", field.value("description", ""));
    page += "\n| Key | Meaning |\n| --- | --- |\n";
    for (const auto& [key, value] : field.at("then").at("properties").items()) {
      page += row(key, value);
    }
  }
  return page;
}

}  // namespace pileus::study
