// The parcels themselves: a structure of arrays that knows its dimension only as a number.
//
// Every array is 64-byte aligned and padded to a whole number of cache lines. Only the quantities
// somebody declared exist. Order in memory is by tile and cell after each sort and carries no
// meaning; a parcel's identity is its uid.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/aligned_array.hpp"
#include "parcels/item_lists.hpp"

namespace pileus::parcels {

/// How a quantity behaves when parcels merge and split.
enum class Nature {
  intensive,  // volume-weighted mean at a merge, copied at a split
  extensive,  // summed at a merge, shared by volume at a split
  derived,    // recomputed by a closure; never merged, split, saved or sorted
};

/// A scalar quantity carried by every parcel.
struct Scalar {
  std::string name;   // as registered in schemas/quantities.yaml
  std::string units;  // UDUNITS
  Nature nature = Nature::intensive;
  std::string budget;                     // closed sum it belongs to, or empty
  double low = 0, high = 0, initial = 0;  // admissible range; value of new parcels
};

/// The quantity that sets what a parcel spans apart from what it holds, where an operator owns it.
inline constexpr const char* size_volume_name = "parcel_size_volume";

class Store {
 public:
  /// An empty store for `dimension` (2 or 3) with the given scalars, in that order, and items.
  Store(int dimension, std::vector<Scalar> scalars, ItemDeclaration items = {});

  int dimension() const { return dimension_; }
  /// Components of the vorticity: 3 in 3D; in 2D the one component w_x − u_z.
  int vorticity_components() const { return dimension_ == 3 ? 3 : 1; }
  /// Stored components of the symmetric shape matrix B, row by row of its upper triangle:
  /// 3D B11 B12 B13 B22 B23 B33; 2D B11 B12 B22 (directions x, z).
  int shape_components() const { return dimension_ == 3 ? 6 : 3; }

  std::size_t size() const { return size_; }
  /// Sets the number of parcels; new ones are uninitialised.
  void resize(std::size_t size);

  double* position(int axis) { return column(axis); }                              // m
  double* volume() { return column(dimension_); }                                  // m3 (2D: m2)
  double* vorticity(int component) { return column(dimension_ + 1 + component); }  // s-1
  double* shape(int component) {                                                   // m2
    return column(dimension_ + 1 + vorticity_components() + component);
  }
  double* scalar(int index) { return column(first_scalar() + index); }
  /// Volume of the ellipsoid that the shape describes: the parcel's own, unless parcels carry one
  /// of their own for it.
  double* size_volume() { return column(size_volume_column_); }
  std::uint64_t* uid() { return uid_.data(); }
  const double* position(int axis) const { return column(axis); }
  const double* volume() const { return column(dimension_); }
  const double* vorticity(int component) const { return column(dimension_ + 1 + component); }
  const double* shape(int component) const {
    return column(dimension_ + 1 + vorticity_components() + component);
  }
  const double* scalar(int index) const { return column(first_scalar() + index); }
  const double* size_volume() const { return column(size_volume_column_); }
  const std::uint64_t* uid() const { return uid_.data(); }

  /// Whether shapes may be larger than the parcels' volumes.
  bool carries_size() const { return size_volume_column_ != dimension_; }

  const std::vector<Scalar>& scalars() const { return scalars_; }
  /// Index of the named scalar, or −1.
  int find_scalar(std::string_view name) const;

  /// Number of double columns that are state: everything except derived scalars. Columns
  /// 0 … state_columns()−1 in the order position, volume, vorticity, shape, scalars; derived
  /// scalars come last, so that the state is a prefix.
  int state_columns() const { return state_columns_; }
  double* column(int index) { return columns_[static_cast<std::size_t>(index)].data(); }
  const double* column(int index) const { return columns_[static_cast<std::size_t>(index)].data(); }
  /// Name of a column as written to checkpoints: x_position, volume, B11, …, the scalar's name.
  std::string column_name(int index) const;
  int column_count() const { return static_cast<int>(columns_.size()); }
  int first_scalar() const { return dimension_ + 1 + vorticity_components() + shape_components(); }

  /// Reorders all state so that new parcel k is old parcel source[k]; `source` may repeat and drop
  /// parcels. Derived scalars are resized and left undefined. `spare` lends its memory: its
  /// contents are lost, and it may come back as another array of at least its size.
  void gather(const std::vector<std::uint32_t>& source, AlignedArray<double>& spare);

  /// The lists of the parcels' items; whoever changes the number or order of parcels regroups them.
  ItemLists& items() { return items_; }
  const ItemLists& items() const { return items_; }

  std::size_t allocated_bytes() const;

 private:
  void reserve(std::size_t parcels);

  int dimension_;
  std::size_t size_ = 0;
  std::vector<Scalar> scalars_;  // intensive and extensive first, then derived
  int state_columns_ = 0;
  int size_volume_column_;
  std::vector<AlignedArray<double>> columns_;
  AlignedArray<std::uint64_t> uid_;
  ItemLists items_;
  std::size_t capacity_ = 0;  // parcels there is room for
};

}  // namespace pileus::parcels
