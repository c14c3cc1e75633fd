// One operator on one block: views, snapshot, call, guard, retry with halved steps.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

#include "coupling/activity.hpp"
#include "coupling/workspace.hpp"

namespace pileus::coupling {

/// Halvings after which a parcel's step is given up.
inline constexpr int most_halvings = 3;
/// Numbers a retry tree needs: 1 + 2 + 4 + 8 calls, rounded to a power of two. A call is numbered
/// sub-step·16 + (2^level − 1) + part, so that no two calls of a step share random numbers.
inline constexpr std::uint32_t calls_per_substep = 16;

/// What one operator brought about in one block, per budget of the operator.
struct BlockBooks {
  double change = 0;  // of the budget's total, by the operator's writes
  double source = 0;  // declared by it as brought in from outside
};

/// A range of the store.
struct ParcelRange {
  std::int64_t block = -1;  // −1: all parcels
  std::size_t begin = 0, count = 0;
};

/// Which derived quantities a call is to compute.
enum class Derived {
  none,           // it advances the others
  within_a_step,  // those that the flow needs
  all,
};

inline bool is_left_out(const BoundSlot& slot, Derived what) {
  return slot.withheld || (slot.on_demand && what == Derived::within_a_step);
}

class BlockRunner {
 public:
  /// `mesh` is null when no operator reads the mesh, `items` in a run without any.
  BlockRunner(const std::vector<BoundOperator>& operators, parcels::Store& store,
              SurfaceFields& surface, const pileus_grid* grid, const MeshQuantities* mesh,
              ItemExtension* items)
      : operators_(operators),
        store_(store),
        surface_(surface),
        grid_(grid),
        mesh_(mesh),
        items_(items) {}

  /// Runs the init hook and checks what it wrote.
  host::CallResult init(std::size_t which, const pileus_step& step, const ParcelRange& range,
                        Workspace& work) const;

  /// Runs the diagnose hook of operator `which`. False: work.failure was set; what it derived is
  /// not to be used.
  bool diagnose(std::size_t which, const pileus_step& step, const ParcelRange& range, Derived what,
                Workspace& work) const;

  /// Runs the apply hook on the given active parcels of the range and books the result into
  /// `books` (one per budget, added to). False: work.failure was set and the range is as before.
  bool apply(std::size_t which, const pileus_step& step, const ParcelRange& range,
             const ActiveParcels& active, Workspace& work, BlockBooks* books) const;

  /// Calls the apply hook on parcels of the range that were found inactive (`skipped`, empty: all)
  /// and puts everything back. What they would have changed goes to work.finding.
  void audit(std::size_t which, const pileus_step& step, const ParcelRange& range,
             std::span<const std::uint32_t> skipped, Workspace& work) const;

  /// A record over the range in which the derived quantities to compute or, with none of them, all
  /// others are writable as declared. It refers to `work`.
  pileus_block block(std::size_t which, const ParcelRange& range, Derived what,
                     Workspace& work) const;

 private:
  struct Attempt;
  void show_items(std::size_t which, const ParcelRange& range, Workspace& work,
                  pileus_block& record) const;
  bool items_violate(const Attempt& a, host::CallResult& result) const;
  void snapshot_items(const Attempt& a) const;
  void restore_items(const Attempt& a, std::span<const std::uint32_t> list) const;
  void book_items(const Attempt& a, BlockBooks* books) const;
  void find_difference_of_items(const Attempt& a, AuditFinding& finding) const;
  host::CallResult call_once(const Attempt& a, std::span<const std::uint32_t> list,
                             const pileus_step& step) const;
  bool try_level(Attempt& a, std::span<const std::uint32_t> list, int level) const;
  bool writes_violate(const Attempt& a, std::span<const std::uint32_t> list,
                      host::CallResult& result) const;
  bool advance(Attempt& a, std::span<const std::uint32_t> list, int level) const;
  void snapshot(const Attempt& a) const;
  void restore(const Attempt& a, std::span<const std::uint32_t> list) const;
  void book(const Attempt& a, BlockBooks* books) const;
  void find_difference(const Attempt& a, AuditFinding& finding) const;
  void record_failure(const Attempt& a, std::span<const std::uint32_t> list,
                      bool in_diagnose) const;

  const std::vector<BoundOperator>& operators_;
  parcels::Store& store_;
  SurfaceFields& surface_;
  const pileus_grid* grid_;
  const MeshQuantities* mesh_;
  ItemExtension* items_;
};

}  // namespace pileus::coupling
