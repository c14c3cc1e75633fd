// Error records on their way to a plugin, whose own may be shorter or longer than the core's.
#pragma once
#include <algorithm>
#include <cstring>

#include "pileus/abi.h"

namespace pileus::host {

/// Copies all that `to`, whose owner has set its size, has room for; null: nobody wants to know.
inline void give_error(const pileus_error& from, pileus_error* to) {
  if (to == nullptr || to->size < sizeof to->size) return;
  const std::uint32_t size = to->size;
  std::memcpy(to, &from, std::min<std::size_t>(size, sizeof from));
  to->size = size;
}

}  // namespace pileus::host
