#include "conform/frame.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

namespace pileus::conform {
namespace {

using Kind = FrameSlot::Kind;

Kind kind_of(const pileus_quantity& row, const pileus_view& view) {
  if (view.data == nullptr) return Kind::absent;
  switch (row.place) {
    case PILEUS_ITEM:
      return Kind::item;
    case PILEUS_MESH:
      return Kind::fixed;
    case PILEUS_SURFACE:
      return Kind::surface;
    case PILEUS_DOMAIN:
      return Kind::domain;
    default:
      return Kind::parcel;
  }
}

}  // namespace

Frame::Frame(World& world) : world_(&world), slots_(world.bound().slots.size()) {
  const pileus_block block = world.whole(coupling::Derived::none);
  const auto count = static_cast<std::size_t>(block.count);
  uid_.assign(block.uid, block.uid + count);
  volume_.assign(world.store().volume(), world.store().volume() + count);
  for (std::size_t s = 0; s < slots_.size(); ++s) copy_slot(s, block.views[s]);
  copy_items(block);
}

void Frame::copy_slot(std::size_t s, const pileus_view& view) {
  const coupling::BoundSlot& bound = world_->bound().slots[s];
  const pileus_quantity& row = world_->bound().entry->table->quantities[s];
  FrameSlot& slot = slots_[s];
  slot.kind = kind_of(row, view);
  if (row.place == PILEUS_ITEM && bound.item < 0) slot.kind = Kind::absent;
  slot.writable = bound.writable;
  slot.derived = bound.derived;
  slot.range = {bound.low, bound.high};
  if (row.place == PILEUS_ITEM && row.type == PILEUS_I64)
    slot.range.low = std::max(slot.range.low, 0.0);
  if (!slot.exists()) return;
  slot.stride = view.stride;
  slot.count = view.count;
  const auto elements = static_cast<std::size_t>(view.count);
  const auto words = static_cast<std::size_t>(view.stride) / sizeof(double);
  if (slot.kind != Kind::fixed) {
    slot.values = Words(view.data, elements);
  } else if (elements > 0) {
    // The last record may begin late in its field: only the value itself is there for sure.
    slot.values = Words(view.data, (elements - 1) * words + 1);
  }
}

void Frame::copy_items(const pileus_block& block) {
  if (block.item_count == nullptr) return;
  item_count_.assign(block.item_count, block.item_count + block.count);
  item_begin_.assign(1, 0);
  for (const std::int32_t count : item_count_) item_begin_.push_back(item_begin_.back() + count);
}

const char* Frame::name(std::size_t slot) const {
  return world_->bound().entry->table->quantities[slot].name;
}

std::optional<std::size_t> Frame::multiplicity() const {
  for (std::size_t s = 0; s < slots_.size(); ++s)
    if (slots_[s].kind == Kind::item && world_->bound().slots[s].item == 0) return s;
  return std::nullopt;
}

std::uint64_t Frame::owner_of_item(std::size_t item) const {
  const auto after =
      std::upper_bound(item_begin_.begin(), item_begin_.end(), static_cast<std::int64_t>(item));
  const auto parcel = static_cast<std::size_t>(after - item_begin_.begin()) - 1;
  return parcel < uid_.size() ? uid_[parcel] : 0;
}

void Frame::record(std::size_t begin, std::size_t count, bool diagnosing, Call& call,
                   const std::vector<std::uint32_t>* active) {
  const coupling::BoundOperator& bound = world_->bound();
  call.views.assign(slots_.size(), pileus_view{});
  const auto first_item = has_items() ? item_begin_[begin] : 0;
  for (std::size_t s = 0; s < slots_.size(); ++s) {
    FrameSlot& slot = slots_[s];
    pileus_view& view = call.views[s];
    const pileus_quantity& row = bound.entry->table->quantities[s];
    view.type = row.place == PILEUS_ITEM ? row.type : std::uint32_t{PILEUS_F64};
    view.components = 1;
    view.stride = slot.kind == Kind::fixed ? slot.stride : std::int64_t{sizeof(double)};
    view.access = PILEUS_READ;
    const bool writes = slot.writable && slot.derived == diagnosing;
    const bool adds = slot.kind == Kind::surface && (row.access & PILEUS_WRITE) == 0;
    if (writes) view.access |= adds ? PILEUS_ADD : PILEUS_WRITE;
    if (!slot.exists()) continue;
    std::size_t offset = 0;
    view.count =
        slot.kind == Kind::fixed ? slot.count : static_cast<std::int64_t>(slot.values.size());
    if (slot.kind == Kind::parcel) {
      offset = begin;
      view.count = static_cast<std::int64_t>(count);
    } else if (slot.kind == Kind::item) {
      offset = static_cast<std::size_t>(first_item);
      view.count = item_begin_[begin + count] - first_item;
    }
    view.data = static_cast<double*>(slot.values.data()) + offset;
  }
  call.ledger.assign(bound.entry->table->budgets.size() + 1, 0.0);
  call.block = {};
  call.block.size = sizeof call.block;
  call.block.count = call.block.active_count = static_cast<std::int64_t>(count);
  call.block.uid = uid_.data() + begin;
  call.block.views = call.views.data();
  call.block.grid = &*world_->grid();
  call.block.ledger = call.ledger.data();
  if (active != nullptr) {
    call.active = *active;
    call.block.active = call.active.data();
    call.block.active_count = static_cast<std::int64_t>(call.active.size());
  }
  if (!has_items()) return;
  call.item_begin.resize(count + 1);
  for (std::size_t p = 0; p <= count; ++p) call.item_begin[p] = item_begin_[begin + p] - first_item;
  call.block.item_begin = call.item_begin.data();
  call.block.item_count = item_count_.data() + begin;
}

void Frame::give_items_to_world() {
  parcels::ItemLists& lists = world_->store().items();
  lists.regroup(item_count_, std::vector<std::int64_t>(items(), -1));
  for (std::size_t s = 0; s < slots_.size(); ++s) {
    if (slots_[s].kind != Kind::item) continue;
    const int item = world_->bound().slots[s].item;
    void* to = item == 0 ? static_cast<void*>(lists.multiplicity())
                         : static_cast<void*>(lists.column(item - 1));
    if (items() > 0) std::memcpy(to, slots_[s].values.data(), items() * sizeof(double));
  }
}

void Frame::take_items_of_world() {
  const pileus_block block = world_->whole(coupling::Derived::none);
  for (std::size_t s = 0; s < slots_.size(); ++s)
    if (slots_[s].kind == Kind::item) copy_slot(s, block.views[s]);
  copy_items(block);
}

void Frame::gather(const std::vector<std::uint32_t>& source) {
  const Frame old = *this;
  uid_.clear();
  volume_.clear();
  std::vector<std::size_t> items;
  if (has_items()) {
    item_count_.clear();
    item_begin_.assign(1, 0);
  }
  for (const std::uint32_t p : source) {
    uid_.push_back(old.uid_[p]);
    volume_.push_back(old.volume_[p]);
    if (!has_items()) continue;
    for (std::size_t k = old.item_begin(p); k < old.item_begin(p + 1); ++k) items.push_back(k);
    item_count_.push_back(old.item_count_[p]);
    item_begin_.push_back(item_begin_.back() + old.item_count_[p]);
  }
  for (std::size_t s = 0; s < slots_.size(); ++s) {
    Words& values = slots_[s].values;
    const Words& before = old.slots_[s].values;
    if (slots_[s].kind == Kind::parcel) {
      values.resize(source.size());
      for (std::size_t k = 0; k < source.size(); ++k) values.bits(k) = before.bits(source[k]);
    } else if (slots_[s].kind == Kind::item) {
      values.resize(items.size());
      for (std::size_t k = 0; k < items.size(); ++k) values.bits(k) = before.bits(items[k]);
    }
  }
}

std::optional<Difference> Frame::difference(const Frame& other) const {
  for (std::size_t s = 0; s < slots_.size(); ++s) {
    const FrameSlot& slot = slots_[s];
    if (!slot.exists() || slot.kind == Kind::fixed) continue;
    const Words &a = slot.values, &b = other.slots_[s].values;
    if (a.size() != b.size())
      return Difference{s, 0, static_cast<double>(a.size()), static_cast<double>(b.size())};
    for (std::size_t i = 0; i < a.size(); ++i) {
      if (a.bits(i) == b.bits(i)) continue;
      const std::uint64_t uid = slot.kind == Kind::parcel ? uid_[i]
                                : slot.kind == Kind::item ? owner_of_item(i)
                                                          : 0;
      const bool counts = world_->bound().slots[s].item == 0;
      const auto number = [&](const Words& w) {
        return counts ? static_cast<double>(w.integers()[i]) : w.numbers()[i];
      };
      return Difference{s, uid, number(a), number(b)};
    }
  }
  if (item_count_ != other.item_count_) return Difference{multiplicity().value_or(0), 0, 0, 0};
  return std::nullopt;
}

std::string describe(const Frame& frame, const Difference& d, const char* first,
                     const char* second) {
  const std::string of = d.uid != 0 ? fmt::format(" of parcel {}", d.uid) : "";
  return fmt::format("{}{} is {:.17g} {} and {:.17g} {}", frame.name(d.slot), of, d.before, first,
                     d.after, second);
}

}  // namespace pileus::conform
