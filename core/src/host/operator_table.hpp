// An operator's declarations, checked and copied out of the library's tables.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pileus/abi.h"

namespace pileus::host {

/// One comparison of a `when`: a parameter against a literal, or an effect against "on".
struct WhenTerm {
  std::uint32_t index;  // of the parameter or effect
  bool equal;           // ==, else !=
  double value;         // the literal as pileus_values.number holds it; 1 for "on"
  bool is_effect = false;
};
/// All terms must hold; no term: always.
using When = std::vector<WhenTerm>;

/// The tables of one operator. Rows are full-length copies: members that an older plugin's rows do
/// not reach are zero. The texts they point to live in the library, which is never unloaded.
struct OperatorTable {
  pileus_operator op{};
  std::vector<pileus_reference> references;
  std::vector<pileus_quantity> quantities;
  std::vector<pileus_parameter> parameters;
  std::vector<pileus_effect> effects;
  std::vector<pileus_condition> active_if;
  std::vector<std::string> budgets;
  std::vector<When> quantity_when, parameter_when, effect_when;  // one per row

  std::string library;  // path of the file
  std::string module;   // from the note
  std::string module_version;
  std::string toolchain;

  /// Index of a parameter or of a quantity, or −1.
  int find_parameter(std::string_view name) const;
  int find_quantity(std::string_view name) const;
};

/// True if all terms hold for the given parameter numbers; `effects` says which of the operator's
/// effects are on, NULL: all.
bool holds(const When& when, const double* numbers, const std::uint8_t* effects = nullptr);

/// A condition in the syntax of `when` on this operator; nothing if it names a parameter or a value
/// that the operator does not have.
std::optional<When> read_condition(const std::string& text, const OperatorTable& table);

/// Checks every row of an operator's tables and copies them.
///
/// Each mistake is added to `complaints` as one sentence; the result is only meaningful when none
/// was added. Pointers to readable memory are assumed; everything else may be wrong.
OperatorTable read_operator(const pileus_operator* row, std::vector<std::string>& complaints);

}  // namespace pileus::host
