// How a scene states a field: a value, a formula, a profile or gridded data, each with noise.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "scene/declarations.hpp"
#include "scene/formula.hpp"
#include "scene/reader.hpp"

namespace pileus::scene {
namespace {

/// Reads a list of quantities; bare numbers are in `bare` units.
bool read_profile_axis(Reader& reader, const Node& node, const std::string& name,
                       const std::string& units, const std::string& bare,
                       std::vector<double>& values) {
  if (node.kind != Node::Kind::list || node.items.empty()) {
    reader.problem(node, fmt::format("'{}' of a profile expects a list of values, found {}", name,
                                     describe(node)));
    return false;
  }
  Key key;
  key.name = name;
  key.units = units;
  bool good = true;
  for (const Node& item : node.items) {
    double value = 0;
    Node written = item;
    const auto parsed = split_quantity(item.text);
    if (parsed && parsed->unit.empty() && !bare.empty()) written.text += " " + bare;
    good = reader.number(written, key, value) && good;
    values.push_back(value);
  }
  return good;
}

void read_profile(Reader& reader, const Node& node, const std::string& units,
                  const std::string& bare, FieldDescription& field) {
  const Entry* height = node.find("height");
  const Entry* value = node.find("value");
  field.form = FieldDescription::Form::profile;
  if (height == nullptr || value == nullptr) {
    reader.problems().add(node.where, "a profile needs both 'height' and 'value'");
    return;
  }
  Profile& profile = field.profile;
  const bool heights_good =
      read_profile_axis(reader, height->value, "height", "m", "", profile.height);
  const bool values_good =
      read_profile_axis(reader, value->value, "value", units, bare, profile.value);
  if (!heights_good || !values_good) return;
  if (profile.height.size() != profile.value.size())
    reader.problem(value->value,
                   fmt::format("a profile needs as many values as heights: {} values, "
                               "{} heights",
                               profile.value.size(), profile.height.size()));
  for (std::size_t i = 1; i < profile.height.size(); ++i)
    if (!(profile.height[i] > profile.height[i - 1]))
      reader.problem(height->value.items[i], fmt::format("heights must ascend: {} follows {}",
                                                         with_units(profile.height[i], "m"),
                                                         with_units(profile.height[i - 1], "m")));
}

void read_file(Reader& reader, const Node& node, const std::string& bare, FieldDescription& field) {
  field.form = FieldDescription::Form::file;
  const Entry* file = node.find("file");
  const Entry* variable = node.find("variable");
  if (file == nullptr || variable == nullptr) {
    reader.problems().add(node.where, "gridded data needs both 'file' and 'variable'");
    return;
  }
  std::string path;
  if (!reader.text(file->value, "file", path) ||
      !reader.text(variable->value, "variable", field.variable))
    return;
  // Relative to the file the line stands in; values of the command line to the scene's own file.
  const std::string& beside =
      file->value.where.line > 0 ? file->value.where.file : reader.scene().path;
  const std::filesystem::path full = std::filesystem::path(beside).parent_path() / path;
  field.path = std::filesystem::absolute(full).lexically_normal().string();
  field.file_units = bare;
  if (!std::filesystem::exists(full))
    reader.problem(file->value,
                   fmt::format("there is no file '{}' (looked for '{}')", path, field.path));
}

void read_noise(Reader& reader, const Node& node, const std::string& units,
                FieldDescription& field) {
  static const Table& declared = noise_table();
  Table table = declared;
  // The amplitude is a difference in the field's unit.
  table.keys[0].units = units;
  table.keys[0].temperature = Temperature::difference;
  Noise noise;
  reader.section(node, table, &noise);
  field.noise = noise;
}

Key text_key(const char* name, const char* doc, const Json& type) {
  Key key;
  key.name = name;
  key.type = KeyType::custom;
  key.doc = doc;
  key.default_doc = "none";
  key.read = [](Reader&, const Entry&, void*) {};
  key.write = [](const void*) -> Json { return nullptr; };
  key.schema = [type] { return type; };
  return key;
}

}  // namespace

const Table& field_table() {
  static const Json quantity = {{"type", Json::array({"number", "string"})}};
  static const Json text = {{"type", "string"}};
  static const Json list = {{"type", "array"}, {"minItems", 1}, {"items", quantity}};
  static const Table table = {
      .path = "field",
      .doc = "A field: exactly one of constant, formula, height with value, or file with variable.",
      .keys = {text_key("constant", "A value with unit.", quantity),
               text_key("formula",
                        "A formula of x, y, z (m), constants and named formulas, in SI units.",
                        quantity),
               text_key("height", "Heights of a piecewise-linear profile, ascending.", list),
               text_key("value", "Values at the heights; constant beyond the ends.", list),
               text_key("file", "netCDF-4 or HDF5 file, relative to the scene.", text),
               text_key("variable", "Variable in the file, in the order [time,] z, y, x.", text),
               text_key("units", "Unit of bare numbers in 'value', 'constant' and the file.", text),
               [] {
                 Key key = text_key("noise", "Noise added to the field.",
                                    Json{{"$ref", "#/definitions/noise"}});
                 return key;
               }()},
      .other = {},
      .finish = {},
      .write_other = {},
      .amend_schema = {}};
  return table;
}

void Reader::field(const Node& node, const std::string& name, const std::string& units,
                   FieldDescription& field) {
  field.units = units;
  field.where = node.where;
  if (node.kind == Node::Kind::scalar)
    field_scalar(node, name, field);
  else if (node.kind == Node::Kind::mapping)
    field_mapping(node, name, field);
  else
    problem(node, fmt::format("'{}' expects a value, a formula, a profile (height, value) or "
                              "gridded data (file, variable), found {}",
                              name, describe(node)));
}

void Reader::field_scalar(const Node& node, const std::string& name, FieldDescription& field) {
  const auto written = split_quantity(node.text);
  const bool number = written && (written->unit.empty() || is_unit(written->unit));
  const bool is_formula = !check_formula(node.text, field_variables(), constants());
  if (number || !is_formula) {
    // A text that is no formula may still be "4*pi m"; if not, the formula's problem is the better
    // message for anything that does not look like a number with a unit.
    const NumberResult result = read_number(node.text, field.units, constants());
    if (result.ok()) {
      field.form = FieldDescription::Form::constant;
      field.constant = result.value;
      return;
    }
    if (written && !written->unit.empty() && std::isalpha(written->unit[0]) != 0) {
      problem(node, fmt::format("'{}': {}", name, result.problem));
      return;
    }
  }
  field.form = FieldDescription::Form::formula;
  field.formula = node.text;
  formula(node, field_variables());
}

void Reader::field_mapping(const Node& node, const std::string& name, FieldDescription& field) {
  const Table& table = field_table();
  std::vector<const Entry*> forms;
  for (const Entry& entry : node.entries) {
    if (entry.key.starts_with("x-")) continue;
    if (table.find(entry.key) == nullptr) unknown_key(entry, table);
    if (entry.key == "constant" || entry.key == "formula" || entry.key == "height" ||
        entry.key == "file")
      forms.push_back(&entry);
  }
  const Entry* units = node.find("units");
  std::string bare;
  if (units != nullptr && text(units->value, "units", bare)) {
    if (const UnitConversion fits = convert_units(1, bare, field.units); !fits.ok()) {
      problem(units->value, fits.problem);
      bare.clear();
    }
  }
  if (forms.size() > 1) {
    problems_.add({forms[1]->where,
                   fmt::format("'{}' has two forms; give one of 'constant', 'formula', 'height' "
                               "with 'value', 'file' with 'variable'",
                               name),
                   static_cast<int>(forms[1]->key.size()), forms[0]->where, "the first is here"});
  } else if (forms.empty()) {
    problems_.add(node.where, fmt::format("'{}' says nothing; give one of 'constant', 'formula', "
                                          "'height' with 'value', 'file' with 'variable'",
                                          name));
  } else if (forms[0]->key == "height") {
    read_profile(*this, node, field.units, bare, field);
  } else if (forms[0]->key == "file") {
    read_file(*this, node, bare, field);
  } else if (forms[0]->key == "formula") {
    field.form = FieldDescription::Form::formula;
    if (text(forms[0]->value, "formula", field.formula))
      formula(forms[0]->value, field_variables());
  } else {
    Key key;
    key.name = name;
    key.units = field.units;
    Node written = forms[0]->value;
    const auto parsed = split_quantity(written.text);
    if (parsed && parsed->unit.empty() && !bare.empty()) written.text += " " + bare;
    field.form = FieldDescription::Form::constant;
    this->number(written, key, field.constant);
  }
  if (const Entry* noise = node.find("noise")) read_noise(*this, noise->value, field.units, field);
}

}  // namespace pileus::scene
