// Files behind a scene: finding and reading them, `extends`, and `--set`.
#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include "base/error.hpp"
#include "base/nearest_word.hpp"
#include "scene/document.hpp"
#include "scene/tree.hpp"

namespace pileus::scene {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t max_bytes = std::size_t{16} << 20U;
constexpr int max_extends = 16;
constexpr const char* no_operator = "none";

/// Scene files of the folder the missing one should be in, the nearest name first.
std::string names_near(const fs::path& missing) {
  const fs::path folder = missing.has_parent_path() ? missing.parent_path() : fs::path(".");
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored))
    return fmt::format("There is no folder '{}'.", folder.string());
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder, ignored)) {
    const std::string extension = entry.path().extension().string();
    if (extension == ".yaml" || extension == ".yml")
      names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  const std::string nearest = nearest_word(missing.filename().string(), names);
  if (!nearest.empty()) return fmt::format("Did you mean '{}'?", (folder / nearest).string());
  if (names.empty()) return fmt::format("The folder '{}' holds no .yaml file.", folder.string());
  if (names.size() > 8) names.resize(8);
  return fmt::format("That folder holds {}.", alternatives(names));
}

/// The text of a file, or an explanation why there is none (`problem` set).
std::string read_text(const std::string& path, const DocumentKind& kind) {
  std::error_code status;
  const fs::path file(path);
  if (fs::is_directory(file, status))
    throw Error(ExitCode::usage,
                fmt::format("'{}' is a folder, not a {} file. {}", path, kind.name,
                            names_near(file / (file.filename().string() + ".yaml"))));
  if (!fs::exists(file, status))
    throw Error(ExitCode::usage,
                fmt::format("There is no {} file '{}' (looked for '{}'). {}", kind.name, path,
                            fs::absolute(file).lexically_normal().string(), names_near(file)));
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream.is_open() || stream.bad())
    throw Error(ExitCode::file, fmt::format("The {} file '{}' cannot be read: {}.", kind.name, path,
                                            errno != 0 ? std::strerror(errno) : "input error"));
  if (text.size() > max_bytes)
    throw Error(ExitCode::usage,
                fmt::format("'{}' has {} bytes; no {} is that large. Is it a data file?", path,
                            text.size(), kind.name));
  return text;
}

/// A document being read, and the files that led to it.
struct Loading {
  Problems& problems;
  const DocumentKind& kind;
  std::vector<std::string> chain = {};
};

Node load_layer(const std::string& path, Loading& loading);

/// The scene that `node` extends, with `node` laid over it.
Node extended(Node node, const std::string& path, Loading& loading) {
  Problems& problems = loading.problems;
  const std::vector<std::string>& chain = loading.chain;
  const Entry* extends = node.find("extends");
  if (extends == nullptr) return node;
  if (extends->value.kind != Node::Kind::scalar || extends->value.text.empty()) {
    problems.add(extends->value.where, fmt::format("'extends' names one {} file, found {}",
                                                   loading.kind.name, describe(extends->value)));
    return node;
  }
  const fs::path parent = fs::path(path).parent_path() / extends->value.text;
  const std::string canonical = fs::weakly_canonical(parent).string();
  if (std::find(chain.begin(), chain.end(), canonical) != chain.end() ||
      chain.size() > max_extends) {
    problems.add(extends->value.where,
                 fmt::format("the {} files extend each other in a circle", loading.kind.name),
                 extends->value.width());
    return node;
  }
  try {
    Node base = load_layer(parent.lexically_normal().string(), loading);
    overlay(base, node);
    return base;
  } catch (const Error& failure) {
    if (failure.code() == ExitCode::file) throw;
    problems.add(extends->value.where, failure.what(), extends->value.width());
    return node;
  }
}

Node load_layer(const std::string& path, Loading& loading) {
  Problems& problems = loading.problems;
  const std::string text = read_text(path, loading.kind);
  loading.chain.push_back(fs::weakly_canonical(path).string());
  const std::size_t before = problems.size();
  Node node = parse_document(path, text, problems);
  if (problems.size() == before && node.kind == Node::Kind::null)
    problems.add({path, 1, 1}, fmt::format("the file is empty; a {} needs at least {}",
                                           loading.kind.name, loading.kind.needs));
  else if (node.kind != Node::Kind::mapping && node.kind != Node::Kind::null)
    problems.add(node.where, fmt::format("a {} is a mapping of sections ({}), found {}",
                                         loading.kind.name, loading.kind.sections, describe(node)));
  if (node.kind != Node::Kind::mapping) return {};
  return extended(std::move(node), path, loading);
}

/// Operators of the same label are laid over each other, others are added; `use: none` leaves one
/// out.
void overlay_operators(Node& base, const Node& over) {
  for (const Node& block : over.items) {
    const std::string label = operator_label(block);
    const auto same = std::find_if(base.items.begin(), base.items.end(), [&](const Node& other) {
      return operator_label(other) == label;
    });
    const Entry* use = block.find("use");
    if (same == base.items.end() || label.empty())
      base.items.push_back(block);
    else if (use != nullptr && use->value.text == no_operator)
      base.items.erase(same);
    else
      overlay(*same, block);
  }
}

