// Lines for people: text broken at spaces.
#pragma once
#include <cstddef>
#include <string>

namespace pileus {

/// Columns of what the program prints for people.
inline constexpr std::size_t page_width = 100;

/// The text in lines of at most page_width columns where its words allow it; it begins in column
/// `indent`, as do all further lines.
std::string wrap_text(const std::string& text, std::size_t indent);

}  // namespace pileus
