#include "parcels/item_lists.hpp"

#include <algorithm>

#include "base/parallel.hpp"
#include "parcels/margin.hpp"

namespace pileus::parcels {
namespace {

constexpr std::size_t chunk = 16384;  // pure copying: fewer, longer tasks

/// target[k] = from[source[k]], 0 where the source is negative.
template <class T>
void copy_items(AlignedArray<T>& array, AlignedArray<T>& spare,
                std::span<const std::int64_t> source) {
  // Lists without any item have memory all the same: no memory means no quantity.
  constexpr std::size_t least = 8;
  if (spare.size() < std::max(least, source.size()))
    spare.discard_and_resize(std::max(least, with_margin(source.size())));
  const T* from = array.data();
  T* to = spare.data();
  parallel_chunks(
      source.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) to[k] = source[k] < 0 ? T{0} : from[source[k]];
      },
      chunk);
  array.swap(spare);
}

}  // namespace

ItemLists::ItemLists(ItemDeclaration declaration)
    : declaration_(std::move(declaration)), columns_(declaration_.columns.size()) {
  for (std::size_t c = 0; c < declaration_.columns.size(); ++c)
    if (declaration_.columns[c].kind == ItemColumn::Kind::height) height_ = static_cast<int>(c);
  begin_.assign(1, 0);
}

int ItemLists::find_column(std::string_view name) const {
  for (std::size_t c = 0; c < declaration_.columns.size(); ++c)
    if (declaration_.columns[c].name == name) return static_cast<int>(c);
  return -1;
}

void ItemLists::start(std::size_t parcels) {
  size_ = 0;
  begin_.assign(parcels + 1, 0);
  count_.assign(parcels, 0);
  regroup(std::vector<std::int32_t>(parcels, 0), {});
}

void ItemLists::regroup(std::span<const std::int32_t> count, std::span<const std::int64_t> source) {
  copy_items(multiplicity_, spare_multiplicity_, source);
  for (auto& column : columns_) copy_items(column, spare_, source);
  resize_with_margin(count_, count.size());
  resize_with_margin(begin_, count.size() + 1);
  std::copy(count.begin(), count.end(), count_.begin());
  begin_[0] = 0;
  for (std::size_t p = 0; p < count.size(); ++p) begin_[p + 1] = begin_[p] + count[p];
  size_ = source.size();
}

std::size_t ItemLists::allocated_bytes() const {
  std::size_t bytes = begin_.capacity() * sizeof(std::int64_t) +
                      count_.capacity() * sizeof(std::int32_t) + multiplicity_.allocated_bytes() +
                      spare_multiplicity_.allocated_bytes() + spare_.allocated_bytes();
  for (const auto& column : columns_) bytes += column.allocated_bytes();
  return bytes;
}

}  // namespace pileus::parcels
