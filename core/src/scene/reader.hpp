// Reads a tree against the declared keys, collecting every mistake.
#pragma once
#include <string>
#include <vector>

#include "scene/keys.hpp"
#include "scene/value.hpp"

namespace pileus::scene {

class Reader {
 public:
  /// `root` is the table of the whole file, where misplaced keys are looked for.
  Reader(Scene& scene, Problems& problems, const Table& root = scene_table())
      : scene_(scene), problems_(problems), root_(root) {}

  /// Reads a mapping into the object behind a table.
  void section(const Node& node, const Table& table, void* object);

  /// A number in the key's units and range; false when a problem was reported.
  bool number(const Node& node, const Key& key, double& value);
  bool integer(const Node& node, const Key& key, std::int64_t& value);
  bool text(const Node& node, const std::string& name, std::string& value);
  /// Position of the word among the choices, or −1.
  int choice(const Node& node, const Key& key);
  void field(const Node& node, const std::string& name, const std::string& units,
             FieldDescription& field);
  /// Reports a text that is not a formula of the scene's names and `variables`.
  bool formula(const Node& node, const std::vector<std::string>& variables);

  /// "'time.end'": how messages call a key.
  static std::string label(const Table& table, const std::string& key);

  void problem(const Node& node, std::string text) {
    problems_.add(node.where, std::move(text), node.width());
  }

  Scene& scene() { return scene_; }
  Problems& problems() { return problems_; }
  const Constants& constants() const { return scene_.constants; }
  /// Names a field's formula may use besides constants: x, y, z and the named formulas.
  std::vector<std::string> field_variables() const;

 private:
  void entry(const Entry& entry, const Key& key, const Table& table, void* object);
  /// Keys with one value; `member` is the value's place, `object` that of its section.
  void scalar(const Node& node, const Key& key, void* member, void* object);
  void unknown_key(const Entry& entry, const Table& table);
  template <class T, class ReadOne>
  void list(const Node& node, const Key& key, std::vector<T>& values, ReadOne&& read_one);
  void field_mapping(const Node& node, const std::string& name, FieldDescription& field);
  void field_scalar(const Node& node, const std::string& name, FieldDescription& field);
  int wanted_count(Count count) const;

  Scene& scene_;
  Problems& problems_;
  const Table& root_;
};

}  // namespace pileus::scene
