#include "scene/reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/nearest_word.hpp"
#include "scene/formula.hpp"

namespace pileus::scene {
namespace {

std::vector<std::string> key_names(const Table& table) {
  std::vector<std::string> names;
  for (const Key& key : table.keys) names.push_back(key.name);
  return names;
}

}  // namespace

std::string Range::describe() const {
  std::string text;
  if (std::isfinite(low))
    text += fmt::format("{} {}", low_open ? "greater than" : "at least", shortest(low));
  if (std::isfinite(high))
    text += fmt::format("{}{} {}", text.empty() ? "" : " and ", high_open ? "less than" : "at most",
                        shortest(high));
  return text;
}

const Key* Table::find(std::string_view name) const {
  const auto key = std::find_if(keys.begin(), keys.end(),
                                [&](const Key& candidate) { return candidate.name == name; });
  return key == keys.end() ? nullptr : &*key;
}

Key section(std::string name, const Table& table) {
  Key key;
  key.name = std::move(name);
  key.type = KeyType::section;
  key.doc = table.doc;
  key.table = &table;
  key.member = [](void* object) { return object; };
  return key;
}

std::string Reader::label(const Table& table, const std::string& key) {
  return table.path.empty() ? fmt::format("'{}'", key) : fmt::format("'{}.{}'", table.path, key);
}

std::vector<std::string> Reader::field_variables() const {
  std::vector<std::string> names = {"x", "y", "z"};
  for (const NamedFormula& named : scene_.formulas) names.push_back(named.name);
  return names;
}

void Reader::section(const Node& node, const Table& table, void* object) {
  if (node.kind != Node::Kind::mapping && node.kind != Node::Kind::null) {
    problem(node, fmt::format("'{}' is a section with keys, found {}", table.path, describe(node)));
    return;
  }
  for (const Entry& entry : node.entries) {
    if (entry.key.starts_with("x-")) continue;  // notes for people and tools
    if (const Key* key = table.find(entry.key))
      this->entry(entry, *key, table, object);
    else if (!table.other || !table.other(*this, entry, object))
      unknown_key(entry, table);
  }
  for (const Key& key : table.keys) {
    if (!key.required || node.find(key.name) != nullptr) continue;
    problems_.add(node.where, fmt::format("{} is missing: {}", label(table, key.name), key.doc));
  }
  if (table.finish) table.finish(*this, node, object);
}

void Reader::unknown_key(const Entry& entry, const Table& table) {
  const std::string where =
      table.path.empty() ? "at the top level" : fmt::format("in '{}'", table.path);
  std::vector<std::string> here = key_names(table);
  here.insert(here.end(), table.other_names.begin(), table.other_names.end());
  std::string text = fmt::format("unknown key '{}' {}", entry.key, where);
  const std::string nearest = nearest_word(entry.key, here);
  std::string elsewhere;
  for (const Table* other : all_tables(root_))
    if (other != &table && other->find(entry.key) != nullptr && elsewhere.empty())
      elsewhere = other->path.empty() ? "the top level" : fmt::format("'{}'", other->path);
  if (!elsewhere.empty())
    text += fmt::format("; '{}' belongs to {}", entry.key, elsewhere);
  else if (!nearest.empty())
    text += fmt::format("; did you mean '{}'?", nearest);
  else
    text += fmt::format("; the keys here are {}", alternatives(here));
  problems_.add(entry.where, text, std::max<int>(1, static_cast<int>(entry.key.size())));
}

bool Reader::number(const Node& node, const Key& key, double& value) {
  if (node.kind != Node::Kind::scalar) {
    const DimensionName dimension = describe_dimension(key.units);
    problem(node, fmt::format("'{}' expects {} such as '{}', found {}", key.name, dimension.name,
                              dimension.example, describe(node)));
    return false;
  }
  const NumberResult result = read_number(node.text, key.units, constants(), key.temperature);
  if (!result.ok()) {
    Location where = node.where;
    if (where.line > 0 && result.position > 0)
      where.column += static_cast<int>(result.position) + (node.quoted ? 1 : 0);
    problems_.add(where, fmt::format("'{}': {}", key.name, result.problem),
                  result.position > 0 ? 1 : node.width());
    return false;
  }
  if (!key.range.contains(result.value)) {
    problem(node,
            fmt::format("'{}' = {} must be {}{}", key.name, with_units(result.value, key.units),
                        key.range.describe(), key.units == "1" ? "" : " " + key.units));
    return false;
  }
  value = result.value;
  return true;
}

bool Reader::integer(const Node& node, const Key& key, std::int64_t& value) {
  const auto parsed =
      node.kind == Node::Kind::scalar ? read_integer(node.text) : std::optional<std::int64_t>();
  if (!parsed) {
    problem(node, fmt::format("'{}' expects a whole number, found {}{}", key.name, describe(node),
                              node.text.size() > 1 && node.text[0] == '0'
                                  ? " (no leading zeros, no hexadecimal)"
                                  : ""));
    return false;
  }
  if (!key.range.contains(static_cast<double>(*parsed))) {
    problem(node, fmt::format("'{}' = {} must be {}", key.name, *parsed, key.range.describe()));
    return false;
  }
  value = *parsed;
  return true;
}

bool Reader::text(const Node& node, const std::string& name, std::string& value) {
  if (node.kind == Node::Kind::scalar) return value = node.text, true;
  problem(node, fmt::format("'{}' expects text, found {}", name, describe(node)));
  return false;
}

int Reader::choice(const Node& node, const Key& key) {
  if (node.kind == Node::Kind::scalar) {
    const auto found = std::find(key.choices.begin(), key.choices.end(), node.text);
    if (found != key.choices.end()) return static_cast<int>(found - key.choices.begin());
    const std::string nearest = nearest_word(node.text, key.choices);
    problem(node,
            fmt::format("'{}' is {}, found '{}'{}", key.name, alternatives(key.choices), node.text,
                        nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest)));
  } else {
    problem(node, fmt::format("'{}' is {}, found {}", key.name, alternatives(key.choices),
                              describe(node)));
  }
  return -1;
}

