#include "study/study_knobs.hpp"

#include <fmt/format.h>

#include <utility>

#include "base/units.hpp"
#include "scene/reader.hpp"
#include "scene/tree.hpp"
#include "study/scene_settings.hpp"
#include "study/study_file.hpp"

namespace pileus::study {

using scene::Entry;
using scene::Node;
using scene::Reader;

namespace {

/// The number a rung's value is on an axis: that of its text, unit aside.
double number_of(const Node& value) {
  if (value.kind == Node::Kind::list && !value.items.empty()) return number_of(value.items.front());
  if (value.kind != Node::Kind::scalar) return not_a_number;
  const auto written = split_quantity(value.text);
  if (!written) return not_a_number;
  return written->unit.empty() ? written->number
                               : to_si(written->number, written->unit).value_or(written->number);
}

void add_rung(Reader& reader, Knob& knob, std::size_t index) {
  const Node& value = knob.values[index];
  Rung rung{index < knob.labels.size() ? knob.labels[index] : label_of(value),
            index < knob.numbers.size() ? knob.numbers[index] : number_of(value),
            {}};
  if (knob.keys.size() == 1) {
    rung.settings.push_back({knob.keys.front(), value, knob.where});
  } else if (value.kind != Node::Kind::list || value.items.size() != knob.keys.size()) {
    reader.problem(value,
                   fmt::format("the knob '{}' has {} keys, so each of its values is a list "
                               "of {}; found {}",
                               knob.name, knob.keys.size(), knob.keys.size(), describe(value)));
  } else {
    for (std::size_t k = 0; k < knob.keys.size(); ++k)
      rung.settings.push_back({knob.keys[k], value.items[k], knob.where});
  }
  for (const Rung& other : knob.ladder)
    if (other.label == rung.label)
      reader.problem(value, fmt::format("two values of the knob '{}' are both called '{}'; tell "
                                        "them apart with 'labels'",
                                        knob.name, rung.label));
  knob.ladder.push_back(std::move(rung));
}

/// Puts keys, values, numbers and labels together into rungs.
void complete_knob(Reader& reader, const Node& node, void* object) {
  auto& knob = *static_cast<Knob*>(object);
  knob.where = node.where;
  if (!knob.key.empty() && !knob.keys.empty())
    reader.problem(node, "give either 'key' or 'keys', not both");
  if (knob.keys.empty() && !knob.key.empty()) knob.keys = {knob.key};
  if (knob.keys.empty())
    reader.problem(node,
                   "a knob needs the 'key' of the scene that it turns, such as "
                   "'time.step.alpha'");
  if (knob.name.empty() && !knob.keys.empty()) knob.name = last_word(knob.keys.front());
  const Entry* values = node.find("values");
  if (values != nullptr && knob.values.empty())
    reader.problem(values->value, "a knob needs at least one value");
  for (const auto& [name, size] :
       {std::pair("numbers", knob.numbers.size()), std::pair("labels", knob.labels.size())}) {
    const Entry* entry = node.find(name);
    if (entry != nullptr && size != knob.values.size())
      reader.problem(entry->value, fmt::format("'{}' has {} entries for {} values", name, size,
                                               knob.values.size()));
  }
  for (std::size_t i = 0; i < knob.values.size(); ++i) add_rung(reader, knob, i);
}

scene::Key values_key() {
  scene::Key key;
  key.name = "values";
  key.type = scene::KeyType::custom;
  key.doc =
      "Values of the key from coarse to fine; with 'keys', each is a list with one value per "
      "key.";
  key.default_doc = "the ladder that the operator declares for its parameter";
  key.read = [](Reader& reader, const Entry& entry, void* object) {
    if (entry.value.kind != Node::Kind::list)
      return reader.problem(entry.value,
                            fmt::format("'values' is a list, found {}", describe(entry.value)));
    static_cast<Knob*>(object)->values = entry.value.items;
  };
  key.write = [](const void*) -> scene::Json { return nullptr; };
  key.schema = [] { return scene::Json{{"type", "array"}, {"minItems", 1}}; };
  return key;
}

}  // namespace

std::string label_of(const Node& value) {
  if (value.kind == Node::Kind::scalar) return value.text;
  std::string text;
  for (const Node& item : value.items) text += (text.empty() ? "" : " ") + label_of(item);
  return text.empty() ? scene::flow_text(value) : text;
}

const scene::Table& knob_table() {
  static const scene::Table table = {
      .path = "knobs",
      .doc = "What is varied: keys of the scene with their values from coarse to fine.",
      .keys = {scene::value("name", &Knob::name, "1", "Name in tables and pictures.")
                   .otherwise("the last word of the key"),
               scene::value("key", &Knob::key, "1", "Dotted key of the scene.").otherwise("none"),
               scene::value("keys", &Knob::keys, "1", "Several keys that move together."),
               values_key(),
               scene::value("numbers", &Knob::numbers, "1",
                            "The number that stands for each value on axes and in orders.")
                   .otherwise("the values' own, in SI units"),
               scene::value("labels", &Knob::labels, "1", "What each value is called.")
                   .otherwise("the values as written"),
               scene::value("axis", &Knob::axis, "1", "Label of the axis in pictures.")
                   .otherwise("the name")},
      .other = {},
      .finish = complete_knob,
      .write_other = {},
      .amend_schema = {}};
  return table;
}

const scene::Table& product_table() {
  static const scene::Table table = [] {
    scene::Table product = knob_table();
    product.path = "product";
    product.doc = "What is varied in all combinations: keys of the scene with their values.";
    std::erase_if(product.keys, [](const scene::Key& key) { return key.name == "axis"; });
    for (scene::Key& key : product.keys) {
      if (key.name == "name") key.doc = "Name in tables, files and pictures.";
      if (key.name == "numbers") key.doc = "The number that stands for each value in files.";
      if (key.name != "values") continue;
      key.doc = "Values of the key; with 'keys', each is a list with one value per key.";
      key.required = true;
    }
    return product;
  }();
  return table;
}

}  // namespace pileus::study
