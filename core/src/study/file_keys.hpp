// Keys that the files of studies and of sweeps share.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "scene/keys.hpp"
#include "scene/reader.hpp"

namespace pileus::study {

/// `extends`: another file of the kind; it is followed when the file is loaded.
scene::Key extends_key(const std::string& kind);

/// The entries of a mapping from keys of the scene to values.
void read_settings(scene::Reader& reader, const std::string& name, const scene::Node& node,
                   std::vector<scene::Setting>& settings);

/// A key that holds such a mapping.
template <class File>
scene::Key settings_key(const std::string& name, std::vector<scene::Setting> File::*member,
                        const std::string& doc) {
  scene::Key key;
  key.name = name;
  key.type = scene::KeyType::custom;
  key.doc = doc;
  key.default_doc = "none";
  key.read = [member, name](scene::Reader& reader, const scene::Entry& entry, void* object) {
    read_settings(reader, name, entry.value, static_cast<File*>(object)->*member);
  };
  key.write = [](const void*) -> scene::Json { return nullptr; };
  key.schema = [] { return scene::Json{{"type", "object"}}; };
  return key;
}

/// Name, title and description of a file, in the section `path`.
template <class File>
scene::Table identity_of(const char* path, const char* doc, const char* name_doc,
                         const char* description_doc) {
  return {
      .path = path,
      .doc = doc,
      .keys =
          {scene::value("name", &File::name, "1", name_doc).otherwise("the name of the file"),
           scene::value("title", &File::title, "1", "One line for tables and pictures.")
               .otherwise("the name"),
           scene::value("description", &File::description, "1", description_doc).otherwise("none")},
      .other = {},
      .finish = {},
      .write_other = {},
      .amend_schema = {}};
}

/// A list of seeds, whole numbers from 0.
void read_seeds(scene::Reader& reader, const scene::Node& node, std::vector<std::uint64_t>& seeds);
scene::Json list_of_seeds();

}  // namespace pileus::study