bool Reader::formula(const Node& node, const std::vector<std::string>& variables) {
  const auto wrong = check_formula(node.text, variables, constants());
  if (!wrong) return true;
  Location where = node.where;
  // Block scalars begin on the line after their mark; only one-line texts can be pointed into.
  const bool pointed = where.line > 0 && node.text.find('\n') == std::string::npos;
  if (pointed) where.column += static_cast<int>(wrong->position) + (node.quoted ? 1 : 0);
  problems_.add(where, pointed ? wrong->text
                               : fmt::format("{} (character {} of '{}')", wrong->text,
                                             wrong->position + 1, node.text));
  return false;
}

int Reader::wanted_count(Count count) const {
  const int dimension = scene_.domain.dimension;
  switch (count) {
    case Count::dimension:
      return dimension;
    case Count::horizontal:
      return dimension - 1;
    case Count::vorticity:
      return dimension == 3 ? 3 : 1;
    case Count::two:
      return 2;
    default:
      return 0;
  }
}

template <class T, class ReadOne>
void Reader::list(const Node& node, const Key& key, std::vector<T>& values, ReadOne&& read_one) {
  const int wanted = wanted_count(key.count);
  std::vector<T> result;
  if (node.kind == Node::Kind::list) {
    if (wanted > 0 && static_cast<int>(node.items.size()) != wanted) {
      const char* axes = key.count == Count::dimension    ? (wanted == 3 ? " (x, y, z)" : " (x, z)")
                         : key.count == Count::horizontal ? (wanted == 2 ? " (x, y)" : " (x)")
                         : key.count == Count::two        ? " (lower, upper)"
                                                          : "";
      problem(node, fmt::format("'{}' has {} entr{}, but {} {} wanted{}", key.name,
                                node.items.size(), node.items.size() == 1 ? "y" : "ies", wanted,
                                wanted == 1 ? "is" : "are", axes));
      return;
    }
    for (const Node& item : node.items) {
      T one{};
      read_one(item, one);
      result.push_back(std::move(one));
    }
  } else if (wanted > 0 && key.count != Count::two && node.kind != Node::Kind::null) {
    T one{};
    read_one(node, one);
    result.assign(static_cast<std::size_t>(wanted), one);
  } else {
    problem(node,
            fmt::format("'{}' expects a list in brackets, found {}", key.name, describe(node)));
    return;
  }
  values = std::move(result);
}

