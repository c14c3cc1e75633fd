// How hooks written in C++ fail, and what is looked at before they are called.
#pragma once
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <exception>

#include "abi.h"

namespace pileus {

/// A failure of a hook: thrown by plugin code, turned into a status and a pileus_error record.
struct Failure : std::exception {
  pileus_status status;
  pileus_error record{};

  explicit Failure(const char* text, pileus_status code = PILEUS_E_INTERNAL) : status(code) {
    record.slot = -1;
    std::snprintf(record.text, sizeof record.text, "%s", text);
  }
  /// Names the parcel, the quantity (by slot) and the value at fault.
  Failure& at(std::uint64_t uid, std::uint32_t slot, double value) {
    record.uid = uid;
    record.slot = static_cast<std::int32_t>(slot);
    record.value = value;
    return *this;
  }
  const char* what() const noexcept override { return record.text; }
};

/// Rejects the step: the core restores the block and calls again with smaller steps.
struct Retry : Failure {
  explicit Retry(const char* why, double smaller_dt = 0) : Failure(why, PILEUS_RETRY) {
    record.dt_hint = smaller_dt;
  }
};

/// Copies a record to that of the core, which may be of another version and length.
inline void hand_over(const pileus_error& record, pileus_error* error) noexcept {
  if (error == nullptr || error->size < sizeof error->size) return;
  const std::uint32_t size = error->size;
  std::memcpy(error, &record, std::min<std::size_t>(size, sizeof record));
  error->size = size;
}

/// Everything of minor 0 is taken for granted; this is said instead of a crash where a program
/// breaks that promise.
inline void require_whole(bool whole, const char* table) {
  if (whole) return;
  Failure failure("", PILEUS_E_UNSUPPORTED);
  std::snprintf(failure.record.text, sizeof failure.record.text,
                "the program's table %s is shorter than that of plugin interface %u.0", table,
                PILEUS_ABI_MAJOR);
  throw failure;
}
inline void require_whole(const pileus_step& step, const pileus_block& block) {
  require_whole(PILEUS_HAS(&step, pileus_step, dt), "pileus_step");
  require_whole(PILEUS_HAS(&block, pileus_block, ledger), "pileus_block");
}

}  // namespace pileus
