// The scene's declarations as a JSON Schema (draft 07), for completion and hover texts in editors.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "scene/keys.hpp"
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

/// The schema of another kind of file, as text: its top-level table with the defaults of a
/// default-constructed object. Files may have `extends`; required keys are demanded without it.
std::string file_schema(const std::string& title, const Table& table, const void* defaults);

}  // namespace pileus::scene
