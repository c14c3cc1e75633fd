// Drops of one volume of air that collide and merge: linear-time random pairing of superdroplets.
#pragma once
#include <pileus/philox.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "collision_kernels.hpp"
#include "random_words.hpp"

namespace pileus::superdroplets {

/// What superdroplets carry. Each stands for `multiplicity` ≥ 0 equal drops, so that all but the
/// multiplicity are extensive per drop: they add up when drops merge.
struct DropColumns {
  std::int64_t* multiplicity = nullptr;
  double* water_mass = nullptr;          // kg
  double* dry_volume = nullptr;          // m3; null where absent
  double* hygroscopic_volume = nullptr;  // κ times dry volume, m3; null where absent
};

struct CoalescenceOptions {
  /// Largest expected change within a sub-step of the number of drops, and of half the second
  /// moment of mass (whose rate is twice the relative growth of the drops that carry it). The
  /// sampling is a forward Euler step with the sizes and multiplicities of its start: logarithms of
  /// moments are off by about half of this per e-folding. Infinity: never divide a step for it.
  double largest_change = 0.005;
  int most_substeps = 64;
};

/// What one call did. Numbers of real drops are exact below 2^64.
struct CoalescenceOutcome {
  std::uint64_t coalescences = 0;       // of real drops: what Σ multiplicity fell by
  std::uint64_t events = 0;             // pairs of superdroplets that coalesced
  std::uint64_t emptied = 0;            // superdroplets left with multiplicity 0
  double deficit = 0;                   // coalescences drawn that drops were missing for
  std::int64_t largest_repetition = 0;  // largest γ
  int substeps = 0;
};

namespace coalescence {

/// A superdroplet, gathered: all that the choice of who coalesces looks at.
struct Record {
  std::int64_t multiplicity;
  double water_mass;
};

/// A pair that may coalesce: t = 2^32 P exceeds its random word.
struct Candidate {
  double scaled;       // t
  std::uint32_t pair;  // its members stand at order[n − 1 − 2·pair] and before
  std::uint32_t word;
};

inline constexpr double words_range = 0x1p32;

/// Numbers of the sequences of random words of a call: one, then one per sub-step and purpose.
enum class Purpose : std::uint32_t { pairs = 0, ties = 1, sample = 2 };
inline std::uint32_t sequence(Purpose purpose, int substep) {
  return static_cast<std::uint32_t>(substep) * 4u + static_cast<std::uint32_t>(purpose);
}

/// A number below `range` from a word: multiply and shift. Each has the probability 1/range to
/// within a factor 1 ± range/2^32, which for a million droplets is 1 ± 2e-4: no ensemble sees it.
inline std::size_t below(std::uint32_t word, std::size_t range) {
  return static_cast<std::size_t>(static_cast<std::uint64_t>(word) * range >> 32);
}

/// Coalescences γ = ⌊P⌋ + (u < P − ⌊P⌋) of a pair, for t = 2^32 P. u is the word and, when the word
/// alone does not decide, the number of (0, 1) that `more_digits` gives: exact for every
/// probability down to 2^-84.
template <class MoreDigits>
double draw_coalescences(double t, std::uint32_t word, MoreDigits&& more_digits) {
  const double whole = std::floor(t * (1.0 / words_range));
  if (!(whole < 0x1p52)) return whole;  // has no fraction; infinity included
  const double above = (t - whole * words_range) - static_cast<double>(word);
  if (above >= 1.0) return whole + 1.0;
  if (above <= 0.0) return whole;
  return more_digits() < above ? whole + 1.0 : whole;
}

}  // namespace coalescence

/// Room that calls reuse; one per thread.
struct CoalescenceScratch {
  std::vector<coalescence::Record> records;
  std::vector<std::uint32_t> order;
  std::vector<coalescence::Candidate> candidates;

