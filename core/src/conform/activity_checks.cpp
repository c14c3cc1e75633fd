// C15 and C16: a parcel for which no condition of activity holds is one that apply would leave as
// it is, and whole steps come to the same with and without skipping.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "conform/advance.hpp"

namespace pileus::conform {
namespace {

void expect_conditions(const Case& c) {
  if (c.table->active_if.empty()) throw NotApplicable{"it is always active"};
}

/// The value itself and its neighbours, zeros of both signs and the smallest numbers: where a
/// comparison changes its mind.
double draw_boundary(Random& random, double value) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  constexpr double tiny = std::numeric_limits<double>::denorm_min();
  switch (random() % 6) {
    case 0:
      return value;
    case 1:
      return std::nextafter(value, infinity);
    case 2:
      return std::nextafter(value, -infinity);
    case 3:
      return value == 0 ? -0.0 : value;
    case 4:
      return value == 0 ? tiny : value;
    default:
      return value - std::abs(value) * 0.5;
  }
}

/// Items of no things, for three parcels of four.
void empty_lists(Frame& frame, FrameSlot& multiplicity) {
  for (std::size_t p = 0; p < frame.parcels(); ++p)
    for (std::size_t k = frame.item_begin(p); p % 4 != 0 && k < frame.item_begin(p + 1); ++k)
      multiplicity.values.integers()[k] = 0;
}

/// Moves what conditions compare to the edge of activity, for three parcels of four.
void move_to_boundaries(Frame& frame, Random& random) {
  for (const coupling::BoundCondition& condition : frame.world().bound().conditions) {
    FrameSlot& slot = frame.slots()[condition.slot];
    if (condition.item == 0) empty_lists(frame, slot);
    if (slot.derived || slot.kind != FrameSlot::Kind::parcel) continue;
    for (std::size_t p = 0; p < frame.parcels(); ++p)
      if (p % 4 != 0)
        slot.values.numbers()[p] =
            std::clamp(draw_boundary(random, condition.value), slot.range.low, slot.range.high);
  }
}

std::vector<std::uint32_t> inactive_parcels(const Frame& frame) {
  std::vector<std::uint32_t> list;
  for (std::size_t p = 0; p < frame.parcels(); ++p)
    if (!is_active(frame, p)) list.push_back(static_cast<std::uint32_t>(p));
  return list;
}

std::size_t check_inactive(const Case& c, Frame& frame) {
  Random random(frame.world().seed());
  move_to_boundaries(frame, random);
  const auto subject = make_subject(frame);
  const pileus_step step = step_of(1, 1, c.seed);
  CallOutcome outcome = diagnose(*subject, frame, step);
  if (!outcome.ok()) throw StateRefused{outcome.describe()};
  prepare(*subject, frame, step, outcome);
  const std::vector<std::uint32_t> inactive = inactive_parcels(frame);
  if (inactive.empty()) return 0;
  const Frame before = frame;
  const Advance done = apply(*subject, frame, step, {}, &inactive);
  if (!done.ok()) fail("called for inactive parcels alone it " + done.outcome.describe());
  if (const auto found = before.difference(frame))
    fail(describe(before, *found, "before", "after a call for inactive parcels alone"), found->uid);
  for (std::size_t b = 0; b < done.ledger.size(); ++b)
    if (done.ledger[b] != 0)
      fail(fmt::format("it books {:g} of {} for inactive parcels", done.ledger[b],
                       c.table->budgets[b]));
  return inactive.size();
}

/// Columns and items after three steps by the core's own sequence of operators.
std::vector<Words> run_sequence(const Case& c, const host::ParameterValues& values,
                                std::uint64_t seed, bool skip, double audit) {
  World world(c, values, seed);
  coupling::SequenceOptions options;
  options.initial = Surroundings(c, values).initial();
  options.seed = seed;
  options.coupling.skip_inactive = skip;
  options.coupling.audit = audit;
  coupling::OperatorSequence sequence(world.sequence().operators(), std::move(options));
  sequence.bind(world.store(), world.grid(), &world.mesh());
  sequence.resume({0, 0, 0});
  for (std::uint64_t step = 1; step <= 3; ++step) {
    const coupling::StepTime at{step, static_cast<double>(step), 1.0};
    sequence.apply_before_transport(at);
    sequence.apply_after_transport(at);
    sequence.diagnose(at);
  }
  std::vector<Words> result;
  for (int k = 0; k < world.store().column_count(); ++k)
    result.emplace_back(world.store().column(k), world.store().size());
  const parcels::ItemLists& items = world.store().items();
  for (std::size_t k = 0; k < items.declaration().columns.size(); ++k)
    result.emplace_back(items.column(static_cast<int>(k)), items.size());
  return result;
}

void expect_same(const std::vector<Words>& a, const std::vector<Words>& b, const char* how) {
  for (std::size_t k = 0; k < a.size(); ++k)
    for (std::size_t i = 0; i < a[k].size(); ++i)
      if (a[k].size() != b[k].size() || a[k].bits(i) != b[k].bits(i))
        fail(
            fmt::format("three steps end in other bits {} than with inactive parcels skipped "
                        "({:.17g} and {:.17g})",
                        how, b[k].numbers()[i], a[k].numbers()[i]));
}

}  // namespace

std::string check_inactive_parcels(const Case& c) {
  expect_conditions(c);
  if (c.op().apply == nullptr) throw NotApplicable{"a closure has no apply"};
  std::size_t looked_at = 0;
  for_random_states(c, {6, {}, true},
                    [&](World&, Frame& frame) { looked_at += check_inactive(c, frame); });
  if (looked_at == 0) throw NotApplicable{"no random parcel was inactive"};
  return fmt::format("{} inactive parcels", looked_at);
}

std::string check_skipping(const Case& c) {
  expect_conditions(c);
  for_random_states(c, {3, {}, true}, [&](World& world, Frame&) {
    try {
      const auto skipping = run_sequence(c, world.values(), world.seed(), true, 0);
      expect_same(skipping, run_sequence(c, world.values(), world.seed(), false, 0), "without it");
      expect_same(skipping, run_sequence(c, world.values(), world.seed(), true, 1),
                  "under an audit");
    } catch (const Error& error) {
      const std::string text = error.what();
      if (text.find("audit") != std::string::npos || text.find("inactive") != std::string::npos)
        fail(text);
      throw StateRefused{text};
    }
  });
  return {};
}

}  // namespace pileus::conform
