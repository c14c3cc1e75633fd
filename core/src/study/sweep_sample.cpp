#include "study/sweep_sample.hpp"

#include <algorithm>
#include <boost/random/sobol.hpp>
#include <cmath>
#include <numeric>

#include "base/random.hpp"

namespace pileus::study {

namespace {

constexpr std::uint32_t stream = 0x53574550;  // of sweeps, that no operator of a run has

/// What a draw of a point's coordinate is for.
enum class Draw : std::uint32_t { place, order, shift };

double draw(std::uint64_t seed, std::size_t point, std::size_t dimension, Draw what) {
  DrawKey key;
  key.seed = seed;
  key.stream = stream;
  key.uid = point;
  key.number = dimension;
  key.channel = static_cast<std::uint32_t>(what);
  return draw_one(key);
}

using Points = std::vector<std::vector<double>>;

void fill_random(Points& points, std::uint64_t seed) {
  for (std::size_t p = 0; p < points.size(); ++p)
    for (std::size_t d = 0; d < points[p].size(); ++d) points[p][d] = draw(seed, p, d, Draw::place);
}

void fill_latin_hypercube(Points& points, std::uint64_t seed, std::size_t dimensions) {
  const std::size_t count = points.size();
  std::vector<std::size_t> stratum(count);
  for (std::size_t d = 0; d < dimensions; ++d) {
    std::iota(stratum.begin(), stratum.end(), std::size_t{0});
    for (std::size_t p = count; p-- > 1;) {  // Fisher and Yates
      const double place = draw(seed, p, d, Draw::order) * static_cast<double>(p + 1);
      std::swap(stratum[p], stratum[std::min(p, static_cast<std::size_t>(place))]);
    }
    for (std::size_t p = 0; p < count; ++p)
      points[p][d] = (static_cast<double>(stratum[p]) + draw(seed, p, d, Draw::place)) /
                     static_cast<double>(count);
  }
}

void fill_sobol(Points& points, std::uint64_t seed, std::size_t dimensions) {
  constexpr int digits = 53;  // of a double
  std::vector<std::uint64_t> shift(dimensions, 0);
  if (seed != 0)
    for (std::size_t d = 0; d < dimensions; ++d)
      shift[d] = static_cast<std::uint64_t>(std::ldexp(draw(seed, 0, d, Draw::shift), digits));
  boost::random::sobol sequence(dimensions);
  for (std::size_t p = 0; p < points.size(); ++p) {
    for (std::size_t d = 0; d < dimensions; ++d) {
      // The library leaves out the first point, zero.
      const std::uint64_t word = p == 0 ? 0 : std::uint64_t{sequence()} >> (64 - digits);
      points[p][d] = std::ldexp(static_cast<double>(word ^ shift[d]), -digits);
    }
  }
}

}  // namespace

std::vector<std::vector<double>> sample_unit_cube(SampleMethod method, std::size_t count,
                                                  std::size_t dimensions, std::uint64_t seed) {
  Points points(count, std::vector<double>(dimensions));
  if (method == SampleMethod::random)
    fill_random(points, seed);
  else if (method == SampleMethod::latin_hypercube)
    fill_latin_hypercube(points, seed, dimensions);
  else
    fill_sobol(points, seed, dimensions);
  return points;
}

}  // namespace pileus::study
