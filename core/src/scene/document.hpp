// The YAML text as a tree with places: what yaml-cpp reads, without the traps it leaves open.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "scene/problems.hpp"

namespace pileus::scene {

struct Entry;

/// A value of the YAML tree. Aliases are resolved; their place is that of the alias.
struct Node {
  enum class Kind { null, scalar, list, mapping };
  Kind kind = Kind::null;
  std::string text;     // of a scalar
  bool quoted = false;  // a scalar in quotes or a block scalar is text, never a number
  Location where;
  std::vector<Node> items;     // of a list
  std::vector<Entry> entries;  // of a mapping, in the order written, keys unique

  const Entry* find(std::string_view key) const;
  Entry* find(std::string_view key);
  /// Characters to underline under the value.
  int width() const;
};

struct Entry {
  std::string key;
  Location where;
  Node value;
};

/// The item of `expect` that stands for the expectations of the scene that is extended.
inline constexpr const char* inherited_expectations = "inherited";

/// "a mapping", "a list", "'text'" or "nothing": what a message says was found.
std::string describe(const Node& node);

/// Parses YAML text. Duplicate keys, merge keys, several documents, self-references, tabs as
/// indentation, complex keys and explicit tags are problems; `file` names the text in messages.
/// Returns a null node when the text is empty or not parseable.
Node parse_document(const std::string& file, std::string_view text, Problems& problems);

/// What kind of file a document is, in messages: "scene" and what it cannot be without.
struct DocumentKind {
  std::string name = "scene", needs = "'domain' and 'time'", sections = "domain:, time:, …";
};

/// Reads a YAML file and, when its top level has `extends: other.yaml` (relative to the file), lays
/// it over that file, key by key; every list is replaced as a whole, but entries of `operators` are
/// matched by their names and an item `inherited` of `expect` stands for the other file's. Throws
/// pileus::Error: ExitCode::usage for a missing file (with the names near it) or a folder,
/// ExitCode::file for one that cannot be read.
Node load_document(const std::string& path, Problems& problems, const DocumentKind& kind = {});

/// Lays `over` on `base`: mappings are merged key by key, everything else is replaced.
void overlay(Node& base, const Node& over);

/// A value for the key at a dotted path, with the place where it was written.
struct Setting {
  std::string key;
  Node value;
  Location where;  // of the key
};

/// Sets the value at the setting's path; what stood there, and its place, are replaced.
void apply_setting(Node& root, const Setting& setting, Problems& problems);

/// Sets the value at a dotted path ("time.end", "operators.mixing.beta") from `key=value` text.
void apply_override(Node& root, const std::string& setting, Problems& problems);

/// The label of an operator's block: its `name`, or the last word of its `use`.
std::string operator_label(const Node& block);

}  // namespace pileus::scene
