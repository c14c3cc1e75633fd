// Scalars of a scene: numbers with units, integers, switches.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "base/units.hpp"

namespace pileus::scene {

using Constants = std::map<std::string, double>;

/// A value, or the sentence that says what was expected and found.
struct NumberResult {
  double value = 0;
  std::string problem;
  std::size_t position = 0;  // where in the text the problem is
  bool ok() const { return problem.empty(); }
};

/// Reads "33 m", "0.5", "4*pi m" or "2*H + 100" (SI) in the given unit. A number followed by a unit
/// is converted; otherwise the text is a formula of the constants, optionally followed by a unit.
NumberResult read_number(const std::string& text, const std::string& units,
                         const Constants& constants, Temperature kind = Temperature::absolute);

/// A decimal integer without sign tricks; nothing for "010", "0x10", "1e3", "1_000" or "3.0".
std::optional<std::int64_t> read_integer(const std::string& text);

/// true/yes/on or false/no/off.
std::optional<bool> read_switch(const std::string& text);

}  // namespace pileus::scene
