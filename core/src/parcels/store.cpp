#include "parcels/store.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "base/parallel.hpp"
#include "parcels/margin.hpp"

namespace pileus::parcels {
namespace {

/// Elements beyond the last parcel that vector loops may read (never use): one full vector.
constexpr std::size_t read_ahead = 8;

}  // namespace

Store::Store(int dimension, std::vector<Scalar> scalars, ItemDeclaration items)
    : dimension_(dimension), scalars_(std::move(scalars)), items_(std::move(items)) {
  std::stable_partition(scalars_.begin(), scalars_.end(),
                        [](const Scalar& s) { return s.nature != Nature::derived; });
  const auto derived = std::count_if(scalars_.begin(), scalars_.end(),
                                     [](const Scalar& s) { return s.nature == Nature::derived; });
  columns_.resize(static_cast<std::size_t>(first_scalar()) + scalars_.size());
  state_columns_ = column_count() - static_cast<int>(derived);
  const int size = find_scalar(size_volume_name);
  const bool carried =
      size >= 0 && scalars_[static_cast<std::size_t>(size)].nature == Nature::extensive;
  size_volume_column_ = carried ? first_scalar() + size : dimension_;
  resize(0);
}

void Store::reserve(std::size_t parcels) {
  if (parcels <= capacity_ && capacity_ > 0) return;
  capacity_ = with_margin(parcels);
  for (auto& column : columns_) column.resize(capacity_ + read_ahead);
  uid_.resize(capacity_ + read_ahead);
}

void Store::resize(std::size_t size) {
  reserve(size);
  size_ = size;
}

int Store::find_scalar(std::string_view name) const {
  for (std::size_t i = 0; i < scalars_.size(); ++i)
    if (scalars_[i].name == name) return static_cast<int>(i);
  return -1;
}

std::string Store::column_name(int index) const {
  static constexpr std::array<const char*, 13> names_3d = {
      "x_position",  "y_position",  "z_position", "volume", "x_vorticity",
      "y_vorticity", "z_vorticity", "B11",        "B12",    "B13",
      "B22",         "B23",         "B33"};
  static constexpr std::array<const char*, 7> names_2d = {
      "x_position", "z_position", "volume", "vorticity", "B11", "B12", "B22"};
  if (index >= first_scalar())
    return scalars_[static_cast<std::size_t>(index - first_scalar())].name;
  return dimension_ == 3 ? names_3d[static_cast<std::size_t>(index)]
                         : names_2d[static_cast<std::size_t>(index)];
}

void Store::gather(const std::vector<std::uint32_t>& source, AlignedArray<double>& spare) {
  constexpr std::size_t chunk = 16384;  // pure copying: fewer, longer tasks
  const std::size_t count = source.size();
  // A column that has to grow does so on its way through the spare, not by a copy of its own.
  if (count > capacity_) capacity_ = with_margin(count);
  const auto provide = [&](auto& array) {
    if (array.size() < capacity_ + read_ahead) array.discard_and_resize(capacity_ + read_ahead);
  };
  for (int c = 0; c < state_columns_; ++c) {
    auto& column = columns_[static_cast<std::size_t>(c)];
    provide(spare);
    const double* from = column.data();
    double* to = spare.data();
    parallel_chunks(
        count,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t p = begin; p < end; ++p) to[p] = from[source[p]];
        },
        chunk);
    column.swap(spare);
  }
  for (auto c = static_cast<std::size_t>(state_columns_); c < columns_.size(); ++c)
    provide(columns_[c]);
  // Identities pass through the spare as bytes: it has the room, and no memory of their own is
  // kept.
  static_assert(sizeof(std::uint64_t) == sizeof(double));
  provide(spare);
  parallel_chunks(
      count,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t p = begin; p < end; ++p)
          std::memcpy(spare.data() + p, uid_.data() + source[p], sizeof(std::uint64_t));
      },
      chunk);
  provide(uid_);
  parallel_chunks(
      count,
      [&](std::size_t begin, std::size_t end) {
        std::memcpy(uid_.data() + begin, spare.data() + begin,
                    (end - begin) * sizeof(std::uint64_t));
      },
      chunk);
  size_ = count;
}

std::size_t Store::allocated_bytes() const {
  std::size_t bytes = uid_.allocated_bytes() + items_.allocated_bytes();
  for (const auto& column : columns_) bytes += column.allocated_bytes();
  return bytes;
}

}  // namespace pileus::parcels
