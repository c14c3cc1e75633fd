// The private states of operators in the checkpoints of a run.
#pragma once
#include "coupling/operator_sequence.hpp"
#include "output/named_data.hpp"

namespace pileus::model {

void save_private_states(const coupling::OperatorSequence& sequence, output::NamedData& data);
coupling::PrivateStates private_states_of(const output::NamedData& data);

}  // namespace pileus::model
