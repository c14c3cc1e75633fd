// What an operator needs around it to be called: somebody who makes the items that it works on and
// owns the fields of the ground that it reads, and quantities that the initial state sets.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "conform/check.hpp"
#include "coupling/operator_entry.hpp"

namespace pileus::conform {

class Surroundings {
 public:
  /// The subject with the given parameters. Items are made by another operator of its library or,
  /// where none does, by a stand-in without hooks.
  Surroundings(const Case& subject, host::ParameterValues values);

  /// The subject is the first.
  const std::vector<coupling::OperatorEntry>& entries() const { return entries_; }
  /// Quantities of the parcels that the initial state sets: all that are carried.
  std::vector<std::string> initial() const;
  /// Whether the items have to be filled in, because nobody real makes them.
  bool stands_in_for_maker() const { return stands_in_for_maker_; }

 private:
  void add_maker(const Case& subject);
  void add_stand_in();
  bool is_provided(const pileus_quantity& row) const;

  std::vector<coupling::OperatorEntry> entries_;
  bool stands_in_for_maker_ = false;
};

}  // namespace pileus::conform
