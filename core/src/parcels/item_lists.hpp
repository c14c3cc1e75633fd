// Lists of items that parcels own: things smaller than a parcel, an item standing for many alike
// (droplets). What an item's numbers mean is declared; the lists know only the rules.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/aligned_array.hpp"

namespace pileus::parcels {

/// A number of every item besides its multiplicity.
struct ItemColumn {
  enum class Kind {
    of_each,  // of each of the things an item stands for: two items that are united take the mean
    height,   // above the parcel's centre, over the parcel's vertical half-extent
  };
  std::string name, units;  // registered, SI
  Kind kind = Kind::of_each;
  std::string budget;        // closed sum that multiplicity times value belongs to, or empty
  double low = 0, high = 0;  // admissible range
};

/// What the items of a run carry; without a multiplicity there are none.
struct ItemDeclaration {
  std::string multiplicity;  // name of the number of things that an item stands for
  std::vector<ItemColumn> columns;
};

/// The lists of all parcels, parcel after parcel in memory. An item of multiplicity 0 is none: it
/// goes at the next regrouping.
class ItemLists {
 public:
  ItemLists() = default;
  explicit ItemLists(ItemDeclaration declaration);

  /// Whether the run has items at all.
  bool exist() const { return !declaration_.multiplicity.empty(); }
  const ItemDeclaration& declaration() const { return declaration_; }
  /// Position of a column, −1: none of that name; the multiplicity is no column.
  int find_column(std::string_view name) const;
  /// Position of the column that holds the height, or −1.
  int height_column() const { return height_; }

  /// Empty lists for so many parcels.
  void start(std::size_t parcels);
  std::size_t parcels() const { return count_.size(); }
  std::size_t size() const { return size_; }
  /// Items of parcel p: [begin()[p], begin()[p] + count()[p]); begin() has one more entry.
  const std::int64_t* begin() const { return begin_.data(); }
  const std::int32_t* count() const { return count_.data(); }

  std::int64_t* multiplicity() { return multiplicity_.data(); }
  const std::int64_t* multiplicity() const { return multiplicity_.data(); }
  double* column(int index) { return columns_[static_cast<std::size_t>(index)].data(); }
  const double* column(int index) const { return columns_[static_cast<std::size_t>(index)].data(); }

  /// Most items of a parcel after upkeep; 0: no bound.
  std::int64_t most_per_parcel() const { return most_per_parcel_; }
  void set_most_per_parcel(std::int64_t most) { most_per_parcel_ = most; }
  /// Multiplicity times value over it counts in budgets as volume times mass fraction does.
  double budget_scale() const { return budget_scale_; }
  void set_budget_scale(double scale) { budget_scale_ = scale; }

  /// New lists: parcel p gets count[p] items, and new item k, parcel after parcel, is a copy of the
  /// old item source[k] or, where that is negative, all zeros. An old item may be copied often.
  /// Requires  source.size() is the sum of the counts, every entry below size()
  void regroup(std::span<const std::int32_t> count, std::span<const std::int64_t> source);

  std::size_t allocated_bytes() const;

 private:
  ItemDeclaration declaration_;
  int height_ = -1;
  std::size_t size_ = 0;
  std::int64_t most_per_parcel_ = 0;
  double budget_scale_ = 1;
  std::vector<std::int64_t> begin_;
  std::vector<std::int32_t> count_;
  AlignedArray<std::int64_t> multiplicity_, spare_multiplicity_;
  std::vector<AlignedArray<double>> columns_;
  AlignedArray<double> spare_;
};

}  // namespace pileus::parcels
