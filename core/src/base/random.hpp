// Counter-based random numbers (Philox4x32-10 by Random123): a draw depends on what it is for,
// never on what was drawn before. The keys are those of pileus/philox.hpp.
#pragma once
#include <span>

#include "pileus/philox.hpp"

namespace pileus {

/// Fills `out` with draws 0 … size−1 of a key, each uniform in the open interval (0,1).
/// Requires  out.size() ≤ most_draws, key.call < 1024, key.channel < 64
void draw_random(const DrawKey& key, std::span<double> out);

/// The first draw of a key.
double draw_one(const DrawKey& key);

}  // namespace pileus
