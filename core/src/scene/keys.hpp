// The vocabulary in which the keys of a scene are declared: one declaration validates, documents,
// fills in the default and writes the resolved scene.
#pragma once
#include <cstdint>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "base/units.hpp"
#include "scene/document.hpp"
#include "scene/scene.hpp"

namespace pileus::scene {

class Reader;
using Json = nlohmann::ordered_json;

enum class KeyType {
  number,
  optional_number,
  small_integer,  // int
  integer,        // std::uint64_t
  toggle,
  text,
  choice,
  numbers,
  integers,
  texts,
  field,
  fields,
  section,
  sections,
  custom
};

/// How many entries a list has; lists that are not `any` accept one value for all of them.
enum class Count { any, dimension, horizontal, vorticity, two };

struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool low_open = false, high_open = false;
  bool contains(double value) const {
    return (low_open ? value > low : value >= low) && (high_open ? value < high : value <= high);
  }
  /// "greater than 0 and at most 1"; empty without bounds.
  std::string describe() const;
};

struct Table;

/// One key of a section. `member` turns the section's object into the key's.
struct Key {
  std::string name;
  KeyType type = KeyType::text;
  std::string units = "1";
  std::string doc;
  std::string default_doc;  // shown instead of the value of a default-constructed object
  bool required = false;
  bool input_only = false;  // states something else; not part of the resolved scene
  Temperature temperature = Temperature::absolute;  // whether degC and degF may state it
  Range range;
  Count count = Count::any;
  std::vector<std::string> choices;
  const Table* table = nullptr;
  std::function<void*(void*)> member;

  std::function<void(void*, int)> choose;  // choice: by position in `choices`
  std::function<int(const void*)> chosen;
  std::function<void*(void*)> append;  // sections: a new element
  std::function<std::vector<void*>(void*)> elements;
  std::function<void(Reader&, const Entry&, void*)> read;  // custom; gets the section's object
  std::function<Json(const void*)> write;                  // custom; null: nothing to write
  std::function<Json()> schema;                            // custom

  Key&& only_read() && { return input_only = true, std::move(*this); }
  Key&& must() && { return required = true, std::move(*this); }
  Key&& above(double x) && { return range.low = x, range.low_open = true, std::move(*this); }
  Key&& at_least(double x) && { return range.low = x, std::move(*this); }
  Key&& below(double x) && { return range.high = x, range.high_open = true, std::move(*this); }
  Key&& at_most(double x) && { return range.high = x, std::move(*this); }
  Key&& counted(Count c) && { return count = c, std::move(*this); }
  Key&& otherwise(std::string text) && { return default_doc = std::move(text), std::move(*this); }
};

/// The keys of a section.
struct Table {
  std::string path;  // "time.step"; empty at the top level
  std::string doc;
  std::vector<Key> keys;
  /// Called with an entry whose key is not declared; true when it was taken care of.
  std::function<bool(Reader&, const Entry&, void*)> other;
  /// Checks and completions that need the whole section.
  std::function<void(Reader&, const Node&, void*)> finish;
  std::function<Json(const void*)> write_other;  // entries read by `other`
  std::vector<std::string> other_names = {};     // that `other` accepts, for "did you mean"
  std::function<void(Json& schema)> amend_schema;

  const Key* find(std::string_view name) const;
};

template <class T, class M>
std::function<void*(void*)> member_of(M T::*member) {
  return [member](void* object) -> void* { return &(static_cast<T*>(object)->*member); };
}

inline KeyType type_of(const double*) {
  return KeyType::number;
}
inline KeyType type_of(const std::optional<double>*) {
  return KeyType::optional_number;
}
inline KeyType type_of(const int*) {
  return KeyType::small_integer;
}
inline KeyType type_of(const std::uint64_t*) {
  return KeyType::integer;
}
inline KeyType type_of(const bool*) {
  return KeyType::toggle;
}
inline KeyType type_of(const std::string*) {
  return KeyType::text;
}
inline KeyType type_of(const std::vector<double>*) {
  return KeyType::numbers;
}
inline KeyType type_of(const std::vector<int>*) {
  return KeyType::integers;
}
inline KeyType type_of(const std::vector<std::string>*) {
  return KeyType::texts;
}
inline KeyType type_of(const FieldDescription*) {
  return KeyType::field;
}
inline KeyType type_of(const std::vector<FieldDescription>*) {
  return KeyType::fields;
}

/// A key whose type follows from the member's.
template <class T, class M>
Key value(std::string name, M T::*member, std::string units, std::string doc) {
  Key key;
  key.name = std::move(name);
  key.type = type_of(static_cast<const M*>(nullptr));
  key.units = std::move(units);
  key.doc = std::move(doc);
  key.member = member_of(member);
  return key;
}

/// One of several words; `choices` in the order of the enumerators.
template <class T, class E>
Key choice(std::string name, E T::*member, std::vector<std::string> choices, std::string doc) {
  Key key;
  key.name = std::move(name);
  key.type = KeyType::choice;
  key.doc = std::move(doc);
  key.choices = std::move(choices);
  key.choose = [member](void* object, int index) {
    static_cast<T*>(object)->*member = static_cast<E>(index);
  };
  key.chosen = [member](const void* object) {
    return static_cast<int>(static_cast<const T*>(object)->*member);
  };
  return key;
}

/// A subsection with its own object, or (identity) with the same one.
template <class T, class S>
Key section(std::string name, S T::*member, const Table& table) {
  Key key;
  key.name = std::move(name);
  key.type = KeyType::section;
  key.doc = table.doc;
  key.table = &table;
  key.member = member_of(member);
  return key;
}
Key section(std::string name, const Table& table);

/// A list of sections.
template <class T, class S>
Key sections(std::string name, std::vector<S> T::*member, const Table& table) {
  Key key;
  key.name = std::move(name);
  key.type = KeyType::sections;
  key.doc = table.doc;
  key.table = &table;
  key.member = member_of(member);
  key.append = [](void* list) -> void* {
    return &static_cast<std::vector<S>*>(list)->emplace_back();
  };
  key.elements = [](void* list) {
    std::vector<void*> all;
    for (S& element : *static_cast<std::vector<S>*>(list)) all.push_back(&element);
    return all;
  };
  return key;
}

/// The whole scene's declarations.
const Table& scene_table();

/// Every section declared below a root (depth first), for "did you mean" across sections.
std::vector<const Table*> all_tables(const Table& root);

}  // namespace pileus::scene
