// Growth of lists with an entry per parcel.
#pragma once
#include <cstddef>
#include <vector>

namespace pileus::parcels {

/// Entries to provide where `count` are needed, for a slowly growing population: a sixty-fourth
/// more, where std::vector would double.
inline std::size_t with_margin(std::size_t count) {
  return count + count / 64;
}

/// Sets the size and, where the list has to grow, leaves that room.
template <class T>
void resize_with_margin(std::vector<T>& list, std::size_t count) {
  if (count > list.capacity()) list.reserve(with_margin(count));
  list.resize(count);
}

}  // namespace pileus::parcels
