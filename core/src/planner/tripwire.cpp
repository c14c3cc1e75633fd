#include "planner/tripwire.hpp"

#include <algorithm>
#include <chrono>
#include <limits>

#include "base/parallel.hpp"

namespace pileus::planner {
namespace {

constexpr std::size_t block_parcels = 1024;
constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

std::size_t block_count(std::size_t parcels) {
  return (parcels + block_parcels - 1) / block_parcels;
}

}  // namespace

/// One watched effect.
struct Tripwires::Wire {
  Trip trip;                                 // what to report
  std::vector<RuleNumber> formulas;          // per thread
  std::vector<double> initial;               // extrema the plan was made with
  std::vector<std::vector<double>> extrema;  // per thread: arguments of its formula
};

/// Extrema of one quantity per block, as of an epoch; 0: never.
struct Tripwires::Range {
  std::uint64_t epoch = 0;
  std::vector<double> blocks;  // low, high of each
  double low = 0, high = 0;
};

Tripwires::Tripwires(const Plan& plan) : quantities_(plan.quantities) {
  for (const EffectPlan& effect : plan.effects) {
    const bool demanded_off = effect.forced && effect.verdict == Verdict::off;
    if (effect.verdict == Verdict::on || !effect.formula || effect.providers.empty() ||
        demanded_off)
      continue;
    Wire wire;
    wire.trip.effect = effect.effect;
    wire.trip.was_watched = effect.verdict == Verdict::watch;
    wire.trip.stop = !wire.trip.was_watched || effect.stop_on_trip;
    wire.trip.threshold = effect.rule_case->threshold;
    wire.trip.quantity = effect.rule_case->quantity;
    wire.formulas.push_back(*effect.formula);
    for (std::size_t i = 0; i < 2 * quantities_.size(); ++i)
      wire.initial.push_back(effect.formula->value(i));
    wires_.push_back(std::move(wire));
  }
  ranges_.resize(quantities_.size());
}

Tripwires::~Tripwires() = default;
Tripwires::Tripwires(Tripwires&&) noexcept = default;
Tripwires& Tripwires::operator=(Tripwires&&) noexcept = default;

void Tripwires::disarm(const std::string& effect) {
  std::erase_if(wires_, [&](const Wire& wire) { return wire.trip.effect == effect; });
}

/// Columns of the quantities (−1: not carried in this run) and room for every thread and block.
void Tripwires::prepare(const parcels::Store& store) {
  if (columns_.empty()) {
    columns_.push_back(store.dimension() - 1);  // height
    for (std::size_t q = 1; q < quantities_.size(); ++q) {
      const int scalar = store.find_scalar(quantities_[q]);
      columns_.push_back(scalar < 0 ? -1 : store.first_scalar() + scalar);
    }
  }
  const auto threads = static_cast<std::size_t>(omp_get_max_threads());
  for (Wire& wire : wires_) {
    while (wire.formulas.size() < threads) wire.formulas.push_back(wire.formulas.front());
    wire.extrema.resize(std::max(threads, wire.extrema.size()), wire.initial);
  }
  const std::size_t blocks = block_count(store.size());
  if (calling_.size() < blocks) calling_.resize(blocks + blocks / 8);
  for (Range& range : ranges_)
    if (range.blocks.size() < 2 * blocks) range.blocks.resize(2 * blocks + 2 * (blocks / 8));
}

bool Tripwires::follows(const Wire& wire, std::size_t quantity) const {
  return columns_[quantity] >= 0 && wire.formulas.front().uses_quantity(quantity);
}

/// Brings the extrema a wire uses up to date: the height always, the rest when it has changed.
void Tripwires::refresh(const parcels::Store& store, const Wire& wire) {
  const std::size_t blocks = block_count(store.size());
  for (std::size_t q = 0; q < quantities_.size(); ++q) {
    Range& range = ranges_[q];
    if (!follows(wire, q) || (q > 0 && range.epoch == epoch_)) continue;
    range.epoch = epoch_;
    const double* x = store.column(columns_[q]);
    parallel_tasks(blocks, [&](std::size_t b) {
      double low = std::numeric_limits<double>::infinity(), high = -low;
      const std::size_t end = std::min(store.size(), (b + 1) * block_parcels);
      for (std::size_t p = b * block_parcels; p < end; ++p) {
        low = x[p] < low ? x[p] : low;
        high = x[p] > high ? x[p] : high;
      }
      range.blocks[2 * b] = low;
      range.blocks[2 * b + 1] = high;
    });
    range.low = std::numeric_limits<double>::infinity();
    range.high = -range.low;
    for (std::size_t b = 0; b < blocks; ++b) {
      range.low = std::min(range.low, range.blocks[2 * b]);
      range.high = std::max(range.high, range.blocks[2 * b + 1]);
    }
  }
}

std::optional<Trip> Tripwires::check(const parcels::Store& store) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  prepare(store);
  std::optional<Trip> found;
  for (Wire& wire : wires_)
    if (!found) found = check(store, wire);
  ++checks_;
  seconds_ += std::chrono::duration<double>(Clock::now() - start).count();
  return found;
}

std::optional<Trip> Tripwires::check(const parcels::Store& store, Wire& wire) {
  refresh(store, wire);
  std::vector<double>& whole = wire.extrema.front();
  for (std::size_t q = 0; q < quantities_.size(); ++q) {
    if (!follows(wire, q)) continue;
    whole[2 * q] = ranges_[q].low;
    whole[2 * q + 1] = ranges_[q].high;
  }
  RuleNumber& formula = wire.formulas.front();
  if (!formula.calls(formula(whole.data()))) return std::nullopt;

  const std::size_t blocks = block_count(store.size());
  parallel_tasks(blocks, [&](std::size_t b) { calling_[b] = first_calling(store, wire, b); });
  const auto end = calling_.begin() + static_cast<std::ptrdiff_t>(blocks);
  const auto found = std::find_if(calling_.begin(), end, [](std::size_t p) { return p != none; });
  if (found == end) return std::nullopt;
  Trip trip = wire.trip;
  trip.number = number_of(store, wire, 0, *found);
  trip.uid = store.uid()[*found];
  return trip;
}

/// The rule's number for one parcel.
double Tripwires::number_of(const parcels::Store& store, Wire& wire, std::size_t thread,
                            std::size_t parcel) const {
  double* own = wire.extrema[thread].data();
  for (std::size_t q = 0; q < quantities_.size(); ++q)
    if (follows(wire, q)) own[2 * q] = own[2 * q + 1] = store.column(columns_[q])[parcel];
  return wire.formulas[thread](own);
}

/// The first parcel of a block that calls for the effect, or none.
std::size_t Tripwires::first_calling(const parcels::Store& store, Wire& wire,
                                     std::size_t block) const {
  const auto thread = static_cast<std::size_t>(omp_get_thread_num());
  RuleNumber& formula = wire.formulas[thread];
  double* own = wire.extrema[thread].data();
  for (std::size_t q = 0; q < quantities_.size(); ++q) {
    if (!follows(wire, q)) continue;
    own[2 * q] = ranges_[q].blocks[2 * block];
    own[2 * q + 1] = ranges_[q].blocks[2 * block + 1];
  }
  if (!formula.calls(formula(own))) return none;
  const std::size_t end = std::min(store.size(), (block + 1) * block_parcels);
  for (std::size_t p = block * block_parcels; p < end; ++p)
    if (formula.calls(number_of(store, wire, thread, p))) return p;
  return none;
}

}  // namespace pileus::planner
