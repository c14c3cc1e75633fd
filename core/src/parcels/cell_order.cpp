#include "parcels/cell_order.hpp"

#include "base/parallel.hpp"
#include "parcels/margin.hpp"

namespace pileus::parcels {

template <int D>
CellOrder<D>::CellOrder(const mesh::Grid<D>& grid, const Tiling<D>& tiling)
    : grid_(grid), rank_(tiling.column_rank()), first_(grid.cell_count() + 1) {}

template <int D>
void CellOrder<D>::sort(const Store& store, std::vector<std::uint32_t>& keys) {
  const std::size_t count = store.size();
  resize_with_margin(keys, count);
  resize_with_margin(order_, count);
  const double* x = store.position(0);
  const double* y = D == 3 ? store.position(1) : nullptr;
  const double* z = store.position(D - 1);
  parallel_chunks(count, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      const int i = periodic_cell(x[p], grid_.lower[0], grid_.inverse_spacing[0], grid_.nx());
      const int j =
          D == 3 ? periodic_cell(y[p], grid_.lower[1], grid_.inverse_spacing[1], grid_.ny()) : 0;
      const int k =
          vertical_cell(z[p], grid_.lower[D - 1], grid_.inverse_spacing[D - 1], grid_.nz());
      keys[p] = static_cast<std::uint32_t>(key(i, j, k));
    }
  });
  // first_[c + 1] counts cell c, then becomes the running start of cell c + 1.
  std::fill(first_.begin(), first_.end(), 0u);
  for (std::size_t p = 0; p < count; ++p) ++first_[keys[p] + 1];
  for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
  for (std::size_t p = 0; p < count; ++p) order_[first_[keys[p]]++] = static_cast<std::uint32_t>(p);
  // Every start has moved to its end, which is the start of the next cell.
  for (std::size_t c = first_.size() - 1; c > 0; --c) first_[c] = first_[c - 1];
  first_[0] = 0;
}

template class CellOrder<2>;
template class CellOrder<3>;

}  // namespace pileus::parcels
