#include "model/cloud_extent.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace pileus::model {
namespace {

/// Index of the cell along a periodic direction.
std::size_t cell_along(const pileus_grid& grid, int direction, double position) {
  const auto cells = static_cast<std::int64_t>(grid.cells[direction]);
  const double at = std::floor((position - grid.origin[direction]) / grid.spacing[direction]);
  const std::int64_t cell = static_cast<std::int64_t>(at) % cells;
  return static_cast<std::size_t>(cell < 0 ? cell + cells : cell);
}

}  // namespace

CloudExtent cloud_extent(const Simulation& simulation, const double* liquid, double threshold) {
  const parcels::Store& store = simulation.store();
  const pileus_grid grid = simulation.plugin_grid();
  const int dimension = simulation.dimension();
  const auto along_x = static_cast<std::size_t>(grid.cells[0]);
  std::vector<char> covered(along_x *
                            (dimension == 3 ? static_cast<std::size_t>(grid.cells[1]) : 1));
  const double* z = store.position(dimension - 1);
  CloudExtent extent{0, std::numeric_limits<double>::infinity(),
                     -std::numeric_limits<double>::infinity()};
  for (std::size_t p = 0; p < store.size(); ++p) {
    if (!(liquid[p] > threshold)) continue;
    extent.base = std::min(extent.base, z[p]);
    extent.top = std::max(extent.top, z[p]);
    const std::size_t x = cell_along(grid, 0, store.position(0)[p]);
    covered[x + (dimension == 3 ? along_x * cell_along(grid, 1, store.position(1)[p]) : 0)] = 1;
  }
  const auto count = static_cast<double>(std::count(covered.begin(), covered.end(), 1));
  extent.cover = count / static_cast<double>(covered.size());
  if (count == 0) extent.base = extent.top = std::numeric_limits<double>::quiet_NaN();
  return extent;
}

}  // namespace pileus::model
