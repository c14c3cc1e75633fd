// What an ensemble says of a quantity at one time: mean, spread and percentiles over its members.
#pragma once
#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace pileus::study {

inline constexpr std::array<int, 5> percentiles = {5, 25, 50, 75, 95};

struct MemberStatistics {
  double mean, deviation;  // the latter with the number of members as divisor
  std::array<double, percentiles.size()> at_percentile;
};

/// Of the values that are numbers; NaN when there is none. Percentiles lie on the straight lines
/// between the sorted values, as numpy's do by default. Reorders the values.
MemberStatistics statistics_of(std::vector<double>& values);

/// Rows of `width` values at ascending nodes, at other places by linear interpolation between the
/// rows: exact at nodes, NaN beyond the first and last.
std::vector<double> interpolate_rows(std::span<const double> nodes, std::span<const double> values,
                                     std::size_t width, std::span<const double> places);

/// Times at which members of different record times are compared: theirs where they all agree,
/// else the multiples of `every` up to the latest record, and that one. With `every` ≤ 0 as many
/// as the shortest has.
std::vector<double> common_times(const std::vector<std::vector<double>>& times, double every);

}  // namespace pileus::study
