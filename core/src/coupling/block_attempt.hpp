// The state of one apply of one operator on one range, between the parts of the block runner.
#pragma once
#include "coupling/block_runner.hpp"

namespace pileus::coupling {

/// State of one apply of one operator on one range.
struct BlockRunner::Attempt {
  std::size_t which;
  const BoundOperator& bound;
  const pileus_step& step;
  ParcelRange range;
  Workspace& work;
  pileus_block record;
  int calls = 0;
  host::CallResult last{};
};

}  // namespace pileus::coupling
