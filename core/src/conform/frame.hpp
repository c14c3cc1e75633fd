// The inputs and outputs of an operator's calls in memory of their own: they can be copied, cut
// into blocks, put into another order and compared bit by bit.
#pragma once
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "base/aligned_array.hpp"
#include "conform/world.hpp"

namespace pileus::conform {

/// Numbers of eight bytes that are compared by their bits, 64-byte aligned.
class Words {
 public:
  Words() = default;
  Words(const void* from, std::size_t count) : words_(count) {
    if (count > 0) std::memcpy(words_.data(), from, count * sizeof(std::uint64_t));
  }
  Words(const Words& other) : Words(other.words_.data(), other.size()) {}
  Words& operator=(const Words& other) {
    words_.discard_and_resize(other.size());
    if (other.size() > 0)
      std::memcpy(words_.data(), other.words_.data(), other.size() * sizeof(std::uint64_t));
    return *this;
  }
  Words(Words&&) = default;
  Words& operator=(Words&&) = default;
  ~Words() = default;

  std::size_t size() const { return words_.size(); }
  void resize(std::size_t size) { words_.resize(size); }
  std::uint64_t& bits(std::size_t i) { return words_[i]; }
  std::uint64_t bits(std::size_t i) const { return words_[i]; }
  double* numbers() { return reinterpret_cast<double*>(words_.data()); }
  const double* numbers() const { return reinterpret_cast<const double*>(words_.data()); }
  std::int64_t* integers() { return reinterpret_cast<std::int64_t*>(words_.data()); }
  const std::int64_t* integers() const {
    return reinterpret_cast<const std::int64_t*>(words_.data());
  }
  void* data() { return words_.data(); }

 private:
  AlignedArray<std::uint64_t> words_;
};

/// One declared quantity.
struct FrameSlot {
  enum class Kind { absent, parcel, item, fixed, surface, domain };
  Kind kind = Kind::absent;
  bool writable = false, derived = false;  // by apply or, derived, by diagnose
  Range range;                             // admissible
  Words values;                            // of `fixed`, the mesh, all records of its field
  std::int64_t stride = sizeof(double);    // of `fixed`
  std::int64_t count = 0;                  // of `fixed`

  bool exists() const { return kind != Kind::absent; }
  /// Whether apply may change it.
  bool advances() const { return exists() && writable && !derived; }
};

/// The record of one call and what it points to. Does not move.
struct Call {
  pileus_block block{};
  std::vector<pileus_view> views;
  std::vector<std::int64_t> item_begin;
  std::vector<double> ledger;
  std::vector<std::uint32_t> active;

  Call() = default;
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;
};

/// Where two frames differ.
struct Difference {
  std::size_t slot = 0;
  std::uint64_t uid = 0;  // of the parcel, or of the one that owns the item; 0: no parcel's
  double before = 0, after = 0;
};

class Frame {
 public:
  /// Copies what the operator of a world is shown.
  explicit Frame(World& world);

  World& world() const { return *world_; }
  std::size_t parcels() const { return uid_.size(); }
  const std::vector<FrameSlot>& slots() const { return slots_; }
  std::vector<FrameSlot>& slots() { return slots_; }
  const char* name(std::size_t slot) const;
  std::uint64_t uid(std::size_t parcel) const { return uid_[parcel]; }
  bool has_items() const { return !item_begin_.empty(); }
  /// Items of parcel p: [item_begin(p), item_begin(p + 1)).
  std::size_t item_begin(std::size_t p) const { return static_cast<std::size_t>(item_begin_[p]); }
  std::size_t items() const {
    return has_items() ? static_cast<std::size_t>(item_begin_.back()) : 0;
  }
  /// The slot of how many things an item stands for; none without items.
  std::optional<std::size_t> multiplicity() const;
  std::uint64_t owner_of_item(std::size_t item) const;
  /// Volume of a parcel, m3; 1 for operators that do not read it.
  double volume(std::size_t parcel) const { return volume_[parcel]; }

  /// Makes the record of a call on parcels [begin, begin + count), all or those of `active`.
  void record(std::size_t begin, std::size_t count, bool diagnosing, Call& call,
              const std::vector<std::uint32_t>* active = nullptr);
  /// After a call that may have given the parcels other items.
  void take_items_of_world();
  void give_items_to_world();

  /// New parcel k is old parcel source[k]; entries may repeat, with other identities then.
  void gather(const std::vector<std::uint32_t>& source);

  /// The first slot and element whose bits differ, among what may be written.
  std::optional<Difference> difference(const Frame& other) const;

 private:
  void copy_slot(std::size_t slot, const pileus_view& view);
  void copy_items(const pileus_block& block);

  World* world_;
  std::vector<FrameSlot> slots_;
  std::vector<std::uint64_t> uid_;
  std::vector<double> volume_;
  std::vector<std::int64_t> item_begin_;  // one more than parcels; empty: no items
  std::vector<std::int32_t> item_count_;
};

/// "passive_tracer of parcel 12 is 0.5 there and 0.7 here".
std::string describe(const Frame& frame, const Difference& difference, const char* first,
                     const char* second);

}  // namespace pileus::conform
