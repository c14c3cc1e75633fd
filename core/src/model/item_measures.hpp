// Sums over the items of all parcels: how many there are, what they hold, how wide they spread.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "parcels/store.hpp"

namespace pileus::model {

/// Moments of what every thing of an item has: total of multiplicity times value, and of its
/// square.
class ItemMeasures {
 public:
  explicit ItemMeasures(const parcels::ItemLists& items);

  /// Name, units and description of what measure() gives; empty in a run without items.
  const std::vector<std::array<std::string, 3>>& outputs() const { return outputs_; }
  /// Values of the outputs, summed in an order that depends on the number of items alone.
  std::vector<double> measure(const parcels::ItemLists& items) const;

 private:
  std::vector<std::array<std::string, 3>> outputs_;
  std::vector<int> columns_;  // of each
};

/// Total of the items' part of a budget, in the budget's unit.
double budget_of_items(const parcels::ItemLists& items, const std::string& budget);

}  // namespace pileus::model
