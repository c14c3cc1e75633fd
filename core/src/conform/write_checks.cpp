// C11: hooks write what they declare, of the parcels they are called for, and nothing else.
#include <fmt/format.h>

#include "conform/advance.hpp"
#include "conform/guarded_call.hpp"

namespace pileus::conform {
namespace {

void expect_no_forbidden_write(const char* hook, const std::optional<std::string>& found) {
  if (found) fail(fmt::format("in {} {}", hook, *found));
}

void check_diagnose(Subject& subject, Frame& frame, const pileus_step& step) {
  if (subject.table().op.diagnose == nullptr) return;
  Call call;
  frame.record(0, frame.parcels(), true, call);
  expect_no_forbidden_write(
      "diagnose", call_guarded(frame, call, true, [&] { subject.diagnose(step, call.block); }));
}

void check_prepare(Subject& subject, Frame& frame, const pileus_step& step) {
  if (subject.table().op.prepare == nullptr) return;
  Call call;
  frame.record(0, frame.parcels(), false, call);
  Frame before = frame;
  double limit = 0;
  subject.prepare(step, call.block, limit);
  if (const auto found = before.difference(frame))
    fail("in prepare it wrote: " + describe(before, *found, "before", "after"), found->uid);
}

void expect_others_untouched(const Frame& before, const Frame& after,
                             const std::vector<bool>& called) {
  for (std::size_t s = 0; s < after.slots().size(); ++s) {
    const FrameSlot& slot = after.slots()[s];
    if (!slot.advances()) continue;
    const bool of_items = slot.kind == FrameSlot::Kind::item;
    if (!of_items && slot.kind != FrameSlot::Kind::parcel) continue;
    for (std::size_t p = 0; p < after.parcels(); ++p) {
      if (called[p]) continue;
      const std::size_t first = of_items ? after.item_begin(p) : p;
      const std::size_t end = of_items ? after.item_begin(p + 1) : p + 1;
      for (std::size_t i = first; i < end; ++i)
        if (slot.values.bits(i) != before.slots()[s].values.bits(i))
          fail(fmt::format("it changed {} of parcel {}, for which it was not called", after.name(s),
                           after.uid(p)),
               after.uid(p));
    }
  }
}

/// A local operator is called for three parcels of four.
void check_apply(Subject& subject, Frame& frame, const pileus_step& step) {
  if (subject.table().op.apply == nullptr) return;
  std::vector<std::uint32_t> active;
  std::vector<bool> called(frame.parcels(), true);
  const bool local = frame.world().bound().is_local();
  for (std::size_t p = 0; local && p < frame.parcels(); ++p) {
    called[p] = p % 4 != 1;
    if (called[p]) active.push_back(static_cast<std::uint32_t>(p));
  }
  if (frame.world().bound().resizes_items) {
    apply(subject, frame, step);  // the lists are the core's, which checks the calls
    return;
  }
  const Frame before = frame;
  Call call;
  frame.record(0, frame.parcels(), false, call, local ? &active : nullptr);
  expect_no_forbidden_write(
      "apply", call_guarded(frame, call, false, [&] { subject.apply(step, call.block); }));
  expect_others_untouched(before, frame, called);
}

}  // namespace

std::string check_writes(const Case& c) {
  for_random_states(c, {}, [&](World&, Frame& frame) {
    const auto subject = make_subject(frame);
    const pileus_step step = step_of(1, 1, c.seed);
    check_diagnose(*subject, frame, step);
    check_prepare(*subject, frame, step);
    check_apply(*subject, frame, step);
  });
  return {};
}

}  // namespace pileus::conform
