#include "coupling/item_snapshot.hpp"

#include <algorithm>
#include <cstring>

namespace pileus::coupling {
namespace {

constexpr std::size_t width = sizeof(double);  // of every quantity of an item
static_assert(width == sizeof(std::int64_t));

const void* values_of(const parcels::ItemLists& lists, int quantity) {
  if (quantity == item_multiplicity) return lists.multiplicity();
  return lists.column(quantity - 1);
}

void* values_of(parcels::ItemLists& lists, int quantity) {
  return const_cast<void*>(values_of(std::as_const(lists), quantity));
}

}  // namespace

void ItemSnapshot::take(const parcels::ItemLists& lists, std::size_t first, std::size_t count,
                        std::span<const int> which, bool structure) {
  which_.assign(which.begin(), which.end());
  structure_ = structure;
  first_item_ = lists.begin()[first];
  items_ = lists.begin()[first + count] - first_item_;
  const std::size_t size = static_cast<std::size_t>(items_) * width;
  const std::size_t needed = size * which_.size();
  if (bytes_.size() < needed) bytes_.discard_and_resize(needed + needed / 8);
  for (std::size_t w = 0; w < which_.size() && size > 0; ++w)
    std::memcpy(bytes_.data() + w * size,
                static_cast<const unsigned char*>(values_of(lists, which_[w])) +
                    static_cast<std::size_t>(first_item_) * width,
                size);
  if (structure) count_.assign(lists.count(), lists.count() + lists.parcels());
}

const unsigned char* ItemSnapshot::kept(int quantity) const {
  const auto found = std::find(which_.begin(), which_.end(), quantity);
  if (found == which_.end()) return nullptr;
  return bytes_.data() + static_cast<std::size_t>(found - which_.begin()) *
                             static_cast<std::size_t>(items_) * width;
}

const std::int64_t* ItemSnapshot::multiplicity() const {
  return reinterpret_cast<const std::int64_t*>(kept(item_multiplicity));
}

const double* ItemSnapshot::column(int quantity) const {
  return reinterpret_cast<const double*>(kept(quantity));
}

/// Items [from, to) of the snapshot's.
void ItemSnapshot::put_back(parcels::ItemLists& lists, std::int64_t from, std::int64_t to) const {
  if (to == from) return;
  for (const int quantity : which_)
    std::memcpy(static_cast<unsigned char*>(values_of(lists, quantity)) +
                    static_cast<std::size_t>(first_item_ + from) * width,
                kept(quantity) + static_cast<std::size_t>(from) * width,
                static_cast<std::size_t>(to - from) * width);
}

void ItemSnapshot::restore(parcels::ItemLists& lists) const {
  if (structure_) {
    const std::vector<std::int64_t> anew(static_cast<std::size_t>(items_), -1);
    lists.regroup(count_, anew);
  }
  put_back(lists, 0, items_);
}

void ItemSnapshot::restore_parcel(parcels::ItemLists& lists, std::size_t parcel) const {
  const std::int64_t from = lists.begin()[parcel] - first_item_;
  put_back(lists, from, from + lists.count()[parcel]);
}

}  // namespace pileus::coupling