/// The bounds of a scene replace those of the one it extends; an item `inherited` among them stands
/// for all of those.
void overlay_expectations(Node& base, const Node& over) {
  std::vector<Node> items;
  for (const Node& item : over.items)
    if (item.kind == Node::Kind::scalar && item.text == inherited_expectations)
      items.insert(items.end(), base.items.begin(), base.items.end());
    else
      items.push_back(item);
  base = over;
  base.items = std::move(items);
}

/// A value that states a field or is one choice among several forms: merging two of them key by key
/// would mix the forms, so the newer one replaces the older.
bool is_whole(const std::string& section, const Entry& entry) {
  if (section == "initial") return true;
  return entry.key == "effects" || entry.key == "expect" || entry.key == "reference_buoyancy" ||
         entry.key == "energy";
}

void overlay_entries(Node& base, const Node& over, const std::string& section) {
  for (const Entry& entry : over.entries) {
    Entry* old = base.find(entry.key);
    if (old == nullptr) {
      base.entries.push_back(entry);
    } else if (!is_whole(section, entry) && old->value.kind == Node::Kind::mapping &&
               entry.value.kind == Node::Kind::mapping) {
      overlay_entries(old->value, entry.value, entry.key);
    } else if (section.empty() && entry.key == "operators" && old->value.kind == Node::Kind::list &&
               entry.value.kind == Node::Kind::list) {
      overlay_operators(old->value, entry.value);
    } else if (section.empty() && entry.key == "expect" && old->value.kind == Node::Kind::list &&
               entry.value.kind == Node::Kind::list) {
      overlay_expectations(old->value, entry.value);
    } else {
      *old = entry;
    }
  }
}

Node* child_for(Node& node, const std::string& word, const Location& where) {
  if (node.kind == Node::Kind::list) {  // operators, by label
    for (Node& item : node.items)
      if (operator_label(item) == word) return &item;
    return nullptr;
  }
  if (node.kind != Node::Kind::mapping) {
    node = Node{};
    node.kind = Node::Kind::mapping;
    node.where = where;
  }
  if (Entry* entry = node.find(word)) return &entry->value;
  node.entries.push_back({word, where, Node{}});
  node.entries.back().value.where = where;
  return &node.entries.back().value;
}

std::vector<std::string> split_path(const std::string& path) {
  std::vector<std::string> words;
  std::size_t begin = 0;
  while (begin <= path.size()) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    words.push_back(path.substr(begin, end - begin));
    begin = end + 1;
  }
  return words;
}

}  // namespace

std::string operator_label(const Node& block) {
  for (const char* key : {"name", "use"}) {
    const Entry* entry = block.find(key);
    if (entry == nullptr || entry->value.kind != Node::Kind::scalar) continue;
    std::string label = entry->value.text;
    if (key == std::string_view("use")) {
      label = label.substr(
          label.find_last_of('/') == std::string::npos ? 0 : label.find_last_of('/') + 1);
      if (label.ends_with(".so")) label.resize(label.size() - 3);
      if (label.starts_with("lib")) label.erase(0, 3);
      label = label.substr(
          label.find_last_of('.') == std::string::npos ? 0 : label.find_last_of('.') + 1);
    }
    return label;
  }
  return {};
}

void overlay(Node& base, const Node& over) {
  if (base.kind == Node::Kind::mapping && over.kind == Node::Kind::mapping)
    overlay_entries(base, over, "");
  else
    base = over;
}

Node load_document(const std::string& path, Problems& problems, const DocumentKind& kind) {
  Loading loading{problems, kind};
  return load_layer(path, loading);
}

void apply_setting(Node& root, const Setting& setting, Problems& problems) {
  Node* node = &root;
  for (const std::string& word : split_path(setting.key)) {
    const bool was_list = node->kind == Node::Kind::list;
    std::vector<std::string> labels;
    for (const Node& item : node->items) labels.push_back(operator_label(item));
    Node* child = child_for(*node, word, setting.where);
    if (child == nullptr && was_list) {
      problems.add(setting.where, fmt::format("no operator here is called '{}'; there {}", word,
                                              labels.empty() ? std::string("is none")
                                                             : "is " + alternatives(labels)));
      return;
    }
    node = child;
  }
  // The entry's own place moves with the value: an unknown key is then blamed on the setting.
  *node = setting.value;
}

void apply_override(Node& root, const std::string& setting, Problems& problems) {
  const Location where{"command line: --set " + setting, 0, 0};
  const std::size_t equals = setting.find('=');
  if (equals == std::string::npos || equals == 0) {
    problems.add(where, "expected key=value, for example --set time.end=300");
    return;
  }
  Problems inner;
  Node value = parse_document(where.file, setting.substr(equals + 1), inner);
  if (!inner.empty()) {
    problems.add(where, inner.list().front().text);
    return;
  }
  relocate(value, where);
  apply_setting(root, {setting.substr(0, equals), std::move(value), where}, problems);
}

}  // namespace pileus::scene
