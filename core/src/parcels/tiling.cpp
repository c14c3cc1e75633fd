#include "parcels/tiling.hpp"

#include <limits>

namespace pileus::parcels {
namespace {

/// Edges of an even number of tiles, each wider than twice the reach; one tile when the direction
/// is too short for two.
std::vector<int> cut(int cells, int reach) {
  const int narrowest = 2 * reach + 1;
  int tiles = cells / (2 * narrowest) * 2;
  if (tiles < 2) tiles = 1;
  std::vector<int> edges;
  for (int t = 0; t <= tiles; ++t)
    edges.push_back(static_cast<int>(static_cast<long long>(cells) * t / tiles));
  return edges;
}

}  // namespace

template <int D>
Tiling<D>::Tiling(const mesh::Grid<D>& grid) {
  const std::vector<int> x = cut(grid.nx(), reach);
  const std::vector<int> y = D == 3 ? cut(grid.ny(), reach) : std::vector<int>{0, 1};
  const int nx_tiles = static_cast<int>(x.size()) - 1, ny_tiles = static_cast<int>(y.size()) - 1;
  colours_.resize((nx_tiles > 1 ? 2 : 1) * (ny_tiles > 1 ? 2 : 1));
  column_rank_.resize(grid.columns());
  const auto writable = [](int begin, int end, int tiles, int cells, std::int32_t& first,
                           std::int32_t& count) {
    first = tiles > 1 ? (begin - reach + cells) % cells : 0;
    count = tiles > 1 ? end - begin + 2 * reach : std::numeric_limits<std::int32_t>::max();
  };
  std::uint32_t rank = 0;
  for (int tj = 0; tj < ny_tiles; ++tj)
    for (int ti = 0; ti < nx_tiles; ++ti) {
      Tile tile;
      writable(x[ti], x[ti + 1], nx_tiles, grid.nx(), tile.first[0], tile.count[0]);
      writable(y[tj], y[tj + 1], ny_tiles, grid.ny(), tile.first[1], tile.count[1]);
      tile.first_column_rank = rank;
      for (int j = y[tj]; j < y[tj + 1]; ++j)
        for (int i = x[ti]; i < x[ti + 1]; ++i) column_rank_[grid.column(i, j)] = rank++;
      tile.last_column_rank = rank;
      colours_[(ti % 2) + (nx_tiles > 1 ? 2 : 1) * (tj % 2)].push_back(
          static_cast<std::uint32_t>(tiles_.size()));
      tiles_.push_back(tile);
    }
}

template class Tiling<2>;
template class Tiling<3>;

}  // namespace pileus::parcels
