// What studies and sweeps do to a scene: settings on top of its file, and the mistakes they make.
#pragma once
#include <string>
#include <vector>

#include "coupling/operator_entry.hpp"
#include "scene/document.hpp"
#include "scene/problems.hpp"
#include "scene/scene.hpp"

namespace pileus::study {

/// A setting with a value as text, as if it stood at `where`.
scene::Setting text_setting(std::string key, const std::string& value,
                            const scene::Location& where);

/// "key=value", as `--set` takes them.
std::vector<std::string> assignments(const std::vector<scene::Setting>& settings);

/// The operators of a scene, found from its folder. Throws Error(plugin) for a library that is
/// missing or refused; mistakes in their parameters go to `problems`.
std::vector<coupling::OperatorEntry> operators_of(const scene::Scene& scene,
                                                  const std::string& scene_path,
                                                  scene::Problems& problems);

/// Whether two problems are one mistake: the same words at the same place.
bool is_same(const scene::Problem& a, const scene::Problem& b);

/// The part of a dotted key that names it among others.
std::string last_word(const std::string& key);

/// A name for files and variables: letters, digits and underscores.
std::string identifier(const std::string& text);

}  // namespace pileus::study
