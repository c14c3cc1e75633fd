// Effects that were switched on during a run, in its checkpoints.
#pragma once
#include "model/operator_physics.hpp"
#include "output/named_data.hpp"

namespace pileus::model {

void save_activations(const OperatorPhysics& physics, output::NamedData& data);

/// Switches on what had been switched on when the checkpoint was written.
void restore_activations(const output::NamedData& data, OperatorPhysics& physics);

}  // namespace pileus::model
