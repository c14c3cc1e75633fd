// C12, C13 and C14: the result for a parcel depends on the parcel, the step and the parameters; not
// on earlier calls, the block it is in, the number of threads, or its neighbours in memory.
#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "conform/advance.hpp"

namespace pileus::conform {
namespace {

void expect_same(const Frame& expected, const Frame& found, const std::string& first,
                 const std::string& second) {
  if (const auto where = expected.difference(found))
    fail(describe(expected, *where, first.c_str(), second.c_str()), where->uid);
}

void expect_same_booking(const Advance& a, const Advance& b, const std::string& when) {
  if (a.ok() != b.ok())
    fail(fmt::format("{} a call {} that {} otherwise", when,
                     b.ok() ? "succeeds" : "fails (" + b.outcome.describe() + ")",
                     a.ok() ? "succeeds" : "fails (" + a.outcome.describe() + ")"));
}

/// A step of a fresh instance.
Frame stepped(const Frame& start, const Blocking& blocking, Advance* result = nullptr) {
  Frame frame = start;
  const auto subject = make_subject(frame);
  const Advance done = advance(*subject, frame, step_of(1, 1, start.world().seed()), blocking);
  if (result != nullptr) *result = done;
  return frame;
}

/// prepare is called once: it may change the instance.
void check_repetition(const Frame& start) {
  pileus_step step = step_of(1, 1, start.world().seed());
  Frame first = start;
  const auto subject = make_subject(first);
  CallOutcome outcome = diagnose(*subject, first, step);
  step.dt = std::min(step.dt, prepare(*subject, first, step, outcome));
  const Advance expected = apply(*subject, first, step);
  for (int repetition = 0; repetition < 2; ++repetition) {
    Frame again = start;
    diagnose(*subject, again, step);
    const Advance found = apply(*subject, again, step);
    expect_same_booking(expected, found, "called once more");
    if (expected.ok()) expect_same(first, again, "at the first call", "at the same call once more");
  }
}

}  // namespace

std::string check_repeated_calls(const Case& c) {
  for_random_states(c, {}, [&](World& world, Frame& start) {
    check_repetition(start);
    if (!world.bound().is_local()) return;
    Advance in_order, in_reverse;
    const Frame forward = stepped(start, {64, false, 1}, &in_order);
    const Frame backward = stepped(start, {64, true, 1}, &in_reverse);
    expect_same_booking(in_order, in_reverse, "with blocks in reverse order");
    if (in_order.ok())
      expect_same(forward, backward, "with blocks in order", "with blocks in reverse order");
  });
  return {};
}

std::string check_blocks_and_threads(const Case& c) {
  if (c.op().repeatability < PILEUS_REPEAT_THREADS)
    throw NotApplicable{"it promises the same bits for one number of threads alone"};
  for_random_states(c, {}, [&](World& world, Frame& start) {
    Advance expected;
    const Frame whole = stepped(start, {}, &expected);
    const auto compare = [&](const Blocking& blocking, const std::string& how) {
      Advance found;
      const Frame frame = stepped(start, blocking, &found);
      expect_same_booking(expected, found, how);
      if (expected.ok()) expect_same(whole, frame, "in one block", how);
    };
    if (world.bound().is_local())
      for (const std::size_t parcels : {1u, 7u, 256u})
        compare({parcels, false, 1}, fmt::format("in blocks of {}", parcels));
    if ((c.op().flags & PILEUS_SERIAL) != 0) return;
    for (const int threads : {2, 8})
      compare({32, false, threads}, fmt::format("on {} threads", threads));
  });
  return {};
}

std::string check_permutation(const Case& c) {
  if (c.op().scope != PILEUS_LOCAL)
    throw NotApplicable{"an operator of global scope sees all parcels together"};
  for_random_states(c, {}, [&](World& world, Frame& start) {
    std::vector<std::uint32_t> order(start.parcels()), back(start.parcels());
    std::iota(order.begin(), order.end(), 0u);
    Random random(world.seed());
    for (std::size_t k = order.size(); k > 1; --k) std::swap(order[k - 1], order[random() % k]);
    for (std::size_t k = 0; k < order.size(); ++k) back[order[k]] = static_cast<std::uint32_t>(k);
    Advance here, there;
    const Frame expected = stepped(start, {}, &here);
    Frame permuted = start;
    permuted.gather(order);
    Frame found = stepped(permuted, {}, &there);
    found.gather(back);
    expect_same_booking(here, there, "in another order of parcels");
    // How far a call came that failed depends on where the parcel stands; the core restores all.
    if (here.ok()) expect_same(expected, found, "in one order of parcels", "in another");
  });
  return {};
}

}  // namespace pileus::conform
