// Files of the source tree that the program carries for plugin authors (core/cmake/EmbeddedTexts).
#pragma once
#include <span>
#include <string_view>

namespace pileus::authoring {

/// A file of core/templates: part of the project of one kind of plugin, or ("common") of each.
struct TemplateFile {
  std::string_view kind, name, text;
};

/// All of them, ordered by kind and name.
std::span<const TemplateFile> template_files();

/// The headers pileus/abi.h and pileus/declaration.hpp.
std::string_view interface_text();
std::string_view declaration_text();

}  // namespace pileus::authoring
