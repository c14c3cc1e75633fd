#include "coupling/parameters.hpp"

#include <algorithm>
#include <vector>

#include "coupling/operator_entry.hpp"
#include "scene/parameters.hpp"

namespace pileus::coupling {
namespace {

scene::ParameterType type_of(std::uint32_t type) {
  switch (type) {
    case PILEUS_INTEGER:
      return scene::ParameterType::integer;
    case PILEUS_SWITCH:
      return scene::ParameterType::toggle;
    case PILEUS_CHOICE:
      return scene::ParameterType::choice;
    case PILEUS_TEXT:
      return scene::ParameterType::text;
    case PILEUS_NUMBERS:
      return scene::ParameterType::numbers;
    case PILEUS_PROFILE:
      return scene::ParameterType::profile;
    case PILEUS_SERIES:
      return scene::ParameterType::series;
    default:
      return scene::ParameterType::number;
  }
}

scene::ParameterDeclaration declaration(const pileus_parameter& p) {
  scene::ParameterDeclaration declared;
  declared.name = p.name;
  declared.type = type_of(p.type);
  declared.units = p.units;
  declared.doc = p.doc != nullptr ? p.doc : "";
  declared.fallback = p.fallback;
  declared.low = p.low;
  declared.high = p.high;
  for (const char* const* word = p.choices; word != nullptr && *word != nullptr; ++word) {
    declared.choices.emplace_back(*word);
  }
  declared.text_fallback = p.text_fallback != nullptr ? p.text_fallback : "";
  declared.when = p.when != nullptr ? p.when : "";
  return declared;
}

}  // namespace

std::vector<scene::ParameterDeclaration> declared_parameters(const host::OperatorTable& table) {
  std::vector<scene::ParameterDeclaration> declared;
  for (const pileus_parameter& p : table.parameters) declared.push_back(declaration(p));
  return declared;
}

host::ParameterValues read_parameters(const scene::OperatorBlock& block,
                                      const host::OperatorTable& table, const scene::Scene& scene,
                                      scene::Problems& problems) {
  scene::OperatorBlock own = block;  // without the key that is the coupling's
  std::erase_if(own.parameters, [](const auto& entry) { return entry.first == substeps_key; });
  const scene::ParameterValues read =
      scene::validate_parameters(own, declared_parameters(table), scene.constants, problems);
  host::ParameterValues values(table);
  for (std::size_t i = 0; i < table.parameters.size(); ++i) {
    const int index = static_cast<int>(i);
    switch (table.parameters[i].type) {
      case PILEUS_CHOICE:
        values.set_choice(index, static_cast<int>(read.number[i]), read.text[i]);
        break;
      case PILEUS_TEXT:
        values.set_text(index, read.text[i]);
        break;
      case PILEUS_NUMBERS:
      case PILEUS_PROFILE:
      case PILEUS_SERIES:
        values.set_list(index, read.list[i]);
        break;
      default:
        values.set_number(index, read.number[i]);
    }
  }
  return values;
}

}  // namespace pileus::coupling
