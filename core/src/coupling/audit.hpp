// Proof by sampling that skipped parcels would have stayed as they are.
#pragma once
#include <cstddef>

#include "pileus/abi.h"

namespace pileus::coupling {

/// Whether the block's skipped parcels are to be looked at in this call: true for the given share
/// of blocks, chosen by random numbers keyed by seed, operator, block, step and call.
bool is_audited(double share, const pileus_step& step, std::size_t block);

}  // namespace pileus::coupling
