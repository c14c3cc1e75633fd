// The declared keys of a study's knobs.
#pragma once
#include "scene/keys.hpp"

namespace pileus::study {

/// One entry of `knobs`.
const scene::Table& knob_table();

}  // namespace pileus::study
