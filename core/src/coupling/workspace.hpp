// What one thread needs to run operators on blocks: allocated once, used in every step.
#pragma once
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "base/aligned_array.hpp"
#include "coupling/bound_operator.hpp"
#include "coupling/item_snapshot.hpp"

namespace pileus::coupling {

/// Parcels per block: block boundaries depend on nothing but the number of parcels. Long enough to
/// hide a call (about 50 ns), short enough for the block's columns to stay in the second-level
/// cache from one operator to the next.
inline constexpr std::size_t block_parcels = 1024;

/// Why a block could not be completed.
struct BlockFailure {
  std::int64_t block = std::numeric_limits<std::int64_t>::max();
  std::size_t which = 0;  // operator
  bool in_diagnose = false;
  int attempts = 0;
  pileus_step step{};
  host::CallResult result;
  std::vector<std::uint32_t> active;  // given; empty: all

  bool happened() const { return block != std::numeric_limits<std::int64_t>::max(); }
};

/// A skipped parcel that its operator would have changed.
struct AuditFinding {
  std::int64_t block = std::numeric_limits<std::int64_t>::max();
  std::size_t which = 0;  // operator
  std::uint64_t uid = 0;
  std::string what;  // "would have taken x from 1 to 2"

  bool found() const { return block != std::numeric_limits<std::int64_t>::max(); }
};

/// Counts of one operator, summed over threads in the ledger. Skipped parcels by what ruled them
/// out: nothing having changed, extrema of their block, their own values.
struct OperatorCounts {
  std::uint64_t calls = 0, parcels = 0, retries = 0, audited = 0;
  std::uint64_t skipped_by_epoch = 0, skipped_by_bounds = 0, skipped_by_list = 0;
  double seconds = 0;  // of one core

  std::uint64_t skipped() const { return skipped_by_epoch + skipped_by_bounds + skipped_by_list; }
  void add(const OperatorCounts& other) {
    calls += other.calls;
    parcels += other.parcels;
    retries += other.retries;
    audited += other.audited;
    skipped_by_epoch += other.skipped_by_epoch;
    skipped_by_bounds += other.skipped_by_bounds;
    skipped_by_list += other.skipped_by_list;
    seconds += other.seconds;
  }
};

/// Of one thread; not shared.
struct alignas(cache_line_bytes) Workspace {
  std::vector<std::vector<pileus_view>> views;  // per operator, static members filled in
  AlignedArray<double> snapshot;                // of the written columns, one after another
  std::size_t snapshot_stride = 0;              // parcels per column in it
  AlignedArray<double> surface_snapshot;        // of the surface fields added to
  std::vector<double> domain_snapshot;          // of the numbers of the domain written
  ItemSnapshot item_snapshot;                   // of the items' quantities written
  std::vector<std::int64_t> item_begin;         // per parcel of the block, from its first item on
  std::vector<std::uint32_t> active, everyone, skipped;  // index lists of up to a block
  std::vector<std::uint8_t> mask, clause_mask;
  std::vector<double> ledger, attempt;             // sources: of the block, of the present attempt
  std::vector<OperatorCounts> diagnosed, applied;  // per operator
  BlockFailure failure;
  AuditFinding finding;

  /// Makes room for blocks of `parcels`; allocates only when that grows.
  void reserve(const std::vector<BoundOperator>& operators, std::size_t parcels);
  /// Makes room for the surface of a call with all parcels.
  void reserve_surface(const std::vector<BoundOperator>& operators, std::size_t columns);
};

}  // namespace pileus::coupling
