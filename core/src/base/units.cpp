#include "base/units.hpp"

#include <fmt/format.h>
#include <udunits2.h>

#include <array>
#include <charconv>
#include <cmath>
#include <memory>
#include <mutex>

#include "base/error.hpp"

namespace pileus {
namespace {

struct FreeUnit {
  void operator()(ut_unit* unit) const { ut_free(unit); }
};
struct FreeConverter {
  void operator()(cv_converter* converter) const { cv_free(converter); }
};
using UnitPointer = std::unique_ptr<ut_unit, FreeUnit>;
using ConverterPointer = std::unique_ptr<cv_converter, FreeConverter>;

/// The units database, loaded once. UDUNITS keeps its status and parser state in globals, so every
/// use holds the lock.
class Database {
 public:
  Database() {
    ut_set_error_message_handler(ut_ignore);
    system_ = ut_read_xml(nullptr);
    if (system_ == nullptr)
      throw Error(ExitCode::file,
                  "The UDUNITS-2 database of units cannot be read; install the package "
                  "libudunits2-data or point UDUNITS2_XML_PATH at udunits2.xml.");
  }
  ~Database() { ut_free_system(system_); }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  UnitPointer parse(std::string_view text) const {
    const std::string unit(text);
    return UnitPointer(ut_parse(system_, unit.c_str(), UT_UTF8));
  }

 private:
  ut_system* system_ = nullptr;
};

std::mutex& lock() {
  static std::mutex mutex;
  return mutex;
}

const Database& database() {
  static const Database instance;
  return instance;
}

/// A converter between units of the same dimension; null for others. `ut_are_convertible` would
/// also accept reciprocals ("s" for "s-1"), so the quotient is what is looked at.
ConverterPointer converter_between(const ut_unit& from, const ut_unit& to) {
  const UnitPointer quotient(ut_divide(&from, &to));
  if (!quotient || ut_is_dimensionless(quotient.get()) == 0) return nullptr;
  return ConverterPointer(ut_get_converter(const_cast<ut_unit*>(&from), const_cast<ut_unit*>(&to)));
}

std::string_view trimmed(std::string_view text) {
  const auto blank = " \t";
  const std::size_t first = text.find_first_not_of(blank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blank) - first + 1);
}

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

struct KnownDimension {
  std::string_view unit, name, example;
};
constexpr std::array<KnownDimension, 17> known_dimensions = {{
    {"1", "a pure number", "0.5"},
    {"m", "a length", "33 m"},
    {"s", "a time", "10 min"},
    {"K", "a temperature", "300 K"},
    {"kg", "a mass", "1 kg"},
    {"Pa", "a pressure", "1013.25 hPa"},
    {"m2", "an area", "400 m2"},
    {"m3", "a volume", "8000 m3"},
    {"m s-1", "a velocity", "5 m/s"},
    {"m s-2", "an acceleration (buoyancy)", "0.1 m/s2"},
    {"s-1", "a rate (frequency, vorticity)", "0.01 s-1"},
    {"s-2", "a squared rate", "1e-4 s-2"},
    {"m2 s-2", "an energy per mass", "0.5 m2/s2"},
    {"m2 s-1", "a diffusivity", "75 m2/s"},
    {"m-3", "a number concentration", "100 cm-3"},
    {"kg m-3", "a density", "1.2 kg/m3"},
    {"K s-1", "a heating rate", "-2 K/day"},
}};

}  // namespace

