// What the sequence remembers about an operator between calls.
#pragma once
#include <cstdint>
#include <limits>
#include <vector>

#include "coupling/ledger.hpp"

namespace pileus::coupling {

struct OperatorProgress {
  std::uint64_t diagnosed_at = 0;  // version of its inputs when diagnose last ran
  std::uint64_t demanded_at = 0;   // the same, when it last was asked for everything it derives
  std::uint64_t idle_at = 0;       // version of its conditions when last nobody was active
  double step_limit = std::numeric_limits<double>::infinity();  // s, of its last prepare
  std::vector<int> condition_columns;                           // what the conditions read
  std::vector<CompensatedSum> change, source;                   // per budget
};

}  // namespace pileus::coupling
