#include "study/file_keys.hpp"

#include <fmt/format.h>

namespace pileus::study {

using scene::Entry;
using scene::Node;

scene::Key extends_key(const std::string& kind) {
  scene::Key key;
  key.name = "extends";
  key.type = scene::KeyType::custom;
  key.doc = fmt::format("Another {}, relative to this one, that this one changes.", kind);
  key.default_doc = "none";
  key.read = [](scene::Reader&, const Entry&, void*) {};
  key.write = [](const void*) -> scene::Json { return nullptr; };
  key.schema = [] { return scene::Json{{"type", "string"}}; };
  return key;
}

void read_settings(scene::Reader& reader, const std::string& name, const Node& node,
                   std::vector<scene::Setting>& settings) {
  if (node.kind != Node::Kind::mapping)
    reader.problem(node, fmt::format("'{}' is a mapping from keys of the scene to values "
                                     "(time.end: 20 s), found {}",
                                     name, describe(node)));
  for (const Entry& one : node.entries) settings.push_back({one.key, one.value, one.where});
}

void read_seeds(scene::Reader& reader, const Node& node, std::vector<std::uint64_t>& seeds) {
  if (node.kind != Node::Kind::list)
    return reader.problem(
        node, fmt::format("'seeds' is a list of whole numbers, found {}", describe(node)));
  scene::Key seed;
  seed.name = "seeds";
  seed.range.low = 0;
  std::int64_t value = 0;
  for (const Node& item : node.items)
    if (reader.integer(item, seed, value)) seeds.push_back(static_cast<std::uint64_t>(value));
}

scene::Json list_of_seeds() {
  return scene::Json{{"type", "array"}, {"items", {{"type", "integer"}, {"minimum", 0}}}};
}

}  // namespace pileus::study
