// The operators of a run in their declared order: what they need, when they are called, what they
// brought about. Transport is the core's own and innermost:
//
//   lie      transport, then the operators from the last of the order to the first
//   strang   the operators in order for half a step, transport, in reverse order for half a step
#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "coupling/block_bounds.hpp"
#include "coupling/block_runner.hpp"
#include "coupling/failure.hpp"
#include "coupling/ledger.hpp"
#include "coupling/mesh_access.hpp"
#include "coupling/operator_entry.hpp"
#include "coupling/operator_progress.hpp"
#include "coupling/quantity_plan.hpp"
#include "mesh/grid.hpp"
#include "parcels/store.hpp"
#include "scene/scene.hpp"

namespace pileus::coupling {

/// The core's own part of a step, as it may be named in coupling.order.
inline constexpr const char* transport_name = "transport";

/// The moment a call happens at.
struct StepTime {
  std::uint64_t number = 0;  // of the step
  double time = 0;           // s, its beginning
  double dt = 0;             // s, the whole step
};

struct SequenceOptions {
  scene::Coupling coupling;
  std::vector<std::string> initial;  // scalars the initial state sets
  std::uint64_t seed = 0;
  bool (*stop)() = nullptr;  // answers the plugins' should_stop, on any thread
};

/// The grid record plugins see.
template <int D>
pileus_grid abi_grid(const mesh::Grid<D>& grid) {
  pileus_grid abi{};
  abi.dimension = D;
  for (int axis = 0; axis < 3; ++axis) abi.cells[axis] = 1;
  for (int d = 0; d < D; ++d) {
    const int axis = d == D - 1 ? 2 : d;
    abi.cells[axis] = grid.cells[d];
    abi.origin[axis] = grid.lower[d];
    abi.spacing[axis] = grid.spacing[d];
    abi.periodic[axis] = d == D - 1 ? 0 : 1;
  }
  return abi;
}

/// By the names of the operators.
using PrivateStates = std::map<std::string, host::PrivateState>;

class OperatorSequence {
 public:
  /// Plans quantities and order. Errors  Error(ExitCode::usage) with every contradiction
  OperatorSequence(std::vector<OperatorEntry> operators, SequenceOptions options);
  ~OperatorSequence();
  OperatorSequence(const OperatorSequence&) = delete;
  OperatorSequence& operator=(const OperatorSequence&) = delete;

  /// The scalars to build the store with.
  const std::vector<parcels::Scalar>& required_scalars() const { return plan_.scalars; }
  /// The items to build the store with.
  const parcels::ItemDeclaration& required_items() const { return plan_.items; }
  /// The declared quantities of the surface; empty of values before bind(). Whoever restores them
  /// does so before resume().
  SurfaceFields& surface() { return surface_; }
  const SurfaceFields& surface() const { return surface_; }
  /// True if an operator derives the buoyancy; else it is carried by the parcels.
  bool derives_buoyancy() const;
  bool empty() const { return operators_.empty(); }
  const std::vector<OperatorEntry>& operators() const { return operators_; }
  /// Quantities that some operator's apply may change.
  std::vector<std::string> changed_quantities() const;
  /// Names of the operators with an apply hook, outermost first.
  std::vector<std::string> order() const;

  /// Creates and configures the instances on the columns of `store` and on `mesh` (null: a run
  /// without one), which must outlive this. The surface has the columns of `grid`; a box without
  /// one stands on a single column. Errors  Error(ExitCode::plugin) if a plugin refuses its
  /// parameters
  void bind(parcels::Store& store, const std::optional<pileus_grid>& grid,
            MeshAccess* mesh = nullptr);

  /// Starts a new run: owned quantities get their declared value, except those of `initial`, and
  /// the plugins' init hooks are called. Then diagnoses.
  void init(const StepTime& step);
  /// Starts from a checkpoint whose state is in the store. Then diagnoses.
  /// Errors  Error(ExitCode::usage) without a name of the checkpoint if private states are missing
  /// or not asked for; Error(ExitCode::plugin) if an operator refuses its own
  void resume(const StepTime& step, const PrivateStates& states = {});
  /// What operators keep beside their quantities. Errors  Error(ExitCode::plugin)
  PrivateStates private_states() const;

