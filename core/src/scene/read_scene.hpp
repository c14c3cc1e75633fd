// From a YAML file to a validated Scene.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "scene/document.hpp"
#include "scene/problems.hpp"
#include "scene/scene.hpp"

namespace pileus::scene {

/// Reads, overrides (`key=value`, dotted keys) and validates a scene; everything wrong with it is
/// collected in `problems`, and the scene is to be used only when there are none.
/// Throws pileus::Error when the file is missing (ExitCode::usage) or unreadable (ExitCode::file).
Scene read_scene(const std::string& path, const std::vector<std::string>& overrides,
                 Problems& problems);

/// As above, with settings that know where they were written.
Scene read_scene_with(const std::string& path, std::span<const Setting> settings,
                      Problems& problems);

/// As the first; throws pileus::Error with ExitCode::usage and all problems.
Scene read_scene(const std::string& path, const std::vector<std::string>& overrides = {});

/// A scene from text; `name` stands for the file in messages and locates relative paths.
Scene read_scene_text(const std::string& name, const std::string& text,
                      const std::vector<std::string>& overrides, Problems& problems);

}  // namespace pileus::scene
