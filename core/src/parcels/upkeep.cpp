#include "parcels/upkeep.hpp"

#include <algorithm>

#include "base/parallel.hpp"
#include "parcels/kernels.hpp"
#include "parcels/margin.hpp"

namespace pileus::parcels {

template <int D>
Upkeep<D>::Upkeep(const mesh::Grid<D>& grid, const Tiling<D>& tiling, double smallest_volume,
                  const SplitCriterion<D>& criterion)
    : grid_(grid),
      tiling_(tiling),
      order_(grid, tiling),
      merge_(grid, smallest_volume),
      metric_(grid),
      criterion_(criterion),
      tile_begin_(tiling.tiles().size() + 1, 0) {}

template <int D>
UpkeepCounts Upkeep<D>::run(Store& store, SupportOffsets<D>& offsets, std::uint64_t step,
                            PhaseTimes& times) {
  UpkeepCounts counts;
  {
    const PhaseScope scope(times, Phase::sort);
    order_.sort(store, source_);
  }
  {
    const PhaseScope scope(times, Phase::merge);
    counts.merges = merge_.run(store, order_);
  }
  {
    const PhaseScope scope(times, Phase::split);
    mark_splits(store, offsets);
  }
  {
    const PhaseScope scope(times, Phase::sort);
    list_survivors();
    store.gather(source_, offsets.scratch_array(0));
    counts.items_united = regroup_items(store, step);
  }
  {
    const PhaseScope scope(times, Phase::split);
    parallel_chunks(
        pairs_.size(),
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i)
            split_pair<D>(store, grid_, metric_, pairs_[i], pairs_[i] + 1, step);
        },
        256);
    counts.splits = pairs_.size();
  }
  return counts;
}

/// Between the new order of the parcels and their splits: halves still have the identity of whom
/// they are the halves of.
template <int D>
std::uint64_t Upkeep<D>::regroup_items(Store& store, std::uint64_t step) {
  if (!store.items().exist()) return 0;
  return item_upkeep_.run(store.items(), {source_, merge_.merged(), pairs_, store.uid(), step});
}

template <int D>
void Upkeep<D>::reorder(Store& store, SupportOffsets<D>& offsets, PhaseTimes& times) {
  const PhaseScope scope(times, Phase::sort);
  order_.sort(store, source_);
  splits_.assign(store.size(), 0);
  merge_.forget();
  list_survivors();
  store.gather(source_, offsets.scratch_array(0));
}

template <int D>
void Upkeep<D>::mark_splits(const Store& store, SupportOffsets<D>& scratch) {
  const std::size_t count = store.size();
  resize_with_margin(splits_, count);
  if (!metric_.plain) return mark_splits_in_flat_cells(store);
  if (scratch.capacity() < count + 8) scratch.resize(count);
  double* length = scratch.scratch(0);
  double* ratio = scratch.scratch(1);
  const double* shape[D == 3 ? 6 : 3];
  for (int c = 0; c < store.shape_components(); ++c) shape[c] = store.shape(c);
  const double* volume = store.size_volume();
  const auto measure = D == 3 ? kernels().axis_ratios_3d : kernels().axis_ratios_2d;
  parallel_chunks(count, [&](std::size_t begin, std::size_t end) {
    measure(shape, length, ratio, begin, end);
    for (std::size_t p = begin; p < end; ++p)
      splits_[p] = criterion_.splits(length[p], ratio[p], volume[p]);
  });
}

/// The same with shapes mapped to the metric of the cell, a block of them at a time.
template <int D>
void Upkeep<D>::mark_splits_in_flat_cells(const Store& store) {
  constexpr int components = D == 3 ? 6 : 3;
  constexpr std::size_t block = 128, read_ahead = 8;
  const double* volume = store.size_volume();
  const auto measure = D == 3 ? kernels().axis_ratios_3d : kernels().axis_ratios_2d;
  parallel_chunks(store.size(), [&](std::size_t begin, std::size_t end) {
    alignas(64) double mapped[components][block + read_ahead];
    alignas(64) double length[block + read_ahead], ratio[block + read_ahead];
    const double* shape[components];
    for (int c = 0; c < components; ++c) shape[c] = mapped[c];
    for (std::size_t first = begin; first < end; first += block) {
      const std::size_t count = std::min(block, end - first);
      for (int i = 0, c = 0; i < D; ++i)
        for (int j = i; j < D; ++j, ++c) {
          const double stretch = metric_.stretch[std::size_t(i)] * metric_.stretch[std::size_t(j)];
          for (std::size_t p = 0; p < count; ++p)
            mapped[c][p] = stretch * store.shape(c)[first + p];
          std::fill_n(mapped[c] + count, read_ahead, mapped[c][count - 1]);
        }
      measure(shape, length, ratio, 0, count);
      for (std::size_t p = 0; p < count; ++p)
        splits_[first + p] = criterion_.splits(length[p], ratio[p], volume[first + p]);
    }
  });
}

/// Walks the cells in order: skips merged parcels, lists splitting ones twice.
template <int D>
void Upkeep<D>::list_survivors() {
  const auto& gone = merge_.gone();
  const bool any_gone = !gone.empty();
  std::size_t survivors = 0;
  for (std::size_t p = 0; p < splits_.size(); ++p)
    survivors += any_gone && gone[p] ? 0 : 1 + std::size_t(splits_[p] != 0);
  source_.clear();
  if (survivors > source_.capacity()) source_.reserve(with_margin(survivors));
  pairs_.clear();
  const auto& tiles = tiling_.tiles();
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    tile_begin_[t] = source_.size();
    const std::uint32_t last = order_.first(order_.key_of_rank(tiles[t].last_column_rank));
    for (std::uint32_t s = order_.first(order_.key_of_rank(tiles[t].first_column_rank)); s < last;
         ++s) {
      const std::uint32_t p = order_.order()[s];
      if (any_gone && gone[p]) continue;
      if (splits_[p]) {
        pairs_.push_back(source_.size());
        source_.push_back(p);
      }
      source_.push_back(p);
    }
  }
  tile_begin_[tiles.size()] = source_.size();
}

template <int D>
std::size_t Upkeep<D>::allocated_bytes() const {
  return order_.allocated_bytes() + splits_.capacity() + merge_.gone().capacity() +
         source_.capacity() * sizeof(std::uint32_t) + pairs_.capacity() * sizeof(std::size_t) +
         item_upkeep_.allocated_bytes();
}

template class Upkeep<2>;
template class Upkeep<3>;

}  // namespace pileus::parcels