void Reader::scalar(const Node& node, const Key& key, void* member, void* object) {
  std::int64_t whole = 0;
  double parsed = 0;
  switch (key.type) {
    case KeyType::number:
      number(node, key, *static_cast<double*>(member));
      break;
    case KeyType::optional_number:
      if (number(node, key, parsed)) *static_cast<std::optional<double>*>(member) = parsed;
      break;
    case KeyType::small_integer:
      if (integer(node, key, whole)) *static_cast<int*>(member) = static_cast<int>(whole);
      break;
    case KeyType::integer:
      if (integer(node, key, whole))
        *static_cast<std::uint64_t*>(member) = static_cast<std::uint64_t>(whole);
      break;
    case KeyType::toggle:
      if (const auto state =
              node.kind == Node::Kind::scalar ? read_switch(node.text) : std::optional<bool>())
        *static_cast<bool*>(member) = *state;
      else
        problem(node, fmt::format("'{}' is 'true' or 'false', found {}", key.name, describe(node)));
      break;
    case KeyType::text:
      text(node, key.name, *static_cast<std::string*>(member));
      break;
    default:  // choice
      if (const int index = choice(node, key); index >= 0) key.choose(object, index);
  }
}

void Reader::entry(const Entry& entry, const Key& key, const Table& table, void* object) {
  const Node& node = entry.value;
  if (key.type == KeyType::custom) return key.read(*this, entry, object);
  if (node.kind == Node::Kind::null && key.type != KeyType::section) {
    problems_.add(
        entry.where,
        fmt::format("{} has no value; leave the key out for the default", label(table, key.name)),
        static_cast<int>(key.name.size()));
    return;
  }
  void* member = key.member ? key.member(object) : object;
  const auto read_field = [&](const Node& item, FieldDescription& one) {
    field(item, key.name, key.units, one);
  };
  switch (key.type) {
    case KeyType::numbers:
      list(node, key, *static_cast<std::vector<double>*>(member),
           [&](const Node& item, double& one) { number(item, key, one); });
      break;
    case KeyType::integers:
      list(node, key, *static_cast<std::vector<int>*>(member), [&](const Node& item, int& one) {
        std::int64_t parsed = 0;
        if (integer(item, key, parsed)) one = static_cast<int>(parsed);
      });
      break;
    case KeyType::texts:
      list(node, key, *static_cast<std::vector<std::string>*>(member),
           [&](const Node& item, std::string& one) { text(item, key.name, one); });
      break;
    case KeyType::field:
      read_field(node, *static_cast<FieldDescription*>(member));
      break;
    case KeyType::fields:
      list(node, key, *static_cast<std::vector<FieldDescription>*>(member), read_field);
      break;
    case KeyType::section:
      section(node, *key.table, member);
      break;
    case KeyType::sections:
      if (node.kind != Node::Kind::list)
        problem(node,
                fmt::format("'{}' expects a list of mappings, found {}", key.name, describe(node)));
      for (const Node& item : node.items) section(item, *key.table, key.append(member));
      break;
    default:
      scalar(node, key, member, object);
  }
}

}  // namespace pileus::scene
