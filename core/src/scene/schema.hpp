// The scene's declarations as a JSON Schema (draft 07), for completion and hover texts in editors.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "scene/parameters.hpp"

namespace pileus::scene {

/// An operator that editors should know about.
struct OperatorSchema {
  std::string id;  // "org.example.kessler"
  std::string summary;
  std::vector<ParameterDeclaration> parameters;
};

/// The schema as indented JSON text with a final newline. Every operator becomes one if/then branch
/// on `use`, so that a mistake in one block is reported once.
std::string scene_schema(std::span<const OperatorSchema> operators = {});

}  // namespace pileus::scene