  void fit(std::size_t droplets) {
    if (records.size() >= droplets) return;
    records.resize(droplets);
    order.resize(droplets);
    candidates.resize(droplets / 2 + 1);
  }
};

namespace coalescence {

/// One call's work on the droplets of one volume.
template <KernelOfMasses Kernel, class Index>
class Volume {
 public:
  Volume(const Kernel& kernel, const DropColumns& columns, std::span<const Index> items,
         const DrawKey& key, CoalescenceScratch& scratch)
      : kernel_(kernel),
        columns_(columns),
        items_(items),
        key_(key),
        count_(items.size()),
        records_(scratch.records.data()),
        order_(scratch.order.data()),
        candidates_(scratch.candidates.data()) {
    for (std::size_t i = 0; i < count_; ++i) {
      const auto item = static_cast<std::size_t>(items_[i]);
      records_[i] = {columns_.multiplicity[item], columns_.water_mass[item]};
      order_[i] = static_cast<std::uint32_t>(i);
    }
  }

  /// Sub-steps that keep the expected changes of a step below the bound.
  ///
  /// Judged by pairs drawn for this alone: a step shortened for the sake of the very pairs that
  /// are then treated would be shortest for the pairs that collide most, and collisions would be
  /// too rare on average. The pairs are {i, s − i} (mod n) for a random s, at most 1024 of them.
  int needed_substeps(double exposure, const CoalescenceOptions& options) const {
    if (!(options.largest_change < std::numeric_limits<double>::infinity())) return 1;
    constexpr std::size_t sample = 1024;
    const RandomWords random(key_, sequence(Purpose::sample, 0));
    std::size_t sum = below(random.block(0)[0], count_);
    if (count_ % 2 == 0) sum |= 1;  // then no droplet is its own partner
    const std::size_t stride = std::max<std::size_t>(1, count_ / 2 / sample);
    Expectation expected;
    for (std::size_t i = 0; 2 * i < sum; i += stride) expected.add(*this, i, sum - i);
    for (std::size_t i = 1; 2 * i < count_ - sum; i += stride)
      expected.add(*this, sum + i, count_ - i);
    const double steps = expected.change() * exposure * scale() / options.largest_change;
    const double most = options.most_substeps;
    return steps < most ? std::max(1, static_cast<int>(std::ceil(steps)))
                        : std::max(1, options.most_substeps);
  }

  /// Pairs all droplets at random, each with the same probability with each, and lists the pairs
  /// that may coalesce within `exposure` (dt/ΔV, s m-3).
  ///
  /// The last unpaired droplet of the order meets any of those before it, which takes the place
  /// next to it: half of a Fisher–Yates shuffle. Members are fetched one batch ahead of their use.
  void pair(double exposure, int substep) {
    const RandomWords random(key_, sequence(Purpose::pairs, substep));
    constexpr std::size_t batch = 2 * RandomWords::lanes;
    const double factor = exposure * scale() * words_range;
    listed_ = 0;
    even_ = count_;
    if (count_ % 2 == 1) {  // one droplet, each with the same probability, meets nobody
      const RandomWords odd(key_, sequence(Purpose::sample, substep));
      std::swap(order_[below(odd.block(1)[0], count_)], order_[count_ - 1]);
      --even_;
    }
    const std::size_t pairs = even_ / 2;
    for (std::size_t first = 0; first < pairs; first += batch) {
      std::uint32_t words[4][RandomWords::lanes];
      random.blocks(first / 2, words);
      const std::size_t last = std::min(pairs, first + batch);
      for (std::size_t p = first; p < last; ++p) {
        const std::size_t end = even_ - 2 * p;
        const std::size_t partner = below(words[(p & 1) * 2][(p - first) / 2], end - 1);
        std::swap(order_[partner], order_[end - 2]);
        __builtin_prefetch(&records_[order_[end - 2]]);
        __builtin_prefetch(&records_[order_[end - 1]]);
      }
      for (std::size_t p = first; p < last; ++p) {
        const std::size_t end = even_ - 2 * p;
        const Record &a = records_[order_[end - 1]], &b = records_[order_[end - 2]];
        const std::uint32_t word = words[(p & 1) * 2 + 1][(p - first) / 2];
        const double scaled = factor * rate(a, b);
        candidates_[listed_] = {scaled, static_cast<std::uint32_t>(p), word};
        listed_ += scaled > static_cast<double>(word) ? 1 : 0;
      }
    }
  }

