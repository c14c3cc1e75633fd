#include "host/private_state.hpp"

#include <cstdio>
#include <exception>

#include "host/row_rules.hpp"

namespace pileus::host {
namespace {

/// Where save puts its bytes.
struct Sink {
  std::vector<std::uint8_t>& bytes;
  bool is_full = false;
};

int put_bytes(void* sink, const void* bytes, std::size_t count) {
  Sink& me = *static_cast<Sink*>(sink);
  if (me.is_full || (bytes == nullptr && count > 0)) return 0;
  try {
    const auto* begin = static_cast<const std::uint8_t*>(bytes);
    me.bytes.insert(me.bytes.end(), begin, begin + count);
  } catch (const std::exception&) {
    me.is_full = true;  // parts that would still fit must not close the gap
  }
  return me.is_full ? 0 : 1;
}

}  // namespace

std::optional<pileus_state_ext> read_state_extension(const void* answer) {
  const auto* given = static_cast<const pileus_state_ext*>(answer);
  if (given->size < first_size<pileus_state_ext> || given->size > largest_row) return std::nullopt;
  const pileus_state_ext ext = widened(*given);
  if (ext.save == nullptr || ext.load == nullptr) return std::nullopt;
  return ext;
}

pileus_status collect_state(const pileus_state_ext& ext, void* self, PrivateState& state,
                            pileus_error* error) {
  state = {ext.format, {}};
  Sink sink{state.bytes};
  const pileus_status status = ext.save(self, put_bytes, &sink, error);
  if (status != PILEUS_OK || !sink.is_full) return status;
  std::snprintf(error->text, sizeof error->text, "out of memory for its private state");
  return PILEUS_E_MEMORY;
}

}  // namespace pileus::host
