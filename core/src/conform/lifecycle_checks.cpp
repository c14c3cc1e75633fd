// C09, C10 and C22: what an instance is made of, keeps, and leaves behind.
#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <chrono>

#include "base/version.hpp"
#include "conform/advance.hpp"
#include "host/instance.hpp"

namespace pileus::conform {
namespace {

using Clock = std::chrono::steady_clock;

/// Bytes in use of the C library's heap.
long heap_in_use() {
  const struct mallinfo2 info = ::mallinfo2();
  return static_cast<long>(info.uordblks + info.hblkhd);
}

/// Up to so many lives, fewer of an operator that is slow to configure.
int live(const Case& c, World& world, int lives, double most_seconds) {
  const auto start = Clock::now();
  int lived = 0;
  for (; lived < lives; ++lived) {
    if (std::chrono::duration<double>(Clock::now() - start).count() > most_seconds) break;
    make_subject(c, world, world.values());
  }
  return lived;
}

/// The orders of calls that the life of an instance allows, by the core's own table of them.
void live_in_every_order(const Case& c, Frame& frame) {
  World& world = frame.world();
  const auto table = c.table;
  { const host::Instance created(table, world.lent()); }
  {
    host::Instance configured(table, world.lent());
    configured.configure(world.values());
  }
  for (const bool new_run : {true, false}) {
    host::Instance ready(table, world.lent());
    ready.configure(world.values());
    const pileus_step step = step_of(0, 0, c.seed);
    Call call;
    frame.record(0, frame.parcels(), false, call);
    // The making of items is for the world, which has seen it.
    if (!new_run || world.bound().creates_items) {
      ready.resume();
      continue;
    }
    const host::CallResult result = ready.init(step, call.block);
    if (!result.ok()) fail(fmt::format("init {}", host::describe_status(result.status)));
  }
}

/// One advance of a fresh instance with the given parameters.
Frame advanced(const Case& c, const Frame& start, const host::ParameterValues& values) {
  Frame frame = start;
  const auto subject = make_subject(c, frame.world(), values);
  advance(*subject, frame, step_of(1, 1, c.seed));
  return frame;
}

void expect_same(const Frame& alone, const Frame& beside) {
  if (const auto found = alone.difference(beside))
    fail(describe(alone, *found, "alone", "beside another instance"), found->uid);
}

}  // namespace

std::string check_life_cycle(const Case& c) {
  World world(c, host::ParameterValues(*c.table), c.seed);
  Frame frame(world);
  live_in_every_order(c, frame);
  constexpr double most_seconds = 1.5;
  live(c, world, 100, most_seconds / 3);  // what is made once and kept does not count
  if (build_record().sanitizer == "address") return "leaks are the sanitizer's to find";
  const long before = heap_in_use();
  const int lives = live(c, world, 1000, most_seconds);
  const long grown = heap_in_use() - before;
  // Less than the smallest piece of memory per life is the heap's own business.
  if (grown > 16L * lives)
    fail(fmt::format("{} lives of an instance leave {} bytes behind, {:.0f} each", lives, grown,
                     static_cast<double>(grown) / lives));
  return fmt::format("{} lives", lives);
}

std::string check_instances(const Case& c) {
  for_random_states(c, {3, {}, false}, [&](World& world, Frame& start) {
    Random random(world.seed());
    const host::ParameterValues& first = world.values();
    host::ParameterValues second = first;
    for (int attempt = 0; attempt < 8; ++attempt) try {
        second = draw_numbers(random, *c.table, first);
        make_subject(c, world, second);
        break;
      } catch (const Subject::Refused&) {
        second = first;  // the values contradict each other
      }
    const Frame alone_1 = advanced(c, start, first), alone_2 = advanced(c, start, second);
    Frame beside_1 = start, beside_2 = start;
    const auto one = make_subject(c, world, first), two = make_subject(c, world, second);
    advance(*one, beside_1, step_of(1, 1, c.seed));
    advance(*two, beside_2, step_of(1, 1, c.seed));
    expect_same(alone_1, beside_1);
    expect_same(alone_2, beside_2);
  });
  return {};
}

std::string check_restart(const Case& c) {
  for_random_states(c, {}, [&](World&, Frame& start) {
    Frame whole = start, parted = start;
    const auto one = make_subject(whole);
    if (!advance(*one, whole, step_of(1, 1, c.seed)).ok()) throw StateRefused{"a step failed"};
    advance(*one, whole, step_of(2, 1, c.seed));
    std::optional<host::PrivateState> kept;
    {
      const auto before = make_subject(parted);
      advance(*before, parted, step_of(1, 1, c.seed));
      kept = before->save();
    }
    const auto after = make_subject(parted);
    if (kept) after->load(*kept);
    advance(*after, parted, step_of(2, 1, c.seed));
    if (const auto found = whole.difference(parted))
      fail(describe(whole, *found, "in one run", "after a restart"), found->uid);
  });
  return {};
}

}  // namespace pileus::conform
