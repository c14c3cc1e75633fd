// What a check of a plugin is, and how it says what it found.
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "host/library.hpp"

namespace pileus::conform {

/// Thrown by a check that a plugin does not pass.
struct Finding {
  std::string text;        // what was found, where; one sentence without a full stop
  std::uint64_t uid = 0;   // of the parcel that shows it, 0: none
  std::uint64_t seed = 0;  // of the random state that shows it, 0: none
};
/// Thrown by a check that has nothing to look at.
struct NotApplicable {
  std::string why;
};

[[noreturn]] inline void fail(std::string text, std::uint64_t uid = 0) {
  throw Finding{std::move(text), uid, 0};
}

/// One operator of the library that is looked at.
struct Case {
  std::shared_ptr<const host::Library> library;
  std::shared_ptr<const host::OperatorTable> table;
  std::uint64_t seed = 1;  // of the first random state; the others follow

  const pileus_operator& op() const { return table->op; }
};

/// Passes by returning, perhaps with a remark.
using OperatorCheck = std::string (*)(const Case&);

struct Check {
  const char* id;
  const char* title;  // a few words
  OperatorCheck run;  // null: one of the library, see library_checks.hpp
};

/// C01 to C27 in their order.
std::span<const Check> all_checks();

// One per entry of the catalogue.
std::string check_names_and_units(const Case&);         // C04
std::string check_natures_and_budgets(const Case&);     // C05
std::string check_metadata(const Case&);                // C06
std::string check_parameter_bounds(const Case&);        // C08
std::string check_life_cycle(const Case&);              // C09
std::string check_instances(const Case&);               // C10
std::string check_writes(const Case&);                  // C11
std::string check_repeated_calls(const Case&);          // C12
std::string check_blocks_and_threads(const Case&);      // C13
std::string check_permutation(const Case&);             // C14
std::string check_inactive_parcels(const Case&);        // C15
std::string check_skipping(const Case&);                // C16
std::string check_small_steps(const Case&);             // C17
std::string check_random_states(const Case&);           // C18
std::string check_large_steps(const Case&);             // C19
std::string check_budgets(const Case&);                 // C20
std::string check_split_parcels(const Case&);           // C21
std::string check_restart(const Case&);                 // C22
std::string check_projection_and_closure(const Case&);  // C23
std::string check_environment(const Case&);             // C24
std::string check_errors(const Case&);                  // C25
std::string measure_cost(const Case&);                  // C26
std::string check_own_tests(const Case&);               // C27

}  // namespace pileus::conform
