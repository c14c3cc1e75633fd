// What the plugin headers say about their own words, read from their text.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace pileus::authoring {

/// An enumerator: its value and the comment beside it.
struct Enumerator {
  std::string name;
  long value = 0;
  std::string comment;
};

/// An enumeration and its title: the comment after its opening brace or after its end; without one
/// the name of the type before it, or what its words have in common.
struct Enumeration {
  std::string title;
  std::vector<Enumerator> enumerators;
};

/// The enumerations of a C header in the order they stand there, but those without any title.
std::vector<Enumeration> enumerations(std::string_view header);

/// A member function and the comment above it.
struct DocumentedFunction {
  std::string declaration;  // "number(const char* name, const char* units, double fallback)"
  std::string comment;
};

/// Functions of a C++ header with a comment of "///" lines that return one of these types.
std::vector<DocumentedFunction> documented_functions(std::string_view header,
                                                     const std::vector<std::string>& types);

}  // namespace pileus::authoring
