// Where a key of a scene stands, for the source of a fact.
#pragma once
#include <string>

#include "scene/document.hpp"
#include "scene/scene.hpp"

namespace pileus::planner {

class Places {
 public:
  /// Reads the scene's file again; a scene without a file has no places.
  explicit Places(const scene::Scene& scene);
  /// Place of a dotted key; the file alone where the key is not written.
  scene::Location of(const std::string& key) const;

 private:
  std::string file_;
  scene::Node root_;
};

}  // namespace pileus::planner
