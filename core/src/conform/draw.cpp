#include "conform/draw.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace pileus::conform {
namespace {

struct TypicalRange {
  std::string_view units;
  Range range;
};
/// Of the air of the lower atmosphere, in parcels of metres to kilometres.
constexpr std::array<TypicalRange, 13> of_air = {{
    {"K", {260, 320}},
    {"1", {0, 1}},
    {"m s-1", {-20, 20}},
    {"m s-2", {-0.1, 0.1}},
    {"s-1", {-0.05, 0.05}},
    {"m", {0, 2000}},
    {"m2", {100, 1e5}},
    {"m3", {1e3, 1e7}},
    {"kg-1", {0, 1e9}},
    {"Pa", {5e4, 1.05e5}},
    {"kg m-3", {0.5, 1.3}},
    {"m2 s-2", {0, 10}},
    {"m6", {1e6, 1e14}},
}};
/// Of cloud particles: droplets of a nanometre to drops of millimetres, and how many of them.
constexpr std::array<TypicalRange, 4> of_particles = {{
    {"kg", {1e-18, 1e-6}},
    {"m3", {1e-24, 1e-15}},
    {"m", {1e-9, 1e-3}},
    {"1", {-1, 1}},
}};

constexpr double unbounded = 1e300;

/// As much water as air holds.
constexpr double most_water = 0.02;

double draw_value(Random& random, const pileus_parameter& p) {
  if (p.low < p.high) return draw_between(random, {p.low, p.high});
  return p.fallback * std::exp2(uniform(random, -2, 2));
}

void draw_choice(Random& random, const pileus_parameter& p, int index,
                 host::ParameterValues& values) {
  int count = 0;
  while (p.choices[count] != nullptr) ++count;
  const int chosen = static_cast<int>(random() % static_cast<unsigned>(count));
  values.set_choice(index, chosen, p.choices[chosen]);
}

/// Up to four points in the lowest kilometres, or within the first hours.
std::vector<double> draw_function(Random& random, const pileus_parameter& p) {
  std::vector<double> pairs;
  const auto points = 1 + random() % 4;
  for (std::size_t k = 0; k < points; ++k) {
    pairs.push_back(static_cast<double>(k) * 700 + uniform(random, 0, 600));
    pairs.push_back(draw_value(random, p));
  }
  return pairs;
}

}  // namespace

double uniform(Random& random, double low, double high) {
  const double u = static_cast<double>(random() >> 11) * 0x1p-53;
  return std::clamp(low + (high - low) * u, low, high);
}

double draw_between(Random& random, Range range) {
  const auto [low, high] = range;
  if (low > 0 && high > 100 * low)
    return std::clamp(std::exp(uniform(random, std::log(low), std::log(high))), low, high);
  if (low >= 0 && random() % 2 == 0)
    return std::clamp(high * std::pow(10.0, uniform(random, -12, 0)), low, high);
  // The difference of two ends may be beyond the largest number.
  return std::clamp(2 * uniform(random, 0.5 * low, 0.5 * high), low, high);
}

Range typical_range(std::string_view units, bool of_items) {
  if (of_items)
    for (const auto& [unit, range] : of_particles)
      if (unit == units) return range;
  for (const auto& [unit, range] : of_air)
    if (unit == units) return range;
  return {-1, 1};
}

Range typical_range(Range declared, std::string_view units, bool of_items, bool is_water) {
  Range range = typical_range(units, of_items);
  if (is_water && !of_items) range.high = std::min(range.high, most_water);
  const Range both{std::max(range.low, declared.low), std::min(range.high, declared.high)};
  if (both.low <= both.high) return both;
  const double size = std::max({1.0, std::abs(range.low), std::abs(range.high)});
  return {std::max(declared.low, -size), std::min(declared.high, std::max(size, declared.low))};
}

Range widest_range(Range declared, std::string_view units, bool of_items) {
  const Range typical = typical_range(units, of_items);
  const double size = 100 * std::max(std::abs(typical.low), std::abs(typical.high));
  if (declared.low < -unbounded) declared.low = std::min(-size, declared.high);
  if (declared.high > unbounded) declared.high = std::max(size, declared.low);
  return declared;
}

double draw_corner(Random& random, Range range) {
  const auto within = [&](double x) { return std::clamp(x, range.low, range.high); };
  switch (random() % 8) {
    case 0:
      return range.low;
    case 1:
      return range.high;
    case 2:
      return within(random() % 2 == 0 ? 0.0 : -0.0);
    case 3:
      return within(std::numeric_limits<double>::denorm_min());
    case 4:
      return within(1e-310);
    default:
      return draw_between(random, range);
  }
}

host::ParameterValues draw_numbers(Random& random, const host::OperatorTable& table,
                                   const host::ParameterValues& values) {
  host::ParameterValues drawn = values;
  for (std::size_t i = 0; i < table.parameters.size(); ++i) {
    const pileus_parameter& p = table.parameters[i];
    if (p.type == PILEUS_NUMBER && host::holds(table.parameter_when[i], values.numbers()))
      drawn.set_number(static_cast<int>(i), draw_value(random, p));
  }
  const bool same = std::all_of(
      table.quantity_when.begin(), table.quantity_when.end(), [&](const host::When& when) {
        return host::holds(when, drawn.numbers()) == host::holds(when, values.numbers());
      });
  return same ? drawn : values;
}

host::ParameterValues draw_parameters(Random& random, const host::OperatorTable& table) {
  host::ParameterValues values(table);
  for (std::size_t i = 0; i < table.parameters.size(); ++i) {
    const pileus_parameter& p = table.parameters[i];
    const int index = static_cast<int>(i);
    if (!host::holds(table.parameter_when[i], values.numbers())) continue;
    switch (p.type) {
      case PILEUS_CHOICE:
        draw_choice(random, p, index, values);
        break;
      case PILEUS_TEXT:
        break;
      case PILEUS_SWITCH:
        values.set_number(index, static_cast<double>(random() % 2));
        break;
      case PILEUS_INTEGER:
        // Numbers of sub-steps and items: large ones are only slow.
        values.set_number(
            index, p.low < p.high
                       ? std::clamp(std::round(p.fallback * uniform(random, 0.5, 2)), p.low, p.high)
                       : p.fallback);
        break;
      case PILEUS_NUMBERS:
        values.set_list(index, {draw_value(random, p)});
        break;
      case PILEUS_PROFILE:
      case PILEUS_SERIES:
        values.set_list(index, draw_function(random, p));
        break;
      default:
        values.set_number(index, draw_value(random, p));
    }
  }
  return values;
}

}  // namespace pileus::conform
