#include "host/lifecycle.hpp"

#include <array>
#include <string>

namespace pileus::host {
namespace {

constexpr std::size_t states = static_cast<std::size_t>(LifeState::count_);
constexpr std::size_t calls = static_cast<std::size_t>(LifeCall::count_);
constexpr LifeState no = LifeState::count_;  // not allowed
constexpr LifeState created = LifeState::created, configured = LifeState::configured,
                    ready = LifeState::ready, destroyed = LifeState::destroyed;

// clang-format off
constexpr std::array<std::array<LifeState, calls>, states> table = {{
    //  create   configure   init   resume prepare diagnose apply  save   destroy
    {{  created, no,         no,    no,    no,     no,      no,    no,    no        }},  // none
    {{  no,      configured, no,    no,    no,     no,      no,    no,    destroyed }},  // created
    {{  no,      no,         ready, ready, no,     no,      no,    no,    destroyed }},  // configured
    {{  no,      no,         no,    no,    ready,  ready,   ready, ready, destroyed }},  // ready
    {{  no,      no,         no,    no,    no,     no,      no,    no,    no        }},  // destroyed
}};
// clang-format on

}  // namespace

const char* name_of(LifeState state) {
  constexpr std::array<const char*, states> names = {"none", "created", "configured", "ready",
                                                     "destroyed"};
  return names[static_cast<std::size_t>(state)];
}

const char* name_of(LifeCall call) {
  constexpr std::array<const char*, calls> names = {
      "create", "configure", "init", "resume", "prepare", "diagnose", "apply", "save", "destroy"};
  return names[static_cast<std::size_t>(call)];
}

LifecycleError::LifecycleError(LifeState state, LifeCall call)
    : std::logic_error(std::string("operator call '") + name_of(call) +
                       "' is not allowed in state '" + name_of(state) + "'") {}

LifeState after(LifeState state, LifeCall call) {
  const LifeState next = table[static_cast<std::size_t>(state)][static_cast<std::size_t>(call)];
  if (next == no) throw LifecycleError(state, call);
  return next;
}

}  // namespace pileus::host
