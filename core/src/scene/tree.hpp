// Small operations on the YAML tree that reading, overlaying and overriding share.
#pragma once
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "scene/document.hpp"

namespace pileus::scene {

/// Number of values in a tree, the root included.
std::size_t count_nodes(const Node& node);

/// Gives every value of the tree one place (that of the alias that stands for it).
void relocate(Node& node, const Location& where);

/// A value on one line, as YAML reads it back: what can follow `--set key=`.
std::string flow_text(const Node& node);

/// A place from yaml-cpp's zero-based line and byte column: counted from 1, in characters.
Location place_of(const std::string& file, const std::vector<std::string>& lines, int line,
                  int byte_column);

/// Byte index of the first byte that is not UTF-8 text (or is a NUL), or npos.
std::size_t find_not_utf8(std::string_view text);

/// Characters (not bytes) of UTF-8 text.
int character_count(std::string_view text);

}  // namespace pileus::scene
