// Growth of lists with an entry per parcel.
#pragma once
#include <cstddef>
#include <vector>

namespace pileus::parcels {

/// Sets the size and, where the list has to grow, leaves room for a slowly growing population: a
/// thirty-second, where std::vector would double.
template <class T>
void resize_with_margin(std::vector<T>& list, std::size_t count) {
  if (count > list.capacity()) list.reserve(count + count / 32);
  list.resize(count);
}

}  // namespace pileus::parcels
