#include "model/activation_record.hpp"

#include <string_view>

namespace pileus::model {
namespace {

constexpr std::string_view prefix = "activated/";

}  // namespace

void save_activations(const OperatorPhysics& physics, output::NamedData& data) {
  for (const Activation& one : physics.activations()) {
    const std::string key = std::string(prefix) + one.effect;
    data.arrays[key] = {one.time};
    data.counters[key] = {one.step};
    data.texts[key] = one.because;
  }
}

void restore_activations(const output::NamedData& data, OperatorPhysics& physics) {
  std::vector<Activation> all;
  for (const auto& [key, text] : data.texts)
    if (key.starts_with(prefix))
      all.push_back({key.substr(prefix.size()), data.arrays.at(key).at(0),
                     data.counters.at(key).at(0), text});
  physics.restore(std::move(all));
}

}  // namespace pileus::model
