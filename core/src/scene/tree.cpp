#include "scene/tree.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace pileus::scene {

const Entry* Node::find(std::string_view key) const {
  const auto entry = std::find_if(entries.begin(), entries.end(),
                                  [&](const Entry& candidate) { return candidate.key == key; });
  return entry == entries.end() ? nullptr : &*entry;
}

Entry* Node::find(std::string_view key) {
  return const_cast<Entry*>(static_cast<const Node*>(this)->find(key));
}

int Node::width() const {
  if (kind != Kind::scalar || text.find('\n') != std::string::npos) return 1;
  return std::max(1, character_count(text) + (quoted ? 2 : 0));
}

std::string describe(const Node& node) {
  switch (node.kind) {
    case Node::Kind::null:
      return "nothing";
    case Node::Kind::list:
      return fmt::format("a list of {}", node.items.size());
    case Node::Kind::mapping:
      return "a mapping";
    default:
      return fmt::format("'{}'", node.text);
  }
}

std::size_t count_nodes(const Node& node) {
  std::size_t count = 1;
  for (const Node& item : node.items) count += count_nodes(item);
  for (const Entry& entry : node.entries) count += count_nodes(entry.value);
  return count;
}

void relocate(Node& node, const Location& where) {
  node.where = where;
  for (Node& item : node.items) relocate(item, where);
  for (Entry& entry : node.entries) {
    entry.where = where;
    relocate(entry.value, where);
  }
}

int character_count(std::string_view text) {
  return static_cast<int>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U;
  }));
}

std::string flow_text(const Node& node) {
  std::string text;
  switch (node.kind) {
    case Node::Kind::null:
      return "~";
    case Node::Kind::list:
      for (const Node& item : node.items) text += (text.empty() ? "" : ", ") + flow_text(item);
      return "[" + text + "]";
    case Node::Kind::mapping:
      for (const Entry& entry : node.entries)
        text +=
            fmt::format("{}{}: {}", text.empty() ? "" : ", ", entry.key, flow_text(entry.value));
      return "{" + text + "}";
    default:
      break;
  }
  const bool plain = !node.quoted && !node.text.empty() &&
                     node.text.find_first_of(",[]{}#:\"'\n&*!|>%@`") == std::string::npos;
  if (plain) return node.text;
  for (const char c : node.text) {
    if (c == '"' || c == '\\') text += '\\';
    text += c == '\n' ? std::string("\\n") : std::string(1, c);
  }
  return '"' + text + '"';
}

Location place_of(const std::string& file, const std::vector<std::string>& lines, int line,
                  int byte_column) {
  line = std::max(0, line);
  byte_column = std::max(0, byte_column);
  if (line >= static_cast<int>(lines.size())) return {file, line + 1, byte_column + 1};
  const std::string& text = lines[static_cast<std::size_t>(line)];
  const std::string_view before(text.data(),
                                std::min(text.size(), static_cast<std::size_t>(byte_column)));
  return {file, line + 1, character_count(before) + 1};
}

std::size_t find_not_utf8(std::string_view text) {
  std::size_t i = 0;
  while (i < text.size()) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const std::size_t length = lead < 0x80   ? 1
                               : lead < 0xC2 ? 0
                               : lead < 0xE0 ? 2
                               : lead < 0xF0 ? 3
                               : lead < 0xF5 ? 4
                                             : 0;
    if (lead == 0 || length == 0 || i + length > text.size()) return i;
    for (std::size_t k = 1; k < length; ++k)
      if ((static_cast<unsigned char>(text[i + k]) & 0xC0U) != 0x80U) return i;
    i += length;
  }
  return std::string_view::npos;
}

}  // namespace pileus::scene
