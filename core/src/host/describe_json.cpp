#include <nlohmann/json.hpp>

#include "host/describe.hpp"
#include "host/enum_names.hpp"

namespace pileus::host {
namespace {

using Json = nlohmann::ordered_json;

/// Paths, and notes of libraries that were not loaded, may hold any bytes.
std::string printed(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

Json text_or_null(const char* text) {
  return text != nullptr ? Json(text) : Json();
}

Json quantity_json(const pileus_quantity& q) {
  Json access = Json::array();
  if ((q.access & PILEUS_CREATE) != 0) access.push_back("create");
  if ((q.access & PILEUS_READ) != 0) access.push_back("read");
  if ((q.access & PILEUS_WRITE) != 0) access.push_back("write");
  if ((q.access & PILEUS_ADD) != 0) access.push_back("add");
  if ((q.access & PILEUS_OPTIONAL) != 0) access.push_back("optional");
  if ((q.access & PILEUS_ON_DEMAND) != 0) access.push_back("on_demand");
  return {{"name", q.name},
          {"units", q.units},
          {"place", words::place(q.place)},
          {"type", words::type(q.type)},
          {"components", q.components},
          {"access", access},
          {"nature", words::nature(q.nature)},
          {"on_merge", words::rule(q.on_merge)},
          {"on_split", words::rule(q.on_split)},
          {"weight", text_or_null(q.weight)},
          {"budget", text_or_null(q.budget)},
          {"when", text_or_null(q.when)},
          {"range", {q.low, q.high}},
          {"initial", q.initial},
          {"doc", text_or_null(q.doc)}};
}

Json parameter_json(const pileus_parameter& p) {
  Json json = {{"name", p.name},
               {"type", words::parameter(p.type)},
               {"units", p.units},
               {"doc", text_or_null(p.doc)},
               {"when", text_or_null(p.when)},
               {"knob", p.knob != 0}};
  if (p.type == PILEUS_CHOICE) {
    for (const char* const* word = p.choices; *word != nullptr; ++word)
      json["choices"].push_back(*word);
    json["default"] = p.choices[0];
  } else if (p.type == PILEUS_TEXT) {
    json["default"] = p.text_fallback != nullptr ? p.text_fallback : "";
  } else if (p.type == PILEUS_SWITCH) {
    json["default"] = p.fallback != 0;
  } else {
    json["default"] = p.fallback;
  }
  if (p.low < p.high) json["range"] = {p.low, p.high};
  for (const double* rung = p.ladder; rung != nullptr && *rung == *rung; ++rung) {
    json["ladder"].push_back(*rung);
  }
  return json;
}

Json condition_json(const pileus_condition& c) {
  Json json = {{"clause", c.clause}, {"quantity", c.quantity}, {"op", words::comparison(c.op)}};
  if (c.parameter != nullptr) {
    json["parameter"] = c.parameter;
  } else {
    json["value"] = c.value;
  }
  return json;
}

Json operator_json(const OperatorTable& t) {
  const pileus_operator& op = t.op;
  Json json = {{"id", op.id},
               {"version", op.version},
               {"kind", op.kind},
               {"title", op.title},
               {"summary", op.summary},
               {"authors", op.authors},
               {"licence", op.licence},
               {"form", words::form(op.form)},
               {"scope", words::scope(op.scope)},
               {"repeatability", words::repeatability(op.repeatability)},
               {"serial", (op.flags & PILEUS_SERIAL) != 0},
               {"stiff", (op.flags & PILEUS_STIFF) != 0},
               {"random", (op.flags & PILEUS_RANDOM) != 0},
               {"budgets", t.budgets}};
  for (const char* list : {"quantities", "parameters", "effects", "active_if", "references"}) {
    json[list] = Json::array();
  }
  for (const auto& row : t.quantities) json["quantities"].push_back(quantity_json(row));
  for (const auto& row : t.parameters) json["parameters"].push_back(parameter_json(row));
  for (const auto& row : t.effects) {
    json["effects"].push_back(
        {{"role", words::role(row.role)}, {"name", row.name}, {"when", text_or_null(row.when)}});
  }
  for (const auto& row : t.active_if) json["active_if"].push_back(condition_json(row));
  for (const auto& row : t.references) {
    json["references"].push_back({{"text", row.text}, {"doi", text_or_null(row.doi)}});
  }
  return json;
}

}  // namespace

std::string describe_json(const Library& library) {
  const LibraryNote& note = library.note;
  Json json = {{"path", library.path.string()},
               {"module", note.module},
               {"version", note.version},
               {"toolchain", note.toolchain},
               {"interface",
                {{"major", note.abi_major},
                 {"minor_built", note.abi_minor_built},
                 {"minor_needed", note.abi_minor_needed}}},
               {"operators", Json::array()}};
  for (const OperatorTable& table : library.operators) {
    json["operators"].push_back(operator_json(table));
  }
  return printed(json);
}

std::string describe_candidates_json(const SearchPath& search) {
  Json json = Json::array();
  for (const Candidate& c : list_candidates(search)) {
    Json entry = {{"path", c.path.string()}};
    if (c.refusal.empty()) {
      entry["module"] = c.module;
      entry["version"] = c.version;
    } else {
      entry["refusal"] = c.refusal;
    }
    json.push_back(std::move(entry));
  }
  return printed(json);
}

}  // namespace pileus::host
