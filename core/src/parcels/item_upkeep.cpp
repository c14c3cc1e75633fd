#include "parcels/item_upkeep.hpp"

#include <algorithm>

#include "base/parallel.hpp"
#include "parcels/identity.hpp"
#include "parcels/margin.hpp"

namespace pileus::parcels {
namespace {

constexpr std::uint8_t whole = 0, first_half = 1;
constexpr std::size_t parcels_per_chunk = 1024;

/// Share of an item's multiplicity that one half of its parcel gets.
std::int64_t share(std::int64_t multiplicity, std::uint8_t half, std::uint64_t coins,
                   std::uint64_t place) {
  if (half == whole) return multiplicity;
  const std::int64_t odd_to_first =
      (multiplicity & 1) & static_cast<std::int64_t>(mix(coins + place));
  const std::int64_t first = multiplicity / 2 + odd_to_first;
  return half == first_half ? first : multiplicity - first;
}

}  // namespace

/// Calls f(item) for the items of an old parcel and of those merged into it, in a fixed order.
template <class F>
void ItemUpkeep::each_item(const ItemLists& lists, std::uint32_t parcel, F&& f) const {
  const auto visit = [&](std::uint32_t p) {
    const std::int64_t end = lists.begin()[p] + lists.count()[p];
    for (std::int64_t i = lists.begin()[p]; i < end; ++i) f(i);
  };
  visit(parcel);
  if (first_merged_.empty()) return;
  for (std::size_t m = first_merged_[parcel]; m < merged_.size() && merged_[m].receiver == parcel;
       ++m)
    visit(merged_[m].source);
}

void ItemUpkeep::index_merged(const ItemLists& lists, const ParcelRegrouping& parcels) {
  merged_ = parcels.merged;
  first_merged_.clear();
  if (merged_.empty()) return;
  first_merged_.assign(lists.parcels(), static_cast<std::uint32_t>(merged_.size()));
  for (std::size_t m = merged_.size(); m-- > 0;)
    first_merged_[merged_[m].receiver] = static_cast<std::uint32_t>(m);
}

/// Shortens lists in place, before they are copied to where they belong.
std::uint64_t ItemUpkeep::shorten(ItemLists& lists, const ParcelRegrouping& parcels) {
  const std::int64_t most = lists.most_per_parcel();
  if (most <= 0) return 0;
  return ordered_reduce(
      parcels.source.size(), std::uint64_t{0},
      [&](std::size_t begin, std::size_t end) {
        std::uint64_t united = 0;
        std::vector<std::int64_t> items;
        ItemReduction reduction;
        for (std::size_t k = begin; k < end; ++k) {
          if (half_[k] > first_half) continue;  // its twin has seen to the list of both
          std::int64_t length = 0;
          each_item(lists, parcels.source[k], [&](std::int64_t) { ++length; });
          if (length <= most) continue;
          items.clear();
          each_item(lists, parcels.source[k], [&](std::int64_t i) { items.push_back(i); });
          united += reduction.run(lists, items, static_cast<std::size_t>(most));
        }
        return united;
      },
      [](std::uint64_t a, std::uint64_t b) { return a + b; }, parcels_per_chunk);
}

/// Calls f(item, part of its multiplicity) for what a new parcel gets.
template <class F>
void ItemUpkeep::each_share(const ItemLists& lists, const ParcelRegrouping& parcels, std::size_t k,
                            F&& f) const {
  const std::uint64_t coins = half_[k] == whole ? 0 : child_uid(parcels.uid[k], parcels.step);
  std::uint64_t place = 0;
  each_item(lists, parcels.source[k], [&](std::int64_t i) {
    const std::int64_t part = share(lists.multiplicity()[i], half_[k], coins, place++);
    if (part > 0) f(i, part);
  });
}

void ItemUpkeep::mark_halves(const ParcelRegrouping& parcels) {
  resize_with_margin(half_, parcels.source.size());
  std::fill(half_.begin(), half_.end(), whole);
  for (const std::size_t first : parcels.pairs) {
    half_[first] = first_half;
    half_[first + 1] = first_half + 1;
  }
}

/// How many items every new parcel gets, and which.
void ItemUpkeep::list_sources(const ItemLists& lists, const ParcelRegrouping& parcels) {
  const std::size_t count = parcels.source.size();
  resize_with_margin(count_, count);
  resize_with_margin(begin_, count + 1);
  const auto each_parcel = [&](auto&& f) {
    parallel_chunks(
        count,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t k = begin; k < end; ++k) f(k);
        },
        parcels_per_chunk);
  };
  each_parcel([&](std::size_t k) {
    std::int32_t n = 0;
    each_share(lists, parcels, k, [&](std::int64_t, std::int64_t) { ++n; });
    count_[k] = n;
  });
  begin_[0] = 0;
  for (std::size_t k = 0; k < count; ++k) begin_[k + 1] = begin_[k] + count_[k];
  resize_with_margin(source_, static_cast<std::size_t>(begin_[count]));
  each_parcel([&](std::size_t k) {
    std::int64_t at = begin_[k];
    each_share(lists, parcels, k,
               [&](std::int64_t i, std::int64_t) { source_[static_cast<std::size_t>(at++)] = i; });
  });
}

std::uint64_t ItemUpkeep::run(ItemLists& lists, const ParcelRegrouping& parcels) {
  index_merged(lists, parcels);
  mark_halves(parcels);
  const std::uint64_t united = shorten(lists, parcels);
  list_sources(lists, parcels);
  // The copies of a split parcel's items will hold all of it: their shares follow from what the
  // list holds now, item by item in the same order.
  shares_.resize(2 * parcels.pairs.size());
  parallel_chunks(
      shares_.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t s = begin; s < end; ++s) {
          shares_[s].clear();
          each_share(lists, parcels, parcels.pairs[s / 2] + s % 2,
                     [&](std::int64_t, std::int64_t part) { shares_[s].push_back(part); });
        }
      },
      256);
  lists.regroup(count_, source_);
  for (std::size_t s = 0; s < shares_.size(); ++s)
    std::copy(shares_[s].begin(), shares_[s].end(),
              lists.multiplicity() + lists.begin()[parcels.pairs[s / 2] + s % 2]);
  return united;
}

std::size_t ItemUpkeep::allocated_bytes() const {
  return first_merged_.capacity() * sizeof(std::uint32_t) + half_.capacity() +
         count_.capacity() * sizeof(std::int32_t) +
         (begin_.capacity() + source_.capacity()) * sizeof(std::int64_t);
}

}  // namespace pileus::parcels