  /// Share of the step after which no pair needs more coalescences than the larger multiplicity
  /// holds, at least `least`. These are the pairs at hand, whose time is cut; but what they cannot
  /// give would be lost otherwise.
  double safe_share(double least) const {
    double share = 1.0;
    for (std::size_t c = 0; c < listed_; ++c) {
      const double probability = candidates_[c].scaled * (1.0 / words_range);
      if (!(probability > 1.0)) continue;  // one coalescence is always possible
      const auto [more, less] = members(candidates_[c].pair);
      const std::int64_t limit = records_[more].multiplicity / records_[less].multiplicity;
      share = std::min(share, static_cast<double>(limit) / probability);
    }
    return std::max(share, least);
  }

  /// Lets the listed pairs coalesce, with probabilities for a share of the step that was listed.
  void collide(double share, int substep, CoalescenceOutcome& did) {
    const RandomWords ties(key_, sequence(Purpose::ties, substep));
    for (std::size_t c = 0; c < listed_; ++c) {
      const Candidate& candidate = candidates_[c];
      const auto [more, less] = members(candidate.pair);
      const std::int64_t limit = records_[more].multiplicity / records_[less].multiplicity;
      const double wanted = draw_coalescences(candidate.scaled * share, candidate.word, [&] {
        const auto words = ties.block(candidate.pair);
        return open_unit_interval(words[0], words[1]);
      });
      if (!(wanted > 0)) continue;
      std::int64_t repetitions = limit;
      if (wanted < static_cast<double>(limit)) repetitions = static_cast<std::int64_t>(wanted);
      did.deficit += std::max(0.0, wanted - static_cast<double>(repetitions)) *
                     static_cast<double>(records_[less].multiplicity);
      merge(more, less, repetitions, did);
    }
  }

 private:
  /// Sums over sampled pairs, for an exposure of 1.
  struct Expectation {
    double lost = 0, number = 0;    // drops
    double gained = 0, square = 0;  // second moment of mass, kg2
    void add(const Volume& volume, std::size_t i, std::size_t k) {
      const Record &a = volume.records_[i], &b = volume.records_[k];
      const auto x = static_cast<double>(a.multiplicity), y = static_cast<double>(b.multiplicity);
      const double events = volume.rate(a, b) * std::min(x, y);
      lost += events;
      gained += events * (2.0 * a.water_mass * b.water_mass);
      number += x + y;
      square += x * (a.water_mass * a.water_mass) + y * (b.water_mass * b.water_mass);
    }
    double change() const {
      const double by_number = number > 0 ? lost / number : 0.0;
      return square > 0 ? std::max(by_number, 0.5 * (gained / square)) : by_number;
    }
  };

  /// Pairs there are over pairs that meet: n(n−1)/2 over ⌊n/2⌋.
  double scale() const {
    const auto n = static_cast<double>(count_);
    return count_ % 2 == 0 ? n - 1.0 : n;
  }

  /// ξ K of a pair, ξ the larger multiplicity; 0 where one stands for no drop.
  double rate(const Record& a, const Record& b) const {
    const auto x = static_cast<double>(a.multiplicity), y = static_cast<double>(b.multiplicity);
    const double k = kernel_(a.water_mass, b.water_mass);
    const double r = std::max(x, y) * k;
    return std::min(x, y) > 0 ? r : 0.0;
  }

  struct Members {
    std::uint32_t more, less;  // by multiplicity
  };
  Members members(std::uint32_t pair) const {
    const std::size_t end = even_ - 2 * static_cast<std::size_t>(pair);
    const std::uint32_t a = order_[end - 1], b = order_[end - 2];
    return records_[a].multiplicity >= records_[b].multiplicity ? Members{a, b} : Members{b, a};
  }

