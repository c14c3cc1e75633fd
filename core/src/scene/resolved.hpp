// The scene as it was understood: every default filled in, every value with its SI unit.
#pragma once
#include <string>

#include "scene/keys.hpp"

namespace pileus::scene {

/// A scene as a YAML document that reads back as the same scene.
std::string resolved_yaml(const Scene& scene);

/// One field in the form a scene states it.
Json resolved_field(const FieldDescription& field);

/// The keys of one section.
Json resolved_section(const Table& table, const void* object);

/// Writes a JSON value as YAML, doubles in their shortest exact form.
std::string to_yaml(const Json& value);

}  // namespace pileus::scene
