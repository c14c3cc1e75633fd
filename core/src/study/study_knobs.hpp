// The declared keys of a study's knobs, and of what a sweep varies in all combinations.
#pragma once
#include <string>

#include "scene/keys.hpp"

namespace pileus::study {

/// One entry of `knobs`.
const scene::Table& knob_table();
/// One entry of a sweep's `product`.
const scene::Table& product_table();

/// What a value is called: its text, or that of its items.
std::string label_of(const scene::Node& value);

}  // namespace pileus::study
