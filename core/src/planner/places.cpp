#include "planner/places.hpp"

#include <filesystem>

namespace pileus::planner {

Places::Places(const scene::Scene& scene) : file_(scene.path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file_, ignored)) return;
  scene::Problems problems;  // the scene has been read before: there are none
  root_ = scene::load_document(file_, problems);
}

scene::Location Places::of(const std::string& key) const {
  const scene::Node* node = &root_;
  scene::Location where{file_, 0, 0};
  for (std::size_t begin = 0; begin < key.size();) {
    const std::size_t end = std::min(key.find('.', begin), key.size());
    const scene::Entry* entry = node->find(key.substr(begin, end - begin));
    if (entry == nullptr) return {file_, 0, 0};
    where = entry->value.where;
    node = &entry->value;
    begin = end + 1;
  }
  return where;
}

}  // namespace pileus::planner
