// What a library declares, for people and for programs.
#pragma once
#include <cstdint>
#include <string>

#include "host/library.hpp"
#include "host/search.hpp"

namespace pileus::host {

/// "owns, reads, writes" of the bits of pileus_quantity.access.
std::string access_words(std::uint32_t access);

/// Everything the operators of a library declare, as text for a terminal.
std::string describe_text(const Library& library);

/// The same as a JSON document, indented by two.
std::string describe_json(const Library& library);

/// A table of the libraries a search finds, and what is wrong with those that are refused.
std::string describe_candidates(const SearchPath& search);

/// The same as JSON: a list of {path, module, version} or {path, refusal}.
std::string describe_candidates_json(const SearchPath& search);

}  // namespace pileus::host