std::optional<WrittenQuantity> split_quantity(std::string_view text) {
  text = trimmed(text);
  std::string_view body = text;
  std::string_view digits = body;
  if (!digits.empty() && (digits.front() == '-' || digits.front() == '+')) digits.remove_prefix(1);
  if (!body.empty() && body.front() == '+') body = digits;  // from_chars knows no plus sign
  if (digits.empty()) return std::nullopt;
  const bool starts_as_number =
      is_digit(digits[0]) || (digits[0] == '.' && digits.size() > 1 && is_digit(digits[1]));
  if (!starts_as_number) return std::nullopt;
  // "010" is eight to YAML 1.1 and ten to a reader: neither is taken.
  if (digits.size() > 1 && digits[0] == '0' && is_digit(digits[1])) return std::nullopt;

  WrittenQuantity quantity;
  const auto [end, status] =
      std::from_chars(body.data(), body.data() + body.size(), quantity.number);
  if (status != std::errc() || !std::isfinite(quantity.number)) return std::nullopt;
  const std::string_view rest(end, static_cast<std::size_t>(body.data() + body.size() - end));
  if (!rest.empty() && (rest[0] == '_' || rest[0] == '.' || rest[0] == ',')) return std::nullopt;
  quantity.unit = trimmed(rest);
  return quantity;
}

UnitConversion convert_units(double number, std::string_view unit, std::string_view wanted,
                             Temperature kind) {
  if (unit.empty()) return {number, {}};
  const std::lock_guard guard(lock());
  const UnitPointer from = database().parse(unit);
  const DimensionName dimension = describe_dimension(wanted);
  if (!from)
    return {0, fmt::format("'{}' is not a unit; expected {} such as '{}'", unit, dimension.name,
                           dimension.example)};
  const UnitPointer to = database().parse(wanted);
  if (!to) return {0, fmt::format("the declared unit '{}' is not known to UDUNITS", wanted)};
  const ConverterPointer converter = converter_between(*from, *to);
  if (!converter)
    return {0, fmt::format("'{}' does not measure {}; expected a value such as '{}'", unit,
                           dimension.name, dimension.example)};
  const double offset = cv_convert_double(converter.get(), 0.0);
  if (offset != 0 && (kind == Temperature::difference || trimmed(wanted) != "K"))
    return {0, fmt::format("'{}' has its zero elsewhere and cannot state a difference; write it in "
                           "'{}'",
                           unit, wanted)};
  return {cv_convert_double(converter.get(), number), {}};
}

std::optional<double> to_si(double number, std::string_view unit) {
  if (const UnitConversion kelvin = convert_units(number, unit, "K"); kelvin.ok())
    return kelvin.value;
  const std::lock_guard guard(lock());
  const UnitPointer parsed = database().parse(unit);
  if (!parsed) return std::nullopt;
  // The definition of a unit is "[factor ]base units[ @ offset]".
  std::array<char, 256> buffer{};
  const int length =
      ut_format(parsed.get(), buffer.data(), buffer.size(), UT_ASCII | UT_DEFINITION);
  if (length < 0 || length >= static_cast<int>(buffer.size())) return std::nullopt;
  const std::string_view definition(buffer.data(), static_cast<std::size_t>(length));
  if (definition.find_first_of("@(") != std::string_view::npos) return std::nullopt;
  const auto factor = split_quantity(definition);
  const std::string base = factor ? factor->unit : std::string(definition);
  if (base.empty()) return factor ? number * factor->number : number;
  const UnitPointer target = database().parse(base);
  const ConverterPointer converter = target ? converter_between(*parsed, *target) : nullptr;
  if (!converter) return std::nullopt;
  return cv_convert_double(converter.get(), number);
}

bool is_unit(std::string_view unit) {
  const std::lock_guard guard(lock());
  return database().parse(unit) != nullptr;
}

bool same_units(std::string_view a, std::string_view b) {
  const std::lock_guard guard(lock());
  const UnitPointer first = database().parse(a), second = database().parse(b);
  return first && second && ut_compare(first.get(), second.get()) == 0;
}

DimensionName describe_dimension(std::string_view unit) {
  for (const KnownDimension& known : known_dimensions)
    if (known.unit == unit) return {std::string(known.name), std::string(known.example)};
  return {fmt::format("a quantity in '{}'", unit), fmt::format("1 {}", unit)};
}

std::string shortest(double value) {
  std::array<char, 32> buffer;
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), result.ptr};
}

std::string with_units(double value, std::string_view unit) {
  return unit == "1" ? shortest(value) : fmt::format("{} {}", shortest(value), unit);
}

}  // namespace pileus
