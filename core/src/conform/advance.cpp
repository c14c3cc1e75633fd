#include "conform/advance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.hpp"

namespace pileus::conform {
namespace {

using Kind = FrameSlot::Kind;

struct Part {
  std::size_t begin, count;
};

std::vector<Part> parts_of(const Frame& frame, const Blocking& blocking) {
  if (!frame.world().bound().is_local()) return {{0, frame.parcels()}};
  std::vector<Part> parts;
  for (std::size_t begin = 0; begin < frame.parcels(); begin += blocking.parcels)
    parts.push_back({begin, std::min(blocking.parcels, frame.parcels() - begin)});
  if (blocking.backwards) std::reverse(parts.begin(), parts.end());
  return parts;
}

/// Calls hook(part, call) for every part on the given number of threads; the first failure wins.
template <class Hook>
std::vector<CallOutcome> on_parts(const std::vector<Part>& parts, int threads, Hook&& hook) {
  std::vector<CallOutcome> outcomes(parts.size());
  const int before = omp_get_max_threads();
  omp_set_num_threads(threads);
  if (threads == 1 || parts.size() == 1) {
    for (std::size_t k = 0; k < parts.size(); ++k) outcomes[k] = hook(k);
  } else {
    parallel_tasks(parts.size(), [&](std::size_t k) { outcomes[k] = hook(k); });
  }
  omp_set_num_threads(before);
  return outcomes;
}

CallOutcome first_failure(const std::vector<CallOutcome>& outcomes) {
  CallOutcome first;
  for (const CallOutcome& outcome : outcomes) {
    const bool changed = first.changed_arithmetic || outcome.changed_arithmetic;
    if (first.ok() && !outcome.ok()) first = outcome;
    first.changed_arithmetic = changed;
  }
  return first;
}

/// Points the record at the items of the world, after these have been regrouped.
void show_items(Frame& frame, Call& call, pileus_block& block) {
  const pileus_block fresh = frame.world().whole(coupling::Derived::none);
  for (std::size_t s = 0; s < frame.slots().size(); ++s) {
    if (frame.slots()[s].kind != Kind::item) continue;
    call.views[s].data = fresh.views[s].data;
    call.views[s].count = fresh.views[s].count;
  }
  block.item_begin = fresh.item_begin;
  block.item_count = fresh.item_count;
}

/// A call of an operator that may give the parcels other items, on the items of the world.
CallOutcome apply_resizing(Subject& subject, Frame& frame, const pileus_step& step, Call& call) {
  frame.give_items_to_world();
  show_items(frame, call, call.block);
  CallOutcome outcome;
  {
    const coupling::ItemExtension::Permission permission(
        frame.world().items(), [&](pileus_block& block) { show_items(frame, call, block); });
    outcome = subject.apply(step, call.block);
  }
  frame.take_items_of_world();
  return outcome;
}

bool compare(double x, std::uint32_t op, double value) {
  switch (op) {
    case PILEUS_LT:
      return x < value;
    case PILEUS_LE:
      return x <= value;
    case PILEUS_GT:
      return x > value;
    case PILEUS_GE:
      return x >= value;
    default:
      return x != value;
  }
}

bool holds(const Frame& frame, const coupling::BoundCondition& c, std::size_t parcel) {
  const FrameSlot& slot = frame.slots()[c.slot];
  if (slot.kind == Kind::parcel)
    return compare(slot.values.numbers()[parcel], c.comparison, c.value);
  for (std::size_t k = frame.item_begin(parcel); k < frame.item_begin(parcel + 1); ++k) {
    const double x =
        c.item == 0 ? static_cast<double>(slot.values.integers()[k]) : slot.values.numbers()[k];
    if (compare(x, c.comparison, c.value)) return true;
  }
  return false;
}

}  // namespace

CallOutcome diagnose(Subject& subject, Frame& frame, const pileus_step& step,
                     const Blocking& blocking) {
  if (subject.table().op.diagnose == nullptr) return {};
  const std::vector<Part> parts = parts_of(frame, blocking);
  return first_failure(on_parts(parts, blocking.threads, [&](std::size_t k) {
    Call call;
    frame.record(parts[k].begin, parts[k].count, true, call);
    return subject.diagnose(step, call.block);
  }));
}

Advance apply(Subject& subject, Frame& frame, const pileus_step& step, const Blocking& blocking,
              const std::vector<std::uint32_t>* active) {
  const std::vector<Part> parts =
      active == nullptr ? parts_of(frame, blocking) : std::vector<Part>{{0, frame.parcels()}};
  std::vector<std::vector<double>> books(parts.size());
  const bool resizes = frame.world().bound().resizes_items;
  Advance result;
  result.outcome = first_failure(on_parts(parts, blocking.threads, [&](std::size_t k) {
    Call call;
    frame.record(parts[k].begin, parts[k].count, false, call, active);
    CallOutcome outcome =
        resizes ? apply_resizing(subject, frame, step, call) : subject.apply(step, call.block);
    books[k] = call.ledger;
    return outcome;
  }));
  result.ledger.assign(subject.table().budgets.size(), 0.0);
  for (const std::vector<double>& book : books)
    for (std::size_t b = 0; b < result.ledger.size(); ++b) result.ledger[b] += book[b];
  return result;
}

double prepare(Subject& subject, Frame& frame, const pileus_step& step, CallOutcome& outcome) {
  double limit = std::numeric_limits<double>::infinity();
  Call call;
  frame.record(0, frame.parcels(), false, call);
  for (pileus_view& view : call.views) view.access = PILEUS_READ;
  outcome = subject.prepare(step, call.block, limit);
  return limit;
}

Advance advance(Subject& subject, Frame& frame, const pileus_step& step, const Blocking& blocking) {
  Advance result;
  result.ledger.assign(subject.table().budgets.size(), 0.0);
  result.outcome = diagnose(subject, frame, step, blocking);
  if (!result.ok()) return result;
  const double limit = prepare(subject, frame, step, result.outcome);
  if (!result.ok()) return result;
  const double parts = std::max(1.0, std::ceil(step.dt / limit));
  // Between sub-steps the core blunts shapes, which nobody does here.
  const int most = frame.world().bound().deforms_parcels ? 1 : coupling::most_substeps;
  if (!(parts <= most)) {
    result.outcome.status = PILEUS_RETRY;
    std::snprintf(result.outcome.error.text, sizeof result.outcome.error.text,
                  "it needs steps of at most %g s", limit);
    return result;
  }
  pileus_step part = step;
  part.dt = step.dt / parts;
  for (int k = 0; k < static_cast<int>(parts) && result.ok(); ++k) {
    part.time = step.time + k * part.dt;
    part.call = static_cast<std::uint32_t>(k) * coupling::calls_per_substep;
    if (k > 0) result.outcome = diagnose(subject, frame, part, blocking);
    if (!result.ok()) break;
    const Advance done = apply(subject, frame, part, blocking);
    result.outcome = done.outcome;
    for (std::size_t b = 0; b < result.ledger.size(); ++b) result.ledger[b] += done.ledger[b];
  }
  return result;
}

std::unique_ptr<Subject> make_subject(const Frame& frame) {
  return std::make_unique<Subject>(*frame.world().bound().entry->table, frame.world().values(),
                                   frame.world().lent());
}
std::unique_ptr<Subject> make_subject(const Case& c, World& world, host::ParameterValues values) {
  return std::make_unique<Subject>(*c.table, std::move(values), world.lent());
}

void for_random_states(const Case& c, const Draws& draws,
                       const std::function<void(World&, Frame&)>& look) {
  int taken = 0;
  std::string why;
  for (int state = 0; state < draws.states; ++state) {
    const std::uint64_t seed = c.seed + static_cast<std::uint64_t>(state);
    Random random(seed);
    try {
      host::ParameterValues values(*c.table);
      // Random values may contradict each other, which a plugin may say.
      if (state > 0 && draws.random_parameters) values = draw_parameters(random, *c.table);
      World world(c, std::move(values), seed, draws.kind);
      Frame frame(world);
      look(world, frame);
      ++taken;
    } catch (const StateRefused& refused) {
      why = refused.why;
    } catch (const Subject::Refused& refused) {
      why = refused.phase + " " + refused.outcome.describe();
    } catch (Finding& finding) {
      finding.seed = seed;
      throw;
    }
  }
  if (taken == 0) fail("it takes none of the random states: " + why);
}

bool is_active(const Frame& frame, std::size_t parcel) {
  const auto& conditions = frame.world().bound().conditions;
  if (frame.world().bound().entry->table->active_if.empty()) return true;
  for (std::size_t k = 0; k < conditions.size();) {
    const std::uint32_t clause = conditions[k].clause;
    bool all = true;
    for (; k < conditions.size() && conditions[k].clause == clause; ++k)
      all = all && holds(frame, conditions[k], parcel);
    if (all) return true;
  }
  return false;
}

std::optional<BadValue> find_bad_value(const Frame& frame, bool of_diagnose) {
  for (std::size_t s = 0; s < frame.slots().size(); ++s) {
    const FrameSlot& slot = frame.slots()[s];
    if (!slot.exists() || !slot.writable || slot.derived != of_diagnose) continue;
    const bool counts = frame.world().bound().slots[s].item == 0;
    for (std::size_t i = 0; i < slot.values.size(); ++i) {
      const double x =
          counts ? static_cast<double>(slot.values.integers()[i]) : slot.values.numbers()[i];
      if (x >= slot.range.low && x <= slot.range.high) continue;
      const std::uint64_t uid = slot.kind == Kind::parcel ? frame.uid(i)
                                : slot.kind == Kind::item ? frame.owner_of_item(i)
                                                          : 0;
      return BadValue{s, uid, x};
    }
  }
  return std::nullopt;
}

std::string describe(const Frame& frame, const BadValue& bad) {
  const Range range = frame.slots()[bad.slot].range;
  const std::string of = bad.uid != 0 ? fmt::format(" of parcel {}", bad.uid) : "";
  return fmt::format("{}{} became {:.17g}, allowed is [{:.6g}, {:.6g}]", frame.name(bad.slot), of,
                     bad.value, range.low, range.high);
}

}  // namespace pileus::conform
