#include "base/quantities.hpp"

#include <algorithm>
#include <vector>

#include "base/nearest_word.hpp"

namespace pileus {

const Quantity* find_quantity(std::string_view name) {
  const auto all = quantities();
  const auto found = std::find_if(all.begin(), all.end(),
                                  [&](const Quantity& quantity) { return quantity.name == name; });
  return found == all.end() ? nullptr : &*found;
}

std::string nearest_quantity(std::string_view word) {
  std::vector<std::string> names;
  for (const Quantity& quantity : quantities()) names.emplace_back(quantity.name);
  return nearest_word(word, names);
}

}  // namespace pileus
