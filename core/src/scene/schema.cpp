#include "scene/schema.hpp"

#include <fmt/format.h>

#include <cmath>

#include "base/units.hpp"
#include "scene/declarations.hpp"
#include "scene/resolved.hpp"

namespace pileus::scene {
namespace {

Json section_schema(const Table& table, const void* defaults);

/// A number, or text ("33 m", a formula); bounds hold for bare numbers.
Json quantity_schema(const Range& range) {
  Json schema = {{"type", Json::array({"number", "string"})}};
  if (std::isfinite(range.low)) schema[range.low_open ? "exclusiveMinimum" : "minimum"] = range.low;
  if (std::isfinite(range.high))
    schema[range.high_open ? "exclusiveMaximum" : "maximum"] = range.high;
  return schema;
}

Json integer_schema(const Range& range) {
  Json schema = quantity_schema(range);
  schema["type"] = "integer";
  return schema;
}

Json list_schema(Json items, Count count) {
  Json list = {{"type", "array"}, {"items", items}};
  if (count == Count::any) return list;
  if (count == Count::two) {
    list["minItems"] = list["maxItems"] = 2;
    return list;
  }
  // The entries wanted depend on the dimension; the program knows it, the schema bounds it.
  list["minItems"] = count == Count::dimension ? 2 : 1;
  list["maxItems"] = count == Count::horizontal ? 2 : 3;
  return Json{{"anyOf", Json::array({std::move(items), std::move(list)})}};
}

Json value_schema(const Key& key) {
  switch (key.type) {
    case KeyType::number:
    case KeyType::optional_number:
      return quantity_schema(key.range);
    case KeyType::small_integer:
    case KeyType::integer:
      return integer_schema(key.range);
    case KeyType::toggle:
      return {{"type", "boolean"}};
    case KeyType::text:
      return {{"type", Json::array({"string", "number", "boolean"})}};
    case KeyType::choice:
      return {{"enum", key.choices}};
    case KeyType::numbers:
      return list_schema(quantity_schema(key.range), key.count);
    case KeyType::integers:
      return list_schema(integer_schema(key.range), key.count);
    case KeyType::texts:
      return list_schema({{"type", Json::array({"string", "number", "boolean"})}}, key.count);
    case KeyType::field:
      return {{"$ref", "#/definitions/field"}};
    case KeyType::fields:
      return list_schema({{"$ref", "#/definitions/field"}}, key.count);
    default:
      return key.schema();
  }
}

/// "1 (pure number)", the default and the range, below the description.
std::string hover(const Key& key, const Json& fallback) {
  std::string text = key.doc;
  if (key.units != "1") text += fmt::format(" Unit: {}.", key.units);
  if (key.required)
    text += " Required.";
  else if (!key.default_doc.empty())
    text += fmt::format(" Default: {}.", key.default_doc);
  else if (!fallback.is_null() && !fallback.is_structured())
    text +=
        fmt::format(" Default: {}.", fallback.is_string()         ? fallback.get<std::string>()
                                     : fallback.is_number_float() ? shortest(fallback.get<double>())
                                                                  : fallback.dump());
  if (const std::string range = key.range.describe(); !range.empty())
    text += fmt::format(" Must be {}.", range);
  return text;
}

/// The value a default-constructed section has, or null where there is no single one.
Json default_of(const Key& key, const void* defaults) {
  if (defaults == nullptr || key.required || !key.default_doc.empty() ||
      key.type == KeyType::section || key.type == KeyType::sections)
    return {};
  Table one;
  one.keys = {key};
  const Json written = resolved_section(one, defaults);
  return written.contains(key.name) ? written[key.name] : Json();
}

Json key_schema(const Key& key, const void* defaults) {
  if (key.type == KeyType::section) {
    void* object = defaults == nullptr ? nullptr : key.member(const_cast<void*>(defaults));
    return section_schema(*key.table, object);
  }
  if (key.type == KeyType::sections) {
    // References keep the operators' branches out of the main tree.
    Json item = key.name == "operators" ? Json{{"$ref", "#/definitions/operator"}}
                                        : section_schema(*key.table, nullptr);
    if (key.name == "expect") {  // what is said of objects holds of objects alone
      item["type"] = Json::array({"object", "string"});
      item["pattern"] = fmt::format("^{}$", inherited_expectations);
    }
    return {{"description", key.doc}, {"type", "array"}, {"items", item}};
  }
  const Json fallback = default_of(key, defaults);
  Json schema = {{"description", hover(key, fallback)}};
  if (!fallback.is_null()) schema["default"] = fallback;
  schema.update(value_schema(key));
  return schema;
}

Json section_schema(const Table& table, const void* defaults) {
  Json properties = Json::object();
  Json required = Json::array();
  for (const Key& key : table.keys) {
    properties[key.name] = key_schema(key, defaults);
    if (key.required) required.push_back(key.name);
  }
  Json schema = {{"description", table.doc},
                 {"type", required.empty() ? Json::array({"object", "null"}) : Json("object")},
                 {"additionalProperties", false},
                 {"patternProperties", {{"^x-", Json::object()}}},
                 {"properties", properties}};
  if (!required.empty()) schema["required"] = required;
  if (table.amend_schema) table.amend_schema(schema);
  return schema;
}

/// A field: a value or formula, or a mapping with exactly one form.
Json field_schema() {
  Json mapping = section_schema(field_table(), nullptr);
  mapping["type"] = "object";
  mapping["oneOf"] = Json::array({Json{{"required", {"constant"}}}, Json{{"required", {"formula"}}},
                                  Json{{"required", {"height", "value"}}},
                                  Json{{"required", {"file", "variable"}}}});
  return {{"description",
           "A value with unit, a formula of x, y, z in SI units, a piecewise-linear "
           "profile (height, value), or gridded data (file, variable)."},
          {"if", {{"type", "object"}}},
          {"then", mapping},
          {"else", {{"type", Json::array({"number", "string"})}}}};
}

/// One value, or a list of values with a list of the places where they hold.
Json function_schema(const ParameterDeclaration& parameter, const Range& range) {
  const char* places = parameter.type == ParameterType::profile ? "height" : "time";
  const auto list = [](const Json& item) {
    return Json{{"type", "array"}, {"minItems", 1}, {"items", item}};
  };
  return {{"anyOf", Json::array({quantity_schema(range),
                                 Json{{"type", "object"},
                                      {"required", {places, "value"}},
                                      {"additionalProperties", false},
                                      {"properties",
                                       {{places, list(quantity_schema({}))},
                                        {"value", list(quantity_schema(range))}}}}})}};
}

Json parameter_schema(const ParameterDeclaration& parameter) {
  Range range;
  if (parameter.low != parameter.high) {
    range.low = parameter.low;
    range.high = parameter.high;
  }
  Json schema;
  std::string fallback = with_units(parameter.fallback, parameter.units);
  switch (parameter.type) {
    case ParameterType::integer:
      schema = integer_schema(range);
      break;
    case ParameterType::toggle:
      schema = {{"enum", Json::array({true, false, "true", "false"})}};
      fallback = parameter.fallback != 0 ? "true" : "false";
      break;
    case ParameterType::choice:
      schema = {{"enum", parameter.choices}};
      fallback = parameter.choices.empty() ? "" : parameter.choices.front();
      break;
    case ParameterType::text:
      schema = {{"type", Json::array({"string", "number", "boolean"})}};
      fallback = parameter.text_fallback.empty() ? "empty" : parameter.text_fallback;
      break;
    case ParameterType::numbers:
      schema = {{"anyOf",
                 Json::array({quantity_schema(range), Json{{"type", "array"},
                                                           {"minItems", 1},
                                                           {"items", quantity_schema(range)}}})}};
      break;
    case ParameterType::profile:
    case ParameterType::series:
      schema = function_schema(parameter, range);
      break;
    default:
      schema = quantity_schema(range);
  }
  std::string text = parameter.doc.empty() ? parameter.name : parameter.doc;
  if (parameter.units != "1") text += fmt::format(" Unit: {}.", parameter.units);
  text += fmt::format(" Default: {}.", fallback);
  if (!parameter.when.empty()) text += fmt::format(" Only when {}.", parameter.when);
  Json described = {{"description", text}};
  described.update(schema);
  return described;
}

/// One operator block: any parameters for an operator that is not known here, the declared ones for
/// one that is.
Json operator_schema(std::span<const OperatorSchema> operators) {
  Json schema = section_schema(operator_table(), nullptr);
  schema.erase("required");  // demanded where nothing is extended
  if (operators.empty()) return schema;
  Json known = Json::array();
  Json branches = Json::array();
  for (const OperatorSchema& one : operators) {
    known.push_back(one.id);
    Json properties = schema["properties"];
    for (const ParameterDeclaration& parameter : one.parameters)
      properties[parameter.name] = parameter_schema(parameter);
    branches.push_back(
        {{"if", {{"properties", {{"use", {{"const", one.id}}}}}, {"required", {"use"}}}},
         {"then",
          {{"description", one.summary},
           {"properties", properties},
           {"patternProperties", {{"^x-", Json::object()}}},
           {"additionalProperties", false}}}});
  }
  // Completion of `use` offers the known operators; any other text stays valid.
  schema["properties"]["use"]["anyOf"] =
      Json::array({Json{{"enum", known}}, Json{{"type", "string"}}});
  schema["allOf"] = branches;
  return schema;
}

/// A scene that extends another takes from it what it leaves out, so the keys that must be there
/// are demanded only without `extends`.
void move_requirements(Json& schema) {
  Json demanded = {{"required", schema["required"]}, {"properties", Json::object()}};
  schema.erase("required");
  for (const char* name : {"domain", "time"}) {
    Json& section = schema["properties"][name];
    demanded["properties"][name] = {{"required", section["required"]}};
    section.erase("required");
  }
  demanded["properties"]["operators"] = {{"items", {{"required", Json::array({"use"})}}}};
  schema["if"] = {{"required", Json::array({"extends"})}};
  schema["then"] = Json::object();
  schema["else"] = demanded;
}

}  // namespace

std::string file_schema(const std::string& title, const Table& table, const void* defaults) {
  Json schema = {{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", title}};
  schema.update(section_schema(table, defaults));
  schema["type"] = "object";
  if (schema.contains("required")) {
    schema["if"] = {{"required", Json::array({"extends"})}};
    schema["then"] = Json::object();
    schema["else"] = {{"required", schema["required"]}};
    schema.erase("required");
  }
  return schema.dump(2) + "\n";
}

std::string scene_schema(std::span<const OperatorSchema> operators) {
  Scene defaults;
  defaults.background.reference_buoyancy.units = "m s-2";
  Json schema = {{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", "Pileus scene"}};
  schema.update(section_schema(scene_table(), &defaults));
  schema["type"] = "object";
  move_requirements(schema);
  schema["definitions"] = {{"field", field_schema()},
                           {"noise", section_schema(noise_table(), nullptr)},
                           {"operator", operator_schema(operators)}};
  return schema.dump(2) + "\n";
}

}  // namespace pileus::scene
