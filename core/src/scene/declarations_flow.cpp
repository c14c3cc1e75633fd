// The declared keys of the flow: where the velocity comes from.
#include <fmt/format.h>

#include "scene/declarations.hpp"
#include "scene/reader.hpp"
#include "scene/value.hpp"

namespace pileus::scene {
namespace {

/// A velocity with or without unit is a formula of its own: the number in m s-1.
void read_component(Reader& reader, const Entry& entry, FlowControl::Component& component) {
  const Node& node = entry.value;
  component.where = node.where;
  if (node.kind != Node::Kind::scalar) {
    reader.problem(node,
                   fmt::format("'flow.prescribed.{}' expects a velocity or a formula of x, y, "
                               "z and t, found {}",
                               entry.key, describe(node)));
    return;
  }
  if (const NumberResult constant = read_number(node.text, "m s-1", reader.constants());
      constant.ok()) {
    component.formula = shortest(constant.value);
    return;
  }
  std::vector<std::string> names = {"x", "y", "z", "t"};
  for (const NamedFormula& named : reader.scene().formulas) names.push_back(named.name);
  if (reader.formula(node, names)) component.formula = node.text;
}

Key component_key(const char* name, FlowControl::Component FlowControl::*member) {
  Key key;
  key.name = name;
  key.type = KeyType::custom;
  key.units = "m s-1";
  key.doc = fmt::format(
      "Velocity in the {} direction: a value, or a formula of x, y, z (m) and t "
      "(s) in m s-1.",
      name);
  key.default_doc = "0 m s-1";
  key.read = [member](Reader& reader, const Entry& entry, void* object) {
    read_component(reader, entry, static_cast<FlowControl*>(object)->*member);
  };
  key.write = [member](const void* object) -> Json {
    const auto& flow = *static_cast<const FlowControl*>(object);
    const std::string& formula = (flow.*member).formula;
    if (!flow.prescribed || formula.empty()) return nullptr;
    return formula;
  };
  key.schema = [] { return Json{{"type", Json::array({"number", "string"})}}; };
  return key;
}

void complete_prescribed(Reader& reader, const Node& node, void* object) {
  auto& flow = *static_cast<FlowControl*>(object);
  flow.prescribed = true;
  flow.where = node.where;
  if (reader.scene().domain.dimension == 3) return;
  flow.y.formula.clear();
  if (const Entry* y = node.find("y"))
    reader.problems().add(y->where, "a two-dimensional scene has no direction y; it has x and z",
                          1);
}

const Table& prescribed_table() {
  static const Table table = {
      .path = "flow.prescribed",
      .doc =
          "A velocity that is given instead of found from the parcels' vorticity: no vorticity, no "
          "buoyancy force. It should be free of divergence, and its vertical component zero at the "
          "walls: parcels keep their volume whatever it is, and none leaves the domain.",
      .keys = {component_key("x", &FlowControl::x), component_key("y", &FlowControl::y),
               component_key("z", &FlowControl::z)},
      .other = {},
      .finish = complete_prescribed,
      .write_other = {},
      .amend_schema = {}};
  return table;
}

}  // namespace

const Table& flow_table() {
  static const Table table = {.path = "flow",
                              .doc = "Where the velocity comes from; without it, from the parcels.",
                              .keys = {section("prescribed", prescribed_table())},
                              .other = {},
                              .finish = {},
                              .write_other = {},
                              .amend_schema = {}};
  return table;
}

}  // namespace pileus::scene
