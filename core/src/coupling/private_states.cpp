// What operators keep beside their quantities, on its way to a checkpoint and back.
#include <fmt/format.h>

#include "base/error.hpp"
#include "coupling/operator_sequence.hpp"

namespace pileus::coupling {
namespace {

/// Hands an instance its part of a checkpoint, which has to be there exactly if it is asked for.
void resume_operator(BoundOperator& bound, const PrivateStates& states) {
  const std::string& name = bound.entry->name;
  const char* id = bound.op().id;
  const auto found = states.find(name);
  const bool keeps = bound.instance->keeps_state();
  if (keeps && found == states.end())
    throw Error(ExitCode::usage,
                fmt::format("it holds no private state of operator '{}', which {} expects "
                            "({}): another version of the plugin wrote it, or a scene without this "
                            "operator; continue with what wrote it, or start anew",
                            name, id, PILEUS_STATE_EXTENSION));
  if (!keeps && found != states.end())
    throw Error(ExitCode::usage,
                fmt::format("it holds private state of operator '{}', which {} does not "
                            "take ({}): another version of the plugin wrote it; continue with that "
                            "one, or start anew",
                            name, id, PILEUS_STATE_EXTENSION));
  bound.instance->resume();
  if (keeps) bound.instance->load_state(found->second);
}

}  // namespace

void OperatorSequence::resume(const StepTime& step, const PrivateStates& states) {
  prepare_workspaces();
  for (const std::size_t which : order_of_init()) resume_operator(bound_[which], states);
  population_changed();
  diagnose(step);
}

PrivateStates OperatorSequence::private_states() const {
  PrivateStates states;
  for (const BoundOperator& bound : bound_)
    if (bound.instance->keeps_state()) states[bound.entry->name] = bound.instance->save_state();
  return states;
}

}  // namespace pileus::coupling
