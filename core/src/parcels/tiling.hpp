// Tiles of columns: the unit of work of the deposit and the outermost key of the parcel order.
//
// Tiles of one colour may be deposited at the same time: each writes to its own cells and `reach`
// cells around them, and tiles of one colour are more than that apart. The cut depends on the mesh
// alone, so the sums have the same bits for any number of threads.
#pragma once
#include <cstdint>
#include <vector>

#include "mesh/grid.hpp"

namespace pileus::parcels {

template <int D>
class Tiling {
 public:
  /// Cells beyond its own that a tile may write to.
  static constexpr int reach = 2;

  explicit Tiling(const mesh::Grid<D>& grid);

  struct Tile {
    std::int32_t first[2] = {0, 0};  // first writable base cell per horizontal direction
    std::int32_t count[2] = {0, 0};  // number of writable base cells
    std::uint32_t first_column_rank = 0, last_column_rank = 0;  // ranks [first, last) it owns
  };
  const std::vector<Tile>& tiles() const { return tiles_; }
  /// Tile indices by colour; every tile appears once.
  const std::vector<std::vector<std::uint32_t>>& colours() const { return colours_; }
  /// Position of a column in the tile-by-tile order of columns.
  const std::vector<std::uint32_t>& column_rank() const { return column_rank_; }

 private:
  std::vector<Tile> tiles_;
  std::vector<std::vector<std::uint32_t>> colours_;
  std::vector<std::uint32_t> column_rank_;
};

}  // namespace pileus::parcels
