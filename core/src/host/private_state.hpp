// What an operator keeps beside its declared quantities: the extension pileus.state/1.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "pileus/abi.h"

namespace pileus::host {

/// Bytes that only their operator can read, and its revision of what they mean.
struct PrivateState {
  std::uint32_t format = 0;
  std::vector<std::uint8_t> bytes;

  bool operator==(const PrivateState&) const = default;
};

/// The table that an operator answers with, at today's length; nothing if it is impossible.
std::optional<pileus_state_ext> read_state_extension(const void* answer);

/// Calls save. What it hands over is in `state` when the result is PILEUS_OK.
pileus_status collect_state(const pileus_state_ext& ext, void* self, PrivateState& state,
                            pileus_error* error);

}  // namespace pileus::host
