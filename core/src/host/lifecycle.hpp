// The life of an operator instance, as one table.
#pragma once
#include <cstdint>
#include <stdexcept>

namespace pileus::host {

enum class LifeState : std::uint8_t { none, created, configured, ready, destroyed, count_ };
enum class LifeCall : std::uint8_t {
  create,
  configure,
  init,    // start of a new run
  resume,  // start from a checkpoint, private state loaded or not
  prepare,
  diagnose,
  apply,
  save,
  destroy,
  count_
};

const char* name_of(LifeState state);
const char* name_of(LifeCall call);

/// A call in a state that does not allow it: a mistake of the host, never of the plugin.
class LifecycleError : public std::logic_error {
 public:
  LifecycleError(LifeState state, LifeCall call);
};

/// The state that `call` leads to from `state`. Throws LifecycleError if it is not allowed.
LifeState after(LifeState state, LifeCall call);

}  // namespace pileus::host
