#include "study/scene_settings.hpp"

#include <cctype>
#include <filesystem>

#include "host/search.hpp"
#include "scene/tree.hpp"

namespace pileus::study {

scene::Setting text_setting(std::string key, const std::string& value,
                            const scene::Location& where) {
  scene::Setting setting{std::move(key), {}, where};
  setting.value.kind = scene::Node::Kind::scalar;
  setting.value.text = value;
  setting.value.where = where;
  return setting;
}

std::vector<std::string> assignments(const std::vector<scene::Setting>& settings) {
  std::vector<std::string> words;
  for (const scene::Setting& setting : settings)
    words.push_back(setting.key + "=" + scene::flow_text(setting.value));
  return words;
}

std::vector<coupling::OperatorEntry> operators_of(const scene::Scene& scene,
                                                  const std::string& scene_path,
                                                  scene::Problems& problems) {
  return coupling::load_operators(
      scene, host::default_search_path(std::filesystem::path(scene_path).parent_path()), problems);
}

bool is_same(const scene::Problem& a, const scene::Problem& b) {
  return a.text == b.text && a.where.file == b.where.file && a.where.line == b.where.line &&
         a.where.column == b.where.column;
}

std::string last_word(const std::string& key) {
  const std::size_t dot = key.rfind('.');
  return key.substr(dot == std::string::npos ? 0 : dot + 1);
}

std::string identifier(const std::string& text) {
  std::string name;
  for (const char c : text) name += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  return name;
}

}  // namespace pileus::study
