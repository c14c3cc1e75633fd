// Random values within declared ranges, the same for the same seed.
#pragma once
#include <cstdint>
#include <random>
#include <string_view>

#include "conform/check.hpp"
#include "host/parameter_values.hpp"
#include "pileus/philox.hpp"

namespace pileus::conform {

using Random = std::mt19937_64;

struct Range {
  double low = 0, high = 0;
};

double uniform(Random& random, double low, double high);
/// Between the ends, on a logarithmic scale where they span decades.
double draw_between(Random& random, Range range);

/// What a quantity is in an atmosphere, by its unit; where that is unknown, of order one.
Range typical_range(std::string_view units, bool of_items);
/// The typical part of a declared range, or all of it where the two do not meet.
Range typical_range(Range declared, std::string_view units, bool of_items, bool is_water);
/// The whole of a declared range; where that has no end, well beyond the typical one.
Range widest_range(Range declared, std::string_view units, bool of_items);

/// An end of the range, zero, the smallest numbers, or anything between.
double draw_corner(Random& random, Range range);

/// Admissible values of all parameters whose condition holds; the others keep their defaults. They
/// may still contradict each other.
host::ParameterValues draw_parameters(Random& random, const host::OperatorTable& table);
/// Other numbers than `values` where the same quantities exist with them; else the same.
host::ParameterValues draw_numbers(Random& random, const host::OperatorTable& table,
                                   const host::ParameterValues& values);

}  // namespace pileus::conform
