// The declared keys of names and initial state: identity, constants, formulas, fields, initial.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/nearest_word.hpp"
#include "base/quantities.hpp"
#include "scene/declarations.hpp"
#include "scene/formula.hpp"
#include "scene/reader.hpp"
#include "scene/resolved.hpp"

namespace pileus::scene {
namespace {

const Json number_or_text = {{"type", Json::array({"number", "string"})}};

/// Why a word cannot name a constant or formula; empty when it can.
std::string name_problem(const Scene& scene, const std::string& name) {
  if (!is_free_name(name))
    return fmt::format(
        "'{}' cannot be a name in formulas: names are letters, digits and "
        "underscores, and x, y, z, pi and the functions are taken",
        name);
  for (const NamedFormula& named : scene.formulas)
    if (named.name == name) return fmt::format("'{}' already names a formula", name);
  if (scene.constants.contains(name)) return fmt::format("'{}' already names a constant", name);
  return {};
}

bool take_name(Reader& reader, const Entry& entry) {
  const std::string problem = name_problem(reader.scene(), entry.key);
  if (problem.empty()) return true;
  reader.problems().add(entry.where, problem, static_cast<int>(entry.key.size()));
  return false;
}

/// A constant in the SI value of whatever unit it is written in.
bool read_constant(Reader& reader, const Entry& entry, void* object) {
  if (!take_name(reader, entry)) return true;
  auto& scene = *static_cast<Scene*>(object);
  const Node& node = entry.value;
  if (node.kind != Node::Kind::scalar) {
    reader.problem(node, fmt::format("the constant '{}' is a number or a formula of the constants "
                                     "above it, found {}",
                                     entry.key, describe(node)));
    return true;
  }
  if (const auto written = split_quantity(node.text); written && !written->unit.empty()) {
    if (const auto si = to_si(written->number, written->unit)) {
      scene.constants[entry.key] = *si;
      return true;
    }
  }
  const NumberResult result = read_number(node.text, "1", scene.constants);
  if (result.ok()) {
    scene.constants[entry.key] = result.value;
    return true;
  }
  Location where = node.where;
  if (where.line > 0 && result.position > 0)
    where.column += static_cast<int>(result.position) + (node.quoted ? 1 : 0);
  reader.problems().add(where, fmt::format("the constant '{}': {}", entry.key, result.problem),
                        result.position > 0 ? 1 : node.width());
  scene.constants[entry.key] = 1;  // declared, so that its uses are not reported as unknown
  return true;
}

bool read_named_formula(Reader& reader, const Entry& entry, void* object) {
  if (!take_name(reader, entry)) return true;
  auto& scene = *static_cast<Scene*>(object);
  if (entry.value.kind != Node::Kind::scalar) {
    reader.problem(entry.value, fmt::format("the formula '{}' is text in x, y, z, constants and "
                                            "the formulas above it, found {}",
                                            entry.key, describe(entry.value)));
    return true;
  }
  reader.formula(entry.value, reader.field_variables());
  scene.formulas.push_back({entry.key, entry.value.text, entry.value.where});
  return true;
}

bool read_initial_quantity(Reader& reader, const Entry& entry, void* object) {
  const Quantity* quantity = find_quantity(entry.key);
  if (quantity == nullptr) return false;
  if (!quantity->carried) {
    reader.problems().add(entry.where,
                          fmt::format("'{}' follows from other quantities and cannot be set: {}",
                                      entry.key, quantity->definition),
                          static_cast<int>(entry.key.size()));
    return true;
  }
  FieldDescription field;
  reader.field(entry.value, entry.key, std::string(quantity->units), field);
  static_cast<Initial*>(object)->scalars[entry.key] = std::move(field);
  return true;
}

void check_initial(Reader& reader, const Node& node, void* object) {
  auto& initial = *static_cast<Initial*>(object);
  const Entry* velocity = node.find("velocity");
  const Entry* vorticity = node.find("vorticity");
  initial.velocity_given = velocity != nullptr;
  if (velocity != nullptr && vorticity != nullptr)
    reader.problems().add({velocity->where,
                           "give either 'vorticity' or 'velocity': each determines the other", 8,
                           vorticity->where, "'vorticity' is given here"});
  const Entry* wind = node.find("mean_wind");
  const bool windy = std::any_of(initial.mean_wind.begin(), initial.mean_wind.end(),
                                 [](double component) { return component != 0; });
  if (velocity != nullptr && wind != nullptr && windy)
    reader.problems().add({wind->where,
                           "'mean_wind' goes with 'vorticity'; 'velocity' already contains it", 9,
                           velocity->where, "'velocity' is given here"});
  if (initial.mean_wind.empty())
    initial.mean_wind.assign(static_cast<std::size_t>(reader.scene().domain.dimension - 1), 0.0);
}

std::vector<std::string> carried_quantities() {
  std::vector<std::string> names;
  for (const Quantity& quantity : quantities())
    if (quantity.carried) names.emplace_back(quantity.name);
  return names;
}

}  // namespace

const Table& identity_table() {
  static const Table table = {
      .path = "scene",
      .doc = "What the scene is called.",
      .keys = {value("name", &Scene::name, "1", "Short name; also names the results folder.")
                   .otherwise("the file's name"),
               value("title", &Scene::title, "1", "One line for plots and files."),
               value("description", &Scene::description, "1", "What it shows, and its source."),
               value("seed", &Scene::seed, "1", "Seed of everything random in the operators.")
                   .at_least(0)},
      .other = {},
      .finish = {},
      .write_other = {},
      .amend_schema = {}};
  return table;
}

const Table& constants_table() {
  static const Table table = {
      .path = "constants",
      .doc =
          "Named numbers for formulas and values: '800 m' (kept in SI), a plain number, or a "
          "formula of the constants above it.",
      .keys = {},
      .other = read_constant,
      .finish = {},
      .write_other =
          [](const void* object) {
            Json all = Json::object();
            for (const auto& [name, value] : static_cast<const Scene*>(object)->constants)
              all[name] = value;
            return all;
          },
      .amend_schema = [](Json& schema) { schema["additionalProperties"] = number_or_text; }};
  return table;
}

const Table& formulas_table() {
  static const Table table = {
      .path = "formulas",
      .doc =
          "Named functions of x, y, z (m), constants and the formulas above them, for use in "
          "fields.",
      .keys = {},
      .other = read_named_formula,
      .finish = {},
      .write_other =
          [](const void* object) {
            Json all = Json::object();
            for (const NamedFormula& named : static_cast<const Scene*>(object)->formulas)
              all[named.name] = named.text;
            return all;
          },
      .amend_schema = [](Json& schema) { schema["additionalProperties"] = number_or_text; }};
  return table;
}

const Table& initial_table() {
  static const Table table = {
      .path = "initial",
      .doc =
          "The state at the start. A field is a value with unit, a formula of x, y, z in SI, a "
          "profile, or gridded data; quantities that are not named start at their operator's "
          "initial value.",
      .keys = {value("vorticity", &Initial::vorticity, "s-1",
                     "Components of the vorticity [xi, eta, zeta]; one component dw/dx - du/dz in "
                     "two dimensions.")
                   .counted(Count::vorticity)
                   .otherwise("zero"),
               value("velocity", &Initial::velocity, "m s-1",
                     "Components of the velocity, instead of the vorticity.")
                   .counted(Count::dimension)
                   .otherwise("none"),
               value("mean_wind", &Initial::mean_wind, "m s-1",
                     "Horizontal mean wind added to the flow that the vorticity induces.")
                   .counted(Count::horizontal)
                   .otherwise("0 m s-1")},
      .other = read_initial_quantity,
      .finish = check_initial,
      .write_other =
          [](const void* object) {
            Json all = Json::object();
            for (const auto& [name, field] : static_cast<const Initial*>(object)->scalars)
              all[name] = resolved_field(field);
            return all;
          },
      .other_names = carried_quantities(),
      .amend_schema =
          [](Json& schema) {
            for (const Quantity& quantity : quantities()) {
              if (!quantity.carried) continue;
              schema["properties"][std::string(quantity.name)] = {
                  {"description", fmt::format("{} [{}]", quantity.definition, quantity.units)},
                  {"$ref", "#/definitions/field"}};
            }
          }};
  return table;
}

const Table& noise_table() {
  static const Table table = {
      .path = "noise",
      .doc =
          "Noise added to a field: one draw per mesh cell, uniform in +- amplitude, the same "
          "for all parcels of the cell.",
      .keys = {value("amplitude", &Noise::amplitude, "1",
                     "Largest deviation, in the unit of the field.")
                   .must()
                   .at_least(0),
               [] {
                 Key key;
                 key.name = "layer";
                 key.type = KeyType::custom;
                 key.units = "m";
                 key.doc = "Heights [lower, upper] between which noise is added.";
                 key.default_doc = "everywhere";
                 key.read = [](Reader& reader, const Entry& entry, void* object) {
                   auto& noise = *static_cast<Noise*>(object);
                   Key height;
                   height.name = "layer";
                   height.units = "m";
                   const auto& items = entry.value.items;
                   if (items.size() != 2) {
                     reader.problem(entry.value,
                                    fmt::format("'layer' expects two heights [lower, upper], found "
                                                "{}",
                                                describe(entry.value)));
                     return;
                   }
                   if (reader.number(items[0], height, noise.bottom) &&
                       reader.number(items[1], height, noise.top) && noise.bottom >= noise.top)
                     reader.problem(entry.value, "'layer' must ascend: [lower, upper]");
                 };
                 key.write = [](const void* object) -> Json {
                   const auto& noise = *static_cast<const Noise*>(object);
                   if (!std::isfinite(noise.bottom) || !std::isfinite(noise.top)) return nullptr;
                   return Json::array({with_units(noise.bottom, "m"), with_units(noise.top, "m")});
                 };
                 key.schema = [] {
                   return Json{{"type", "array"},
                               {"minItems", 2},
                               {"maxItems", 2},
                               {"items", number_or_text}};
                 };
                 return key;
               }(),
               value("seed", &Noise::seed, "1", "Seed of the draws.").at_least(0)},
      .other = {},
      .finish = {},
      .write_other = {},
      .amend_schema = {}};
  return table;
}

}  // namespace pileus::scene
