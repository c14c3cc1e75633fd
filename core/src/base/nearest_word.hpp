// "Did you mean …?": the closest word of a list.
#pragma once
#include <span>
#include <string>
#include <string_view>

namespace pileus {

/// The candidate with the smallest edit distance (optimal string alignment) to `word`, or an empty
/// string when none is within max(1, length/3) edits. Ties go to the first candidate.
std::string nearest_word(std::string_view word, std::span<const std::string> candidates);

}  // namespace pileus
