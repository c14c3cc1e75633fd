#include "model/private_state_record.hpp"

#include <string_view>

namespace pileus::model {
namespace {

constexpr std::string_view prefix = "private_state/";

}  // namespace

void save_private_states(const coupling::OperatorSequence& sequence, output::NamedData& data) {
  for (auto& [name, state] : sequence.private_states()) {
    const std::string key = std::string(prefix) + name;
    data.counters[key] = {state.format};
    data.bytes[key] = state.bytes;
  }
}

coupling::PrivateStates private_states_of(const output::NamedData& data) {
  coupling::PrivateStates states;
  for (const auto& [key, bytes] : data.bytes)
    if (key.starts_with(prefix))
      states[key.substr(prefix.size())] = {static_cast<std::uint32_t>(data.counters.at(key).at(0)),
                                           bytes};
  return states;
}

}  // namespace pileus::model
