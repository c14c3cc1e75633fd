// Points of the unit cube at which a sweep samples its ranges.
#pragma once
#include <cstdint>
#include <vector>

namespace pileus::study {

enum class SampleMethod { random, latin_hypercube, sobol };

/// As many as the table of direction numbers has.
inline constexpr std::size_t most_sample_dimensions = 3667;

/// `count` points of the unit cube of so many dimensions, by point; a function of its arguments
/// alone.
///   random           independent, uniform
///   latin_hypercube  in every dimension one point in each of `count` equal strata (McKay et al.
///                    1979, doi:10.1080/00401706.1979.10489755)
///   sobol            the first points, zero included, of the sequence of Sobol with the direction
///                    numbers of Joe and Kuo (2008, doi:10.1137/070709359); any seed but 0 shifts
///                    them digit by digit, which keeps what is even about them
/// Requires  dimensions ≤ most_sample_dimensions
std::vector<std::vector<double>> sample_unit_cube(SampleMethod method, std::size_t count,
                                                  std::size_t dimensions, std::uint64_t seed);

}  // namespace pileus::study
