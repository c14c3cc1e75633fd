#include "scene/read_scene.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "base/nearest_word.hpp"
#include "scene/declarations.hpp"
#include "scene/reader.hpp"
#include "scene/resolved.hpp"

namespace pileus::scene {
namespace {

/// Names every operator of `coupling.order` must be one of.
void check_order(Reader& reader, const Node& root) {
  const Scene& scene = reader.scene();
  std::vector<std::string> names;
  for (const OperatorBlock& block : scene.operators) names.push_back(block.name);
  const Entry* coupling = root.find("coupling");
  const Entry* order = coupling == nullptr ? nullptr : coupling->value.find("order");
  if (order == nullptr) return;
  std::vector<std::string> seen;
  for (const Node& item : order->value.items) {
    if (std::find(seen.begin(), seen.end(), item.text) != seen.end())
      reader.problem(item, fmt::format("'{}' stands in the order twice", item.text));
    seen.push_back(item.text);
    if (std::find(names.begin(), names.end(), item.text) != names.end()) continue;
    const std::string nearest = nearest_word(item.text, names);
    reader.problem(item, fmt::format("no operator is called '{}'{}", item.text,
                                     !nearest.empty() ? fmt::format("; did you mean '{}'?", nearest)
                                     : names.empty()  ? std::string("; the scene has none")
                                                      : "; there is " + alternatives(names)));
  }
  for (const std::string& name : names)
    if (!seen.empty() && std::find(seen.begin(), seen.end(), name) == seen.end())
      reader.problem(order->value, fmt::format("the order leaves out the operator '{}'", name));
}

/// A given velocity leaves nothing for an initial one to do.
void check_flow(Reader& reader, const Node& root) {
  if (!reader.scene().flow.prescribed) return;
  const Entry* initial = root.find("initial");
  if (initial == nullptr) return;
  const std::vector<double>& wind = reader.scene().initial.mean_wind;
  const bool calm = std::all_of(wind.begin(), wind.end(), [](double u) { return u == 0; });
  for (const std::string_view key : {"velocity", "vorticity", "mean_wind"}) {
    const Entry* entry = initial->value.find(key);
    if (entry == nullptr || (key == "mean_wind" && calm)) continue;
    reader.problems().add(
        {entry->where, fmt::format("'initial.{}' has no effect when the flow is prescribed", key),
         static_cast<int>(key.size()), reader.scene().flow.where, "the flow is prescribed here"});
  }
}

/// Two or three, from the first list of the domain section.
int dimension_of(const Node& root) {
  const Entry* domain = root.find("domain");
  if (domain == nullptr) return 3;
  for (const char* key : {"extent", "cells", "lower"}) {
    const Entry* entry = domain->value.find(key);
    if (entry != nullptr && entry->value.kind == Node::Kind::list)
      return entry->value.items.size() == 2 ? 2 : 3;
  }
  return 3;
}

/// Sections that others refer to come first, whatever their order in the file.
void order_sections(Node& root) {
  static constexpr std::array<std::string_view, 6> first = {"scene",  "constants", "formulas",
                                                            "domain", "time",      "operators"};
  std::stable_sort(root.entries.begin(), root.entries.end(), [](const Entry& a, const Entry& b) {
    return std::find(first.begin(), first.end(), a.key) <
           std::find(first.begin(), first.end(), b.key);
  });
}

/// Completions of sections that the file does not mention are due all the same.
void add_missing_sections(Node& root) {
  for (const Key& key : scene_table().keys) {
    if (key.type != KeyType::section || key.required || root.find(key.name) != nullptr) continue;
    Entry entry{key.name, root.where, Node{}};
    entry.value.kind = Node::Kind::mapping;
    entry.value.where = root.where;
    root.entries.push_back(std::move(entry));
  }
}

/// With twice alpha the exponential follows the shapes of parcels more closely than waves are
/// followed with alpha (docs/accuracy.md); shapes advanced by Runge-Kutta would break.
void complete_step(Scene& scene) {
  if (scene.time.strain_alpha) return;
  const bool exponential =
      scene.numerics.shape_integrator == NumericsControl::ShapeIntegrator::exponential;
  scene.time.strain_alpha = exponential ? 2 * scene.time.alpha : scene.time.alpha;
}

Scene interpret(Node root, const std::string& path, Problems& problems) {
  Scene scene;
  scene.path = path;
  scene.name = std::filesystem::path(path).stem().string();
  if (root.kind != Node::Kind::mapping) return scene;
  scene.domain.dimension = dimension_of(root);
  if (scene.domain.dimension == 2) {
    scene.parcels.per_cell = 9;
    scene.parcels.min_volume_ratio = 40;
  }
  scene.background.reference_buoyancy.units = "m s-2";
  scene.parcels.where.units = "1";
  scene.parcels.where.constant = 1;
  add_missing_sections(root);
  order_sections(root);
  Reader reader(scene, problems);
  reader.section(root, scene_table(), &scene);
  check_order(reader, root);
  check_flow(reader, root);
  complete_step(scene);
  if (problems.empty()) scene.resolved_yaml = resolved_yaml(scene);
  return scene;
}

}  // namespace

const Table& scene_table() {
  static const Table table = [] {
    Table scene;
    scene.doc = "A Pileus scene: what exists and what is wanted.";
    Key extends = value("extends", &Scene::path, "1",
                        "Another scene file, relative to this one, that this one changes; the keys "
                        "given here replace those given there.");
    extends.type = KeyType::custom;
    extends.default_doc = "none";
    extends.read = [](Reader&, const Entry&, void*) {};  // done when the file was loaded
    extends.write = [](const void*) -> Json { return nullptr; };
    extends.schema = [] { return Json{{"type", "string"}}; };
    scene.keys = {section("scene", identity_table()),
                  std::move(extends),
                  section("constants", constants_table()),
                  section("formulas", formulas_table()),
                  section("domain", &Scene::domain, domain_table()),
                  section("time", &Scene::time, time_table()),
                  section("background", &Scene::background, background_table()),
                  section("initial", &Scene::initial, initial_table()),
                  section("boundaries", &Scene::boundaries, boundaries_table()),
                  section("flow", &Scene::flow, flow_table()),
                  section("parcels", &Scene::parcels, parcels_table()),
                  sections("operators", &Scene::operators, operator_table()),
                  section("coupling", &Scene::coupling, coupling_table()),
                  effects_key(),
                  section("energy", &Scene::energy, energy_table()),
                  section("numerics", &Scene::numerics, numerics_table()),
                  section("diagnostics", &Scene::diagnostics, diagnostics_table()),
                  section("output", &Scene::output, output_table()),
                  sections("expect", &Scene::expect, expectation_table())};
    for (Key& key : scene.keys)
      if (key.name == "domain" || key.name == "time") key.required = true;
    return scene;
  }();
  return table;
}

std::vector<const Table*> all_tables(const Table& root) {
  std::vector<const Table*> tables;
  const auto visit = [&](const auto& self, const Table& table) -> void {
    tables.push_back(&table);
    for (const Key& key : table.keys)
      if (key.table != nullptr) self(self, *key.table);
  };
  visit(visit, root);
  return tables;
}

Scene read_scene(const std::string& path, const std::vector<std::string>& overrides,
                 Problems& problems) {
  Node root = load_document(path, problems);
  for (const std::string& setting : overrides) apply_override(root, setting, problems);
  return interpret(std::move(root), path, problems);
}

Scene read_scene_with(const std::string& path, std::span<const Setting> settings,
                      Problems& problems) {
  Node root = load_document(path, problems);
  for (const Setting& setting : settings) apply_setting(root, setting, problems);
  return interpret(std::move(root), path, problems);
}

Scene read_scene(const std::string& path, const std::vector<std::string>& overrides) {
  Problems problems;
  Scene scene = read_scene(path, overrides, problems);
  problems.throw_if_any();
  return scene;
}

Scene read_scene_text(const std::string& name, const std::string& text,
                      const std::vector<std::string>& overrides, Problems& problems) {
  Node root = parse_document(name, text, problems);
  for (const std::string& setting : overrides) apply_override(root, setting, problems);
  return interpret(std::move(root), name, problems);
}

}  // namespace pileus::scene
