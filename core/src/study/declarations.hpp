// What scenes may say, with the operators at hand: as a JSON Schema and as a page for reading.
#pragma once
#include <string>

#include "host/search.hpp"

namespace pileus::study {

/// The JSON Schema of scenes with a branch for every operator of the acceptable libraries on the
/// search path, ordered by id. Throws Error(plugin) when a library cannot be loaded.
std::string scene_schema(const host::SearchPath& search);

/// The reference of all keys of a kind of file ("scene", "study") as Markdown, from its schema.
std::string key_reference(const std::string& kind, const std::string& schema);

}  // namespace pileus::study
