// From a failed block to the bundle and the sentence the user reads.
#pragma once
#include <memory>
#include <string>

#include "coupling/block_runner.hpp"
#include "coupling/failure.hpp"

namespace pileus::coupling {

/// Collects operator, circumstances and, for calls on a block, its inputs; finds out whether a
/// value handed in was already broken.
std::shared_ptr<const FailureBundle> make_bundle(const BoundOperator& bound,
                                                 const parcels::Store& store,
                                                 const ParcelRange& range,
                                                 const BlockFailure& failure, const char* phase);

/// One sentence naming operator, phase, step, parcel, quantity, value and what may help.
std::string describe_failure(const FailureBundle& bundle);

}  // namespace pileus::coupling
