// C18, C20 and C21: what comes out is admissible, and sums are what they have to be.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numeric>

#include "conform/advance.hpp"

namespace pileus::conform {
namespace {

using Kind = FrameSlot::Kind;

double draw_step(Random& random, double longest) {
  return longest * std::pow(10.0, uniform(random, -4, 0));
}

/// Two steps of a random length. True: they succeeded.
bool expect_admissible(const Case& c, World& world, const Frame& start) {
  Random random(world.seed() + 99);
  Frame frame = start;
  const auto subject = make_subject(frame);
  for (std::uint64_t number = 1; number <= 2; ++number) {
    const pileus_step step = step_of(number, draw_step(random, 10), c.seed);
    const Advance done = advance(*subject, frame, step);
    if (!done.ok()) return false;
    for (const bool derived : {true, false})
      if (const auto bad = find_bad_value(frame, derived))
        fail(fmt::format("in a step of {:.4g} s {}", step.dt, describe(frame, *bad)), bad->uid);
    for (std::size_t b = 0; b < done.ledger.size(); ++b)
      if (!std::isfinite(done.ledger[b]))
        fail(fmt::format("it books {:g} of {}", done.ledger[b], c.table->budgets[b]));
  }
  return true;
}

/// Σ of what the written quantities of a budget hold, and of its size, in long doubles: the sum's
/// own rounding stays below that of the parts.
struct Holdings {
  long double sum = 0, size = 0;
};

Holdings holdings(const Frame& frame, const std::string& budget) {
  Holdings all;
  const host::OperatorTable& table = *frame.world().bound().entry->table;
  const double scale = frame.world().store().items().budget_scale();
  const auto multiplicity = frame.multiplicity();
  const auto add = [&](long double term) {
    all.sum += term;
    all.size += std::abs(term);
  };
  for (std::size_t s = 0; s < frame.slots().size(); ++s) {
    const FrameSlot& slot = frame.slots()[s];
    const pileus_quantity& row = table.quantities[s];
    if (!slot.advances() || row.budget == nullptr || budget != row.budget) continue;
    if (slot.kind == Kind::item && multiplicity) {
      const std::int64_t* number = frame.slots()[*multiplicity].values.integers();
      for (std::size_t k = 0; k < slot.values.size(); ++k)
        add(static_cast<long double>(number[k]) * slot.values.numbers()[k] / scale);
    } else if (slot.kind == Kind::parcel) {
      const bool amount = row.nature == PILEUS_EXTENSIVE;
      for (std::size_t p = 0; p < frame.parcels(); ++p)
        add((amount ? 1.0L : static_cast<long double>(frame.volume(p))) * slot.values.numbers()[p]);
    }
  }
  return all;
}

/// Differences parcel by parcel round by a few units in the last place of what the parcel holds.
void expect_closed(const Case& c, const Frame& before, const Frame& after, const Advance& done) {
  for (std::size_t b = 0; b < c.table->budgets.size(); ++b) {
    const Holdings then = holdings(before, c.table->budgets[b]);
    const Holdings now = holdings(after, c.table->budgets[b]);
    const long double defect = now.sum - then.sum - static_cast<long double>(done.ledger[b]);
    const long double allowed =
        64 * 1.1e-16L * (then.size + now.size + std::abs(static_cast<long double>(done.ledger[b])));
    if (std::abs(defect) > allowed && std::isfinite(static_cast<double>(now.sum)))
      fail(fmt::format(
          "a step of {} changes by {:.6g}, of which {:.6g} are booked: {:.3g} are "
          "unaccounted for, {:.3g} of what there is",
          c.table->budgets[b], static_cast<double>(now.sum - then.sum), done.ledger[b],
          static_cast<double>(defect), static_cast<double>(defect / std::max(then.size, 1e-300L))));
  }
}

bool writes_a_budget(const Case& c) {
  return std::any_of(c.table->quantities.begin(), c.table->quantities.end(),
                     [](const pileus_quantity& row) {
                       return row.budget != nullptr && row.nature != PILEUS_DERIVED &&
                              (row.access & (PILEUS_WRITE | PILEUS_CREATE)) != 0;
                     });
}

bool deforms_parcels(const Case& c) {
  return std::any_of(c.table->quantities.begin(), c.table->quantities.end(),
                     [](const pileus_quantity& row) {
                       return row.place == PILEUS_PARCEL && (row.access & PILEUS_WRITE) != 0 &&
                              std::string_view(row.name).starts_with("shape_");
                     });
}

/// Every parcel as two halves of it side by side; things in items are shared out evenly.
Frame halved(Frame start) {
  std::vector<std::uint32_t> twice;
  for (std::uint32_t p = 0; p < start.parcels(); ++p) twice.insert(twice.end(), {p, p});
  start.gather(twice);
  return start;
}

bool is_amount(const Frame& frame, std::size_t s) {
  const pileus_quantity& row = frame.world().bound().entry->table->quantities[s];
  return row.nature == PILEUS_EXTENSIVE || std::string_view(row.name) == coupling::volume_name;
}

/// What a half has of a number of the whole: half of an amount, the square of a length that is
/// smaller by the root of the dimension, all of anything else.
double share_of_half(const Frame& frame, std::size_t s) {
  if (is_amount(frame, s)) return 0.5;
  const bool shape = std::string_view(frame.name(s)).starts_with("shape_");
  return shape ? std::pow(0.5, 2.0 / frame.world().store().dimension()) : 1.0;
}

/// Makes all amounts even, so that halves are exact.
void make_even(Frame& frame) {
  const auto multiplicity = frame.multiplicity();
  if (!multiplicity) return;
  for (std::size_t k = 0; k < frame.items(); ++k)
    frame.slots()[*multiplicity].values.integers()[k] &= ~std::int64_t{1};
}

void halve(Frame& frame) {
  const auto multiplicity = frame.multiplicity();
  for (std::size_t s = 0; s < frame.slots().size(); ++s) {
    FrameSlot& slot = frame.slots()[s];
    if (multiplicity && s == *multiplicity) {
      for (std::size_t k = 0; k < slot.values.size(); ++k) slot.values.integers()[k] /= 2;
    } else if (slot.kind == Kind::parcel) {
      const double share = share_of_half(frame, s);
      for (std::size_t p = 0; p < frame.parcels(); ++p) slot.values.numbers()[p] *= share;
    }
  }
}

void expect_sums(const Frame& whole, const Frame& halves) {
  constexpr double tolerance = 1e-9;
  for (std::size_t s = 0; s < whole.slots().size(); ++s) {
    const FrameSlot& slot = whole.slots()[s];
    if (!slot.advances() || slot.kind != Kind::parcel) continue;
    const double share = share_of_half(whole, s);
    for (std::size_t p = 0; p < whole.parcels(); ++p) {
      const double x = slot.values.numbers()[p];
      const double* y = halves.slots()[s].values.numbers() + 2 * p;
      const double merged = 0.5 * (y[0] + y[1]) / share;
      if (std::abs(merged - x) > tolerance * std::max(std::abs(x), std::abs(merged)))
        fail(fmt::format("{} of parcel {} is {:.12g} after a step, and {:.12g} when its two halves "
                         "take the step and merge",
                         whole.name(s), whole.uid(p), x, merged),
             whole.uid(p));
    }
  }
}

}  // namespace

std::string check_random_states(const Case& c) {
  int succeeded = 0, failed = 0;
  const auto look = [&](World& world, Frame& start) {
    (expect_admissible(c, world, start) ? succeeded : failed)++;
  };
  for_random_states(c, {4, {false, 3}, true}, look);
  if (succeeded == 0) fail(fmt::format("not one of {} ordinary states can be advanced", failed));
  for (const int dimension : {3, 2}) try {
      for_random_states(c, {6, {true, dimension}, true}, look);
    } catch (const Finding& finding) {
      // That it takes no state at all over the whole declared box is an answer, too.
      if (finding.text.find("takes none") == std::string::npos) throw;
    }
  return fmt::format("{} states advanced, {} declined", succeeded, failed);
}

std::string check_budgets(const Case& c) {
  if (!writes_a_budget(c)) throw NotApplicable{"it writes no quantity of a budget"};
  constexpr int steps = 25;
  constexpr double most_seconds = 5;  // of the processor, per state: tolerances are drawn as well
  int calls = 0;
  for_random_states(c, {4, {}, true}, [&](World& world, Frame& start) {
    const std::clock_t begin = std::clock();
    Random random(world.seed() + 7);
    Frame frame = start;
    const auto subject = make_subject(frame);
    for (std::uint64_t number = 1; number <= steps; ++number) {
      if (static_cast<double>(std::clock() - begin) > most_seconds * CLOCKS_PER_SEC) break;
      const Frame before = frame;
      const Advance done = advance(*subject, frame, step_of(number, draw_step(random, 30), c.seed));
      if (!done.ok()) throw StateRefused{done.outcome.describe()};
      expect_closed(c, before, frame, done);
      ++calls;
    }
  });
  return fmt::format("{} calls on {} parcels", calls, population);
}

std::string check_split_parcels(const Case& c) {
  if (c.op().scope != PILEUS_LOCAL || c.op().apply == nullptr)
    throw NotApplicable{"only a local operator sees each parcel for itself"};
  if ((c.op().flags & PILEUS_RANDOM) != 0)
    throw NotApplicable{"the halves of a parcel have random numbers of their own"};
  if (deforms_parcels(c))
    throw NotApplicable{"it changes what parcels span, by laws in which their size may count"};
  for_random_states(c, {}, [&](World&, Frame& start) {
    make_even(start);
    Frame halves = halved(start);
    halve(halves);
    const auto one = make_subject(start), two = make_subject(start);
    const pileus_step step = step_of(1, 1, c.seed);
    if (!advance(*one, start, step).ok() || !advance(*two, halves, step, {2 * population}).ok())
      throw StateRefused{"a step failed"};
    expect_sums(start, halves);
  });
  return {};
}

}  // namespace pileus::conform
