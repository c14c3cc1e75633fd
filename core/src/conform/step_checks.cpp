// C17, C19 and C23: how results depend on the length of the step, and what is the same the second
// time.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "conform/advance.hpp"

namespace pileus::conform {
namespace {

/// Changes below this share of a value, or this one of the largest, are rounding.
constexpr double rounding = 1e-12, rounding_of_largest = 1e-14;

bool is_compared(const FrameSlot& slot) {
  return slot.advances() && slot.kind == FrameSlot::Kind::parcel;
}

/// The largest value of what a quantity is exchanged for: itself, and all of its budget. Vapour
/// that becomes cloud rounds as the cloud does, however little of it there is.
double largest_value(const Frame& frame, std::size_t slot) {
  const auto& rows = frame.world().bound().entry->table->quantities;
  double largest = 0;
  for (std::size_t s = 0; s < frame.slots().size(); ++s) {
    const bool same_budget = rows[s].budget != nullptr && rows[slot].budget != nullptr &&
                             std::string_view(rows[s].budget) == rows[slot].budget;
    if (!is_compared(frame.slots()[s]) || !(s == slot || same_budget)) continue;
    for (std::size_t p = 0; p < frame.parcels(); ++p)
      largest = std::max(largest, std::abs(frame.slots()[s].values.numbers()[p]));
  }
  return largest;
}

/// For every quantity of the parcels that apply writes: the sum over parcels of |a − b|, parcel by
/// parcel without what is rounding.
std::vector<double> distances(const Frame& a, const Frame& b) {
  std::vector<double> sums;
  for (std::size_t s = 0; s < a.slots().size(); ++s) {
    const FrameSlot &x = a.slots()[s], &y = b.slots()[s];
    sums.push_back(0);
    if (!is_compared(x)) continue;
    const double largest = largest_value(a, s);
    for (std::size_t p = 0; p < a.parcels(); ++p) {
      const double u = x.values.numbers()[p], v = y.values.numbers()[p];
      const double distance = std::abs(u - v);
      const double noise =
          std::max(rounding * std::max(std::abs(u), std::abs(v)), rounding_of_largest * largest);
      if (distance > noise && std::isfinite(distance)) sums.back() += distance;
    }
  }
  return sums;
}

/// The state after `steps` steps of equal length; nothing if one of them failed.
std::optional<Frame> after(const Frame& start, double dt, int steps) {
  Frame frame = start;
  const auto subject = make_subject(frame);
  for (int k = 0; k < steps; ++k) {
    const pileus_step step = step_of(static_cast<std::uint64_t>(k) + 1, dt, start.world().seed());
    if (!advance(*subject, frame, step).ok()) return std::nullopt;
  }
  return frame;
}

/// The state after steps of 0 s, of which no limit asks for parts.
std::optional<Frame> after_no_time(const Frame& start, int steps) {
  Frame frame = start;
  const auto subject = make_subject(frame);
  for (int k = 0; k < steps; ++k) {
    const pileus_step step = step_of(static_cast<std::uint64_t>(k) + 1, 0, start.world().seed());
    CallOutcome outcome = diagnose(*subject, frame, step);
    if (outcome.ok()) prepare(*subject, frame, step, outcome);
    if (outcome.ok()) outcome = apply(*subject, frame, step).outcome;
    if (!outcome.ok()) return std::nullopt;
  }
  return frame;
}

constexpr double hardly_any_time = 1e-6;  // s

/// Some of what operators do takes no time: droplets are activated, sizes put into their range.
/// That must be done once it is done. Returns the state after hardly any time, in balance; what has
/// jumped on the way goes to `remark`.
Frame balanced(const Frame& start, std::string& remark) {
  const std::optional<Frame> once = after_no_time(start, 1), twice = after_no_time(start, 2);
  if (!once || !twice) throw StateRefused{"a step of 0 s failed"};
  const std::vector<double> second = distances(*once, *twice);
  for (std::size_t s = 0; s < second.size(); ++s)
    if (second[s] > 0)
      fail(fmt::format("a step of 0 s changes {}, and the next one again", start.name(s)));
  const std::optional<Frame> soon = after(*once, hardly_any_time, 1);
  const std::optional<Frame> later = soon ? after(*soon, hardly_any_time, 1) : std::nullopt;
  if (!later) throw StateRefused{"a short step failed"};
  const std::vector<double> first = distances(start, *soon), then = distances(*soon, *later);
  for (std::size_t s = 0; s < first.size(); ++s)
    if (first[s] > 3 * then[s] && remark.find(start.name(s)) == std::string::npos)
      remark += (remark.empty() ? "at once, whatever the step, it adjusts " : ", ") +
                std::string(start.name(s));
  return *soon;
}

/// Whether changes get small from a step to a hundredth of it: deterministic ones fall by 100,
/// random ones, which go with the root, by 10. What does not goes to `seen`.
bool settles(const Frame& start, double step, std::string& seen) {
  constexpr double share = 1e-2, most = 0.3;
  const std::optional<Frame> longer = after(start, step, 1),
                             shorter = after(start, step * share, 1);
  if (!longer || !shorter) return true;
  const std::vector<double> a = distances(start, *longer), b = distances(start, *shorter);
  for (std::size_t s = 0; s < a.size(); ++s) {
    if (!(b[s] > most * a[s] && b[s] > 0)) continue;
    seen += fmt::format("{}{} changes by {:.3g} in a step of {:g} s and by {:.3g} in one of {:g} s",
                        seen.empty() ? "" : ", ", start.name(s), a[s], step, b[s], step * share);
    return false;
  }
  return true;
}

/// The time in which the smallest drop evaporates is the operator's own: a microsecond, or less of
/// what has just been activated.
void check_first_order(const Frame& start) {
  std::string seen;
  for (const double step : {1e-6, 1e-8, 1e-10})
    if (settles(start, step, seen)) return;
  fail(seen + ": it does not settle as the step goes to nothing");
}

/// By what share of its change the state after two steps differs from that after one of twice the
/// length, in the quantity where it is largest; nothing if a step fails.
struct Apart {
  double share = 0;
  std::size_t slot = 0;
  bool changes = false;  // whether anything does
};
std::optional<Apart> two_steps_apart(const Frame& start, double dt) {
  const std::optional<Frame> one = after(start, 2 * dt, 1), two = after(start, dt, 2);
  if (!one || !two) return std::nullopt;
  const std::vector<double> change = distances(start, *one), apart = distances(*one, *two);
  Apart largest;
  for (std::size_t s = 0; s < change.size(); ++s) {
    if (!(change[s] > 0)) continue;
    largest.changes = true;
    if (apart[s] > largest.share * change[s]) largest = {apart[s] / change[s], s, true};
  }
  return largest;
}

/// Two steps differ from one of twice the length by less of the change the shorter they are. How
/// short they have to be is the operator's own: of drops of a few nanometres, microseconds. So the
/// steps become shorter until that is seen, or until nothing changes any more.
void check_flow(const Case& c, const Frame& start) {
  if ((c.op().flags & PILEUS_RANDOM) != 0) return;
  constexpr double negligible = 1e-3, less = 0.5;
  std::string seen;
  std::optional<Apart> longer;
  for (const double dt : {0.01, 1e-4, 1e-6, 1e-8}) {
    const std::optional<Apart> apart = two_steps_apart(start, dt);
    if (!apart) return;
    if (dt < 1e-4 && !apart->changes) break;
    if (longer && (apart->share <= negligible || apart->share <= less * longer->share)) return;
    longer = apart;
    seen += fmt::format("{}{:.2g} of the change of {} for {:g} s", seen.empty() ? "" : ", ",
                        apart->share, start.name(apart->slot), dt);
  }
  fail(
      fmt::format("two steps and one of twice the length differ by {}: it is not the flow of an "
                  "equation",
                  seen));
}

/// Of operators that call themselves stiff: a second long step changes less than the first.
void expect_towards_equilibrium(const Frame& start, double dt) {
  const std::optional<Frame> once = after(start, dt, 1), twice = after(start, dt, 2);
  if (!once || !twice) return;
  const std::vector<double> first = distances(start, *once), second = distances(*once, *twice);
  for (std::size_t s = 0; s < first.size(); ++s)
    if (second[s] > first[s])
      fail(
          fmt::format("it is declared stiff, but {} changes by {:.3g} in a step of {:g} s and by "
                      "{:.3g} in the next: it does not approach an equilibrium",
                      start.name(s), first[s], dt, second[s]));
}

void expect_form(const Case& c, std::uint32_t form, const char* why) {
  if (c.op().form != form) throw NotApplicable{why};
}

void check_projection(const Frame& start) {
  const std::optional<Frame> once = after(start, 1, 1), twice = after(start, 1, 2);
  if (!once || !twice) throw StateRefused{"a step failed"};
  const std::vector<double> moved = distances(*once, *twice);
  for (std::size_t s = 0; s < moved.size(); ++s)
    if (moved[s] > 0)
      fail(fmt::format("applied twice, the projection changes {} again, by {:.3g} in all",
                       start.name(s), moved[s]));
}

/// What diagnose finds in the derived slots must not matter.
void check_purity(const Frame& start) {
  Frame zeros = start, garbage = start;
  for (Frame* frame : {&zeros, &garbage})
    for (FrameSlot& slot : frame->slots()) {
      if (!slot.exists() || !slot.derived || !slot.writable) continue;
      for (std::size_t i = 0; i < slot.values.size(); ++i)
        slot.values.numbers()[i] = frame == &zeros ? 0.0 : 1e3 + static_cast<double>(i);
    }
  const auto subject = make_subject(start);
  const pileus_step step = step_of(1, 1, start.world().seed());
  if (!diagnose(*subject, zeros, step).ok()) throw StateRefused{"diagnose failed"};
  diagnose(*subject, garbage, step);
  if (const auto found = zeros.difference(garbage))
    fail(describe(zeros, *found, "where its place held 0", "where it held another number"),
         found->uid);
}

}  // namespace

std::string check_small_steps(const Case& c) {
  expect_form(c, PILEUS_FLOW, "only a flow depends on the length of the step");
  std::string remark;
  for_random_states(c, {3, {}, true}, [&](World&, Frame& start) {
    const Frame state = balanced(start, remark);
    check_first_order(state);
    check_flow(c, state);
  });
  return remark;
}

std::string check_large_steps(const Case& c) {
  expect_form(c, PILEUS_FLOW, "only a flow depends on the length of the step");
  for_random_states(c, {3, {}, true}, [&](World&, Frame& start) {
    for (const double dt : {1.0, 10.0, 1e3, 1e6}) {
      const std::optional<Frame> done = after(start, dt, 1);
      if (!done) continue;  // it says so
      if (const auto bad = find_bad_value(*done, false))
        fail(fmt::format("in a step of {:g} s {}", dt, describe(*done, *bad)), bad->uid);
    }
    if ((c.op().flags & PILEUS_STIFF) != 0) expect_towards_equilibrium(start, 1e6);
  });
  return {};
}

std::string check_projection_and_closure(const Case& c) {
  const bool projects = c.op().form == PILEUS_PROJECTION, derives = c.op().diagnose != nullptr;
  if (!projects && !derives) throw NotApplicable{"it is no projection and derives nothing"};
  for_random_states(c, {}, [&](World&, Frame& start) {
    if (projects) check_projection(start);
    if (derives) check_purity(start);
  });
  return {};
}

}  // namespace pileus::conform
