// The lifecycle table: every legal order works, every other call is refused.
#include "host/lifecycle.hpp"

#include <gtest/gtest.h>

#include <set>
#include <utility>

namespace pileus::host {
namespace {

using State = LifeState;
using Call = LifeCall;

TEST(Lifecycle, allows_the_orders_of_the_contract_and_no_other) {
  const std::set<std::pair<State, Call>> legal = {
      {State::none, Call::create},       {State::created, Call::configure},
      {State::created, Call::destroy},   {State::configured, Call::init},
      {State::configured, Call::resume}, {State::configured, Call::destroy},
      {State::ready, Call::prepare},     {State::ready, Call::diagnose},
      {State::ready, Call::apply},       {State::ready, Call::save},
      {State::ready, Call::destroy},
  };
  for (int s = 0; s < static_cast<int>(State::count_); ++s) {
    for (int c = 0; c < static_cast<int>(Call::count_); ++c) {
      const auto state = static_cast<State>(s);
      const auto call = static_cast<Call>(c);
      if (legal.count({state, call}) > 0) {
        EXPECT_NO_THROW(after(state, call)) << name_of(state) << " " << name_of(call);
      } else {
        EXPECT_THROW(after(state, call), LifecycleError) << name_of(state) << " " << name_of(call);
      }
    }
  }
  EXPECT_EQ(after(State::ready, Call::apply), State::ready);
  EXPECT_EQ(after(State::created, Call::destroy), State::destroyed);
}

}  // namespace
}  // namespace pileus::host
