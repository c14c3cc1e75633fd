// Physical units by UDUNITS-2, the library behind the CF conventions.
#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace pileus {

/// A quantity as people write it: a number, optionally followed by a unit.
struct WrittenQuantity {
  double number = 0;
  std::string unit;  // empty for a bare number
};

/// Splits "33 m", "17 g/kg", "7.2921e-5 rad/s" or "5" into number and unit; nothing when the text
/// does not begin with a decimal number. Leading zeros ("010"), "inf" and "nan" are not numbers
/// here.
std::optional<WrittenQuantity> split_quantity(std::string_view text);

/// What became of a conversion: a value in the wanted unit, or a sentence part saying why not.
struct UnitConversion {
  double value = 0;
  std::string
      problem;  // empty on success; else e.g. "'kg' is not a length; write for example '33 m'"
  bool ok() const { return problem.empty(); }
};

/// How offset units (degrees Celsius) are treated.
enum class Temperature { absolute, difference };

/// Converts `number` from `unit` to `wanted` (UDUNITS text; "1" for pure numbers). An empty `unit`
/// means the number already is in `wanted`. Reciprocals are refused although UDUNITS would convert
/// them, and so are offset units unless `wanted` is K and `kind` says absolute.
UnitConversion convert_units(double number, std::string_view unit, std::string_view wanted,
                             Temperature kind = Temperature::absolute);

/// The number in the coherent SI unit of the same dimension ("2 km" → 2000, "20 degC" → 293.15);
/// nothing for an unknown unit or another unit with an offset.
std::optional<double> to_si(double number, std::string_view unit);

/// Whether UDUNITS knows the unit.
bool is_unit(std::string_view unit);

/// Whether two units are the same unit (factor 1, offset 0), however they are spelt.
bool same_units(std::string_view a, std::string_view b);

/// Name of the dimension of a unit with its article ("a length", "a velocity"), and a value a
/// reader could have written ("33 m").
struct DimensionName {
  std::string name, example;
};
DimensionName describe_dimension(std::string_view unit);

/// Shortest decimal text that reads back as exactly `value`.
std::string shortest(double value);

/// "33 m"; the bare number when `unit` is "1".
std::string with_units(double value, std::string_view unit);

}  // namespace pileus
