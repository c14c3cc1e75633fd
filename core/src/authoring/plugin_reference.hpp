// The reference of plugin authors, made from the headers, the registers and the declarations.
#pragma once
#include <string>

#include "host/search.hpp"

namespace pileus::authoring {

/// A Markdown page: the words of the interface, the declarations of the C++ layer, the registered
/// quantities, the effects with rules, and what every operator on the search path declares.
std::string plugin_reference(const host::SearchPath& search);

}  // namespace pileus::authoring
