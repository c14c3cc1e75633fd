// How long each table was in plugin interface 1.0: what the other side fills in at least, whatever
// the tables have grown to since.
#pragma once
#include <cstddef>

#include "pileus/abi.h"

namespace pileus::host {

/// Bytes up to the end of the last member of minor 0. These numbers never change.
template <class Table>
inline constexpr std::size_t first_size = 0;

#define PILEUS_FIRST_SIZE(TABLE, LAST) \
  template <>                          \
  inline constexpr std::size_t first_size<TABLE> = (offsetof(TABLE, LAST) + sizeof(TABLE::LAST))

PILEUS_FIRST_SIZE(pileus_quantity, doc);
PILEUS_FIRST_SIZE(pileus_parameter, text_fallback);
PILEUS_FIRST_SIZE(pileus_effect, when);
PILEUS_FIRST_SIZE(pileus_condition, value);
PILEUS_FIRST_SIZE(pileus_reference, text);
PILEUS_FIRST_SIZE(pileus_operator, extension);
PILEUS_FIRST_SIZE(pileus_module, operators);
PILEUS_FIRST_SIZE(pileus_items_ext, budget_scale);
PILEUS_FIRST_SIZE(pileus_state_ext, load);

#undef PILEUS_FIRST_SIZE

}  // namespace pileus::host
