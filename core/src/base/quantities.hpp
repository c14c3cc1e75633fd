// The registered quantities: the table of schemas/quantities.yaml, compiled in.
#pragma once
#include <span>
#include <string>
#include <string_view>

namespace pileus {

struct Quantity {
  std::string_view name;
  std::string_view units;          // UDUNITS
  std::string_view symbol;         // for axes and captions
  std::string_view definition;     // one line
  std::string_view standard_name;  // CF; empty where the CF table has none
  bool carried = true;             // parcels can carry it; false: always derived
};

/// All of them, in the order of the file.
std::span<const Quantity> quantities();

/// The quantity of that name, or null.
const Quantity* find_quantity(std::string_view name);

/// The registered name closest to a word, or an empty string.
std::string nearest_quantity(std::string_view word);

}  // namespace pileus
