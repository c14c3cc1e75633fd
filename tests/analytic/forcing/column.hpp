// Parcels over a column, and the profiles of trade-wind cumulus (Siebesma et al. 2003,
// doi:10.1175/1520-0469(2003)60<1201:ALESIS>2.0.CO;2; BOMEX).
#pragma once
#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "../../../plugins/large_scale_forcing/level_means.hpp"

namespace pileus::large_scale {

struct Cloud {
  std::vector<double> height, volume;

  Column column() const {
    return {height.data(), volume.data(), static_cast<std::int64_t>(height.size())};
  }
};

/// `per_cell` equal parcels in each of the layers between levels, evenly spread.
inline Cloud even_cloud(const Levels& levels, std::size_t per_cell) {
  Cloud cloud;
  const std::size_t n = levels.cells * per_cell;
  for (std::size_t p = 0; p < n; ++p) {
    const double part = (static_cast<double>(p) + 0.5) / static_cast<double>(n);
    cloud.height.push_back(levels.bottom + part * levels.depth());
    cloud.volume.push_back(levels.depth() / static_cast<double>(n));
  }
  return cloud;
}

/// Parcels of any size anywhere, walls included.
inline Cloud random_cloud(const Levels& levels, std::size_t count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> at(levels.bottom, levels.top()), size(0.1, 3.0);
  Cloud cloud;
  for (std::size_t p = 0; p < count; ++p) {
    cloud.height.push_back(p == 0 ? levels.bottom : p == 1 ? levels.top() : at(random));
    cloud.volume.push_back(size(random));
  }
  return cloud;
}

/// Chunks in ascending order, as one thread takes them.
inline constexpr auto in_order = [](std::int64_t n, std::int64_t grain, auto&& body) {
  for (std::int64_t begin = 0; begin < n; begin += grain) body(begin, std::min(begin + grain, n));
};
/// Chunks in descending order, as several threads might.
inline constexpr auto backwards = [](std::int64_t n, std::int64_t grain, auto&& body) {
  for (std::int64_t begin = (n - 1) / grain * grain; begin >= 0; begin -= grain)
    body(begin, std::min(begin + grain, n));
};

struct Gathered {
  template <class InChunks>
  Gathered(const Levels& levels, const Cloud& cloud, std::vector<const double*> quantities,
           InChunks&& in_chunks)
      : room(LevelMeans::room(levels, cloud.column().count, quantities.size())),
        means(levels, cloud.column(), quantities, room, in_chunks) {}
  std::vector<double> room;
  LevelMeans means;
};

}  // namespace pileus::large_scale