  /// Each of the fewer drops swallows `repetitions` of the more (Shima et al. 2009, section 4.1.3).
  void merge(std::uint32_t more, std::uint32_t less, std::int64_t repetitions,
             CoalescenceOutcome& did) {
    Record &j = records_[more], &k = records_[less];
    const auto to = static_cast<std::size_t>(items_[less]),
               from = static_cast<std::size_t>(items_[more]);
    const auto times = static_cast<double>(repetitions);
    const std::int64_t swallowed = repetitions * k.multiplicity;
    const bool shared = swallowed == j.multiplicity;
    j.multiplicity -= swallowed;
    k.water_mass += times * j.water_mass;
    if (shared) {  // none is left over: the merged drops are divided between the two
      j.multiplicity = k.multiplicity / 2;
      k.multiplicity -= j.multiplicity;
      j.water_mass = k.water_mass;
      did.emptied += j.multiplicity == 0 ? 1 : 0;
    }
    columns_.multiplicity[to] = k.multiplicity;
    columns_.multiplicity[from] = j.multiplicity;
    columns_.water_mass[to] = k.water_mass;
    columns_.water_mass[from] = j.water_mass;
    for (double* carried : {columns_.dry_volume, columns_.hygroscopic_volume}) {
      if (carried == nullptr) continue;
      carried[to] += times * carried[from];
      if (shared) carried[from] = carried[to];
    }
    did.coalescences += static_cast<std::uint64_t>(swallowed);
    did.largest_repetition = std::max(did.largest_repetition, repetitions);
    ++did.events;
  }

  const Kernel& kernel_;
  const DropColumns& columns_;
  std::span<const Index> items_;
  const DrawKey& key_;
  std::size_t count_, even_ = 0, listed_ = 0;
  Record* records_;
  std::uint32_t* order_;
  Candidate* candidates_;
};

}  // namespace coalescence

/// Lets the superdroplets `items` of a volume of air (m3) collide for a time (s): Shima et al. 2009
/// (doi:10.1002/qj.441), multiple coalescence included, in as many sub-steps as accuracy needs.
///
/// A pair coalesces P = ξ K dt/ΔV · [n(n−1)/2]/⌊n/2⌋ times on average. Where drops run short of
/// that, the sub-step is shortened, down to 1/most_substeps of dt; what is still missing then is
/// the deficit. `items` are positions in the columns, in any order; draws are those of `key` (its
/// uid the volume's number), so that the result depends on the order of items and on nothing else.
///
/// Requires   distinct items; multiplicities ≥ 0; volume > 0, dt ≥ 0
/// Ensures    Σ multiplicity falls by `coalescences` exactly; Σ multiplicity·A is kept by every
///            event to the rounding of A += γ A; superdroplets that merge with an equal of
///            multiplicity 1 are left with multiplicity 0, for the caller to remove
template <KernelOfMasses Kernel, class Index>
CoalescenceOutcome coalesce(const Kernel& kernel, const DropColumns& columns,
                            std::span<const Index> items, double volume, double dt,
                            const DrawKey& key, const CoalescenceOptions& options,
                            CoalescenceScratch& scratch) {
  CoalescenceOutcome did;
  if (items.size() < 2 || !(dt > 0) || !(volume > 0)) return did;
  scratch.fit(items.size());
  coalescence::Volume<Kernel, Index> air(kernel, columns, items, key, scratch);
  const double nominal = 1.0 / air.needed_substeps(dt / volume, options);  // shares of dt
  const double least = 1.0 / std::max(1, options.most_substeps);
  for (double left = 1.0; left > 0; ++did.substeps) {
    const bool rest = left <= nominal * (1.0 + 1e-9);
    const double step = rest ? left : nominal;
    air.pair(dt / volume * step, did.substeps);
    const double share = air.safe_share(std::min(1.0, least / step));
    air.collide(share, did.substeps, did);
    left = rest && share == 1.0 ? 0.0 : left - share * step;
  }
  return did;
}

}  // namespace pileus::superdroplets