  /// Brings every derived quantity up to date with parcels that have moved.
  void diagnose(const StepTime& step);
  /// The same within a step: without what operators derive on demand.
  void diagnose_stage(const StepTime& step);
  /// Whether apply_before_transport does anything: some operator advances in half steps.
  bool splits_around_transport() const;
  /// Called between two operators of one pass: what the first wrote may call for an effect of the
  /// next that waits to be switched on.
  using BetweenOperators = std::function<void()>;
  /// Operators before the transport of a step (Strang only).
  void apply_before_transport(const StepTime& step, const BetweenOperators& between = {});
  /// Operators after the transport of a step. Derived quantities are up to date with what the
  /// operators read, but need `diagnose` afterwards.
  void apply_after_transport(const StepTime& step, const BetweenOperators& between = {});
  /// To be called after merge, split, sort: parcels are other ones than before.
  void population_changed();

  /// Switches a watched effect on, from the next call of a hook on. True if an operator waited.
  bool activate(const std::string& effect);

  /// Largest step the operators can take with their most sub-steps, s; infinite without a limit.
  double dt_limit() const;

  /// Costs, counts and budgets since the start.
  Ledger ledger() const;
  /// The accumulated budgets and the operators' limits of the step as plain numbers for a
  /// checkpoint, and back after bind.
  std::vector<double> books() const;
  void restore_books(const std::vector<double>& books);

 private:
  void prepare_workspaces();
  pileus_step step_record(const BoundOperator& bound, const StepTime& at, bool second_half) const;
  std::vector<std::size_t> order_of_init() const;
  void refresh(const StepTime& step, Derived what);
  void run_closures(const StepTime& step, Derived what);
  void match_threads();
  void apply(std::size_t which, const StepTime& at, bool second_half);
  bool skip_by_epoch(std::size_t which);
  int prepare(std::size_t which, const StepTime& at, bool second_half);
  void make_mesh_quantities(std::size_t which);
  void apply_once(std::size_t which, const pileus_step& step);
  ActiveParcels find_active_parcels(std::size_t which, const ParcelRange& range, Workspace& work);
  void audit_block(std::size_t which, const pileus_step& step, const ParcelRange& range,
                   const ActiveParcels& active, Workspace& work);
  void audit_idle(std::size_t which, const pileus_step& step);
  void throw_first_finding();
  void close_books(std::size_t which, std::size_t blocks);
  std::uint64_t version_of(const std::vector<int>& columns) const;
  void touch_core();
  void take_over_items(const BoundOperator& maker);
  void remember_heights();
  void clear_withheld();
  void throw_first_failure();
  [[noreturn]] void fail(const BlockFailure& failure, const char* phase);
  std::size_t block_count() const;
  ParcelRange block_range(std::size_t block) const;
  ParcelRange all_parcels() const { return {-1, 0, store_->size()}; }

  std::vector<OperatorEntry> operators_;
  SequenceOptions options_;
  QuantityPlan plan_;
  std::vector<std::size_t> order_;  // operators with apply, outermost first
  SurfaceFields surface_;
  parcels::Store* store_ = nullptr;
  std::optional<pileus_grid> grid_;
  int previous_height_ = -1;  // column, if an operator asks for it
  std::unique_ptr<MeshExtension> mesh_extension_;
  std::unique_ptr<MeshQuantities> mesh_quantities_;  // null without a mesh
  std::unique_ptr<ItemExtension> item_extension_;    // null without items
  std::vector<BoundOperator> bound_;
  std::unique_ptr<BlockRunner> runner_;
  BlockBounds bounds_;
  std::vector<std::size_t> stale_;          // closures to run now
  std::vector<Workspace> workspaces_;       // per thread
  Workspace whole_;                         // for calls with all parcels
  std::vector<OperatorProgress> progress_;  // per operator
  std::vector<BlockBooks> block_books_;     // per block and budget of the present call
  std::vector<std::uint8_t> block_active_;  // per block: the present call did something
  std::vector<std::uint64_t> versions_;     // per column and surface field, raised by changes
  std::uint64_t next_version_ = 1;
  bool withheld_stale_ = true;  // derived quantities of watched effects need their zeros again
};

}  // namespace pileus::coupling
