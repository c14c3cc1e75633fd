#include "scene/resolved.hpp"

#include <algorithm>

#include "base/units.hpp"

namespace pileus::scene {
namespace {

Json number_list(const std::vector<double>& values, const std::string& units) {
  Json list = Json::array();
  for (const double value : values)
    list.push_back(units == "1" ? Json(value) : Json(with_units(value, units)));
  return list;
}

Json number(double value, const std::string& units) {
  return units == "1" ? Json(value) : Json(with_units(value, units));
}

/// Null when there is nothing to write.
Json resolved_key(const Key& key, void* object) {
  if (key.type == KeyType::custom) return key.write(object);
  if (key.type == KeyType::choice) return key.choices[static_cast<std::size_t>(key.chosen(object))];
  void* member = key.member(object);
  switch (key.type) {
    case KeyType::number:
      return number(*static_cast<double*>(member), key.units);
    case KeyType::optional_number: {
      const auto& optional = *static_cast<std::optional<double>*>(member);
      return optional ? number(*optional, key.units) : Json();
    }
    case KeyType::small_integer:
      return *static_cast<int*>(member);
    case KeyType::integer:
      return *static_cast<std::uint64_t*>(member);
    case KeyType::toggle:
      return *static_cast<bool*>(member);
    case KeyType::text: {
      const auto& text = *static_cast<std::string*>(member);
      return text.empty() ? Json() : Json(text);
    }
    case KeyType::numbers: {
      const auto& list = *static_cast<std::vector<double>*>(member);
      return list.empty() ? Json() : number_list(list, key.units);
    }
    case KeyType::integers:
      return *static_cast<std::vector<int>*>(member);
    case KeyType::texts: {
      const auto& list = *static_cast<std::vector<std::string>*>(member);
      return list.empty() ? Json() : Json(list);
    }
    case KeyType::field:
      return resolved_field(*static_cast<FieldDescription*>(member));
    case KeyType::fields: {
      Json list = Json::array();
      for (const FieldDescription& field : *static_cast<std::vector<FieldDescription>*>(member))
        list.push_back(resolved_field(field));
      return list.empty() ? Json() : list;
    }
    case KeyType::section:
      return resolved_section(*key.table, member);
    case KeyType::sections: {
      Json list = Json::array();
      for (void* element : key.elements(member))
        list.push_back(resolved_section(*key.table, element));
      return list.empty() ? Json() : list;
    }
    default:
      return {};
  }
}

/// Words that YAML readers take for something else than text, or that need quotes anyway.
bool needs_quotes(const std::string& text) {
  if (text.empty() || text.front() == ' ' || text.back() == ' ') return true;
  static const std::vector<std::string> words = {"true", "false", "yes", "no", "on",
                                                 "off",  "null",  "~",   "y",  "n"};
  std::string lower = text;
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (std::find(words.begin(), words.end(), lower) != words.end()) return true;
  const auto plain = [](unsigned char c) {
    return std::isalnum(c) != 0 ||
           std::string_view(" _./*+-()^<>=|").find(static_cast<char>(c)) != std::string_view::npos;
  };
  if (!std::all_of(text.begin(), text.end(), plain)) return true;
  if (std::string_view("*-=<>|+").find(text.front()) != std::string_view::npos) return true;
  return false;
}

std::string scalar(const Json& value) {
  if (value.is_number_float()) return shortest(value.get<double>());
  if (value.is_string() && !needs_quotes(value.get<std::string>())) return value.get<std::string>();
  return value.dump();  // JSON strings, integers and switches are YAML
}

void emit(const Json& value, int indent, std::string& out);

void emit_inline(const Json& list, std::string& out) {
  out += "[";
  for (std::size_t i = 0; i < list.size(); ++i) {
    // Inside brackets a comma ends the entry, so text with one is quoted whatever it looks like.
    out += (i > 0 ? ", " : "") + scalar(list[i]);
  }
  out += "]\n";
}

void emit_mapping(const Json& map, int indent, std::string& out, bool first_inline) {
  bool first = first_inline;
  for (const auto& [key, value] : map.items()) {
    if (!first) out += std::string(static_cast<std::size_t>(indent), ' ');
    first = false;
    out += scalar(Json(key)) + ":";
    emit(value, indent + 2, out);
  }
}

/// Writes what follows "key:".
void emit(const Json& value, int indent, std::string& out) {
  const auto is_scalar = [](const Json& item) { return !item.is_structured(); };
  if (value.is_object() && !value.empty()) {
    out += "\n";
    emit_mapping(value, indent, out, false);
  } else if (value.is_array() && !std::all_of(value.begin(), value.end(), is_scalar)) {
    out += "\n";
    for (const Json& item : value) {
      out += std::string(static_cast<std::size_t>(indent), ' ') + "-";
      if (item.is_object()) {
        out += " ";
        emit_mapping(item, indent + 2, out, true);
      } else {
        emit(item, indent + 2, out);
      }
    }
  } else if (value.is_array()) {
    out += " ";
    emit_inline(value, out);
  } else if (value.is_object()) {
    out += " {}\n";
  } else {
    out += " " + scalar(value) + "\n";
  }
}

}  // namespace

Json resolved_field(const FieldDescription& field) {
  using Form = FieldDescription::Form;
  Json map = Json::object();
  if (field.form == Form::constant) {
    map["constant"] = number(field.constant, field.units);
  } else if (field.form == Form::formula) {
    map["formula"] = field.formula;
  } else if (field.form == Form::profile) {
    map["height"] = number_list(field.profile.height, "m");
    map["value"] = number_list(field.profile.value, field.units);
  } else {
    map["file"] = field.path;
    map["variable"] = field.variable;
    if (!field.file_units.empty()) map["units"] = field.file_units;
  }
  if (!field.noise && map.size() == 1 && !map.contains("formula")) return map["constant"];
  if (field.noise) {
    Json noise = {{"amplitude", number(field.noise->amplitude, field.units)}};
    if (std::isfinite(field.noise->bottom) && std::isfinite(field.noise->top))
      noise["layer"] = number_list({field.noise->bottom, field.noise->top}, "m");
    noise["seed"] = field.noise->seed;
    map["noise"] = std::move(noise);
  }
  return map;
}

Json resolved_section(const Table& table, const void* object) {
  Json map = Json::object();
  void* mutable_object = const_cast<void*>(object);  // members are found, never changed
  for (const Key& key : table.keys) {
    if (key.input_only) continue;
    Json value = resolved_key(key, mutable_object);
    if (value.is_null() || (value.is_object() && value.empty())) continue;
    map[key.name] = std::move(value);
  }
  if (table.write_other) {
    const Json others = table.write_other(object);
    for (const auto& [name, value] : others.items()) map[name] = value;
  }
  return map;
}

std::string to_yaml(const Json& value) {
  std::string out;
  emit_mapping(value, 0, out, true);
  return out;
}

std::string resolved_yaml(const Scene& scene) {
  return to_yaml(resolved_section(scene_table(), &scene));
}

}  // namespace pileus::scene
