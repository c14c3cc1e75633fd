#include "coupling/operator_sequence.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <numeric>

#include "base/error.hpp"
#include "base/nearest_word.hpp"
#include "base/parallel.hpp"
#include "coupling/audit.hpp"
#include "coupling/failure_report.hpp"

namespace pileus::coupling {

namespace {

/// The stream of an operator's random numbers follows from its name alone (FNV-1a), so that adding
/// or leaving out other operators changes nothing. The top bit tells the halves of a Strang step.
std::uint32_t stream_of(const std::string& name) {
  std::uint32_t hash = 2166136261u;
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 16777619u;
  return hash & 0x7FFFFFFFu;
}

constexpr std::uint32_t second_half_bit = 0x80000000u;

/// Processor time of all threads of this process, s.
double core_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void check_names(const std::vector<OperatorEntry>& operators) {
  std::vector<std::string> seen;
  for (const OperatorEntry& entry : operators) {
    if (std::find(seen.begin(), seen.end(), entry.name) != seen.end()) {
      throw Error(ExitCode::usage,
                  fmt::format("two operators are named '{}'; give them names of their own "
                              "('name:')",
                              entry.name));
    }
    seen.push_back(entry.name);
  }
}

/// Positions of the operators with apply in the order of the scene, outermost first.
std::vector<std::size_t> resolve_order(const std::vector<OperatorEntry>& operators,
                                       const std::vector<std::string>& wanted) {
  std::vector<std::size_t> order;
  std::vector<std::string> names;
  const auto has_apply = [&](std::size_t i) { return operators[i].table->op.apply != nullptr; };
  for (const OperatorEntry& entry : operators) names.push_back(entry.name);
  for (const std::string& name : wanted) {
    if (name == transport_name) continue;  // always innermost, wherever it is written
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) {
      const std::string nearest = nearest_word(name, names);
      throw Error(ExitCode::usage,
                  fmt::format("coupling.order names '{}', which is no operator of this scene{}",
                              name, nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
    }
    const auto which = static_cast<std::size_t>(found - names.begin());
    if (std::find(order.begin(), order.end(), which) != order.end()) {
      throw Error(ExitCode::usage, fmt::format("coupling.order names '{}' twice", name));
    }
    if (has_apply(which)) order.push_back(which);
  }
  for (std::size_t i = 0; i < operators.size(); ++i) {
    if (!has_apply(i) || std::find(order.begin(), order.end(), i) != order.end()) continue;
    if (!wanted.empty()) {
      throw Error(ExitCode::usage,
                  fmt::format("coupling.order leaves out the operator '{}'", names[i]));
    }
    order.push_back(i);
  }
  return order;
}

}  // namespace

OperatorSequence::OperatorSequence(std::vector<OperatorEntry> operators, SequenceOptions options)
    : operators_(std::move(operators)), options_(std::move(options)) {
  check_names(operators_);
  plan_ = plan_quantities(operators_, options_.initial);
  surface_ = SurfaceFields(plan_.surface);
  order_ = resolve_order(operators_, options_.coupling.order);
}

OperatorSequence::~OperatorSequence() = default;

bool OperatorSequence::derives_buoyancy() const {
  return std::any_of(plan_.scalars.begin(), plan_.scalars.end(), [](const parcels::Scalar& s) {
    return s.name == buoyancy_name && s.nature == parcels::Nature::derived;
  });
}

std::vector<std::string> OperatorSequence::order() const {
  std::vector<std::string> names;
  for (const std::size_t which : order_) names.push_back(operators_[which].name);
  return names;
}

std::vector<std::string> OperatorSequence::changed_quantities() const {
  std::vector<std::string> names;
  for (const std::size_t which : order_)
    for (const pileus_quantity& row : operators_[which].table->quantities)
      if ((row.access & (PILEUS_WRITE | PILEUS_ADD)) != 0) names.emplace_back(row.name);
  return names;
}

void OperatorSequence::bind(parcels::Store& store, const std::optional<pileus_grid>& grid,
                            MeshAccess* mesh) {
  store_ = &store;
  grid_ = grid;
  surface_.start(grid ? static_cast<std::size_t>(grid->cells[0] * grid->cells[1]) : 1);
  bound_.clear();  // before the mesh it is bound to
  progress_.clear();
  mesh_extension_ = mesh != nullptr ? std::make_unique<MeshExtension>(*mesh, store) : nullptr;
  mesh_quantities_ = mesh != nullptr ? std::make_unique<MeshQuantities>(*mesh, store) : nullptr;
  item_extension_ = store.items().exist() ? std::make_unique<ItemExtension>(store) : nullptr;
  const BoundMesh bound_mesh{mesh_quantities_.get(), mesh_extension_.get(), item_extension_.get()};
  for (const OperatorEntry& entry : operators_) {
    bound_.push_back(
        bind_operator(entry, store, surface_, bound_mesh, stream_of(entry.name), options_.stop));
    OperatorProgress& progress = progress_.emplace_back();
    for (const BoundCondition& c : bound_.back().conditions) {
      progress.condition_columns.push_back(c.item >= 0 ? version_of_item(store, surface_, c.item)
                                                       : c.column);
    }
    if (bound_.back().creates_items) take_over_items(bound_.back());
    progress.change.resize(entry.table->budgets.size());
    progress.source.resize(entry.table->budgets.size());
  }
  keep_what_closures_read(bound_);
  runner_ = std::make_unique<BlockRunner>(bound_, store, surface_, grid_ ? &*grid_ : nullptr,
                                          mesh_quantities_.get(), item_extension_.get());
  versions_.assign(
      static_cast<std::size_t>(version_of_item(store, surface_, item_quantities(store))),
      next_version_++);
  previous_height_ = find_column(store, previous_height_name);
  workspaces_.clear();
  stale_.reserve(plan_.closures.size());
}

/// What the operator that makes the items says about them.
void OperatorSequence::take_over_items(const BoundOperator& maker) {
  const pileus_items_ext& said = maker.instance->items();
  store_->items().set_most_per_parcel(said.most_per_parcel);
  store_->items().set_budget_scale(said.budget_scale);
  item_extension_->set_budget_scale(said.budget_scale);
}

double OperatorSequence::dt_limit() const {
  const double shares = options_.coupling.scheme == scene::Coupling::Scheme::strang ? 2.0 : 1.0;
  double limit = std::numeric_limits<double>::infinity();
  for (std::size_t which = 0; which < progress_.size(); ++which) {
    const int substeps =
        operators_[which].substeps > 0 ? operators_[which].substeps : most_substeps;
    limit = std::min(limit, progress_[which].step_limit * substeps * shares);
  }
  return limit;
}

void OperatorSequence::init(const StepTime& step) {
  prepare_workspaces();
  surface_.start(surface_.columns());
  if (store_->items().exist()) store_->items().start(store_->size());
  remember_heights();
  for (const std::size_t which : order_of_init()) {
    BoundOperator& bound = bound_[which];
    for (const std::size_t s : bound.written) {
      const pileus_quantity& row = bound.entry->table->quantities[s];
      const bool set = std::find(options_.initial.begin(), options_.initial.end(), row.name) !=
                       options_.initial.end();
      if ((row.access & PILEUS_CREATE) == 0 || set) continue;
      std::fill_n(store_->column(bound.slots[s].column), store_->size(), row.initial);
    }
    const pileus_step record = step_record(bound, step, false);
    const host::CallResult result = runner_->init(which, record, all_parcels(), whole_);
    if (!result.ok()) fail({-1, which, false, 1, record, result, {}}, "init");
  }
  population_changed();
  diagnose(step);
}

/// Whoever makes items comes first: others may have something to say about each.
std::vector<std::size_t> OperatorSequence::order_of_init() const {
  std::vector<std::size_t> order(bound_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_partition(order.begin(), order.end(),
                        [&](std::size_t which) { return bound_[which].creates_items; });
  return order;
}

/// Somebody may have raised the number of threads since the workspaces were made.
void OperatorSequence::match_threads() {
  if (workspaces_.size() < static_cast<std::size_t>(omp_get_max_threads())) prepare_workspaces();
}

void OperatorSequence::prepare_workspaces() {
  const auto threads = static_cast<std::size_t>(omp_get_max_threads());
  if (workspaces_.size() < threads) workspaces_.resize(threads);
  for (Workspace& work : workspaces_) work.reserve(bound_, block_parcels);
  const bool any_global = std::any_of(bound_.begin(), bound_.end(),
                                      [](const BoundOperator& b) { return !b.is_local(); });
  whole_.reserve(bound_, any_global ? store_->size() : 0);
  whole_.reserve_surface(bound_, surface_.columns());
  std::size_t budgets = 0;
  for (const OperatorEntry& entry : operators_) {
    budgets = std::max(budgets, entry.table->budgets.size());
  }
  const std::size_t blocks = std::max<std::size_t>(block_count(), 1);
  if (block_books_.size() < blocks * budgets) block_books_.resize(blocks * budgets);
  if (block_active_.size() < blocks) block_active_.resize(blocks);
  bounds_.prepare(bound_, store_->column_count(), blocks);
}

std::size_t OperatorSequence::block_count() const {
  return (store_->size() + block_parcels - 1) / block_parcels;
}

ParcelRange OperatorSequence::block_range(std::size_t block) const {
  const std::size_t begin = block * block_parcels;
  return {static_cast<std::int64_t>(block), begin, std::min(block_parcels, store_->size() - begin)};
}

pileus_step OperatorSequence::step_record(const BoundOperator& bound, const StepTime& at,
                                          bool second_half) const {
  pileus_step step{};
  step.size = sizeof step;
  step.stream = bound.stream | (second_half ? second_half_bit : 0u);
  step.number = at.number;
  step.seed = options_.seed;
  step.time = at.time;
  step.dt = at.dt;
  return step;
}

std::uint64_t OperatorSequence::version_of(const std::vector<int>& columns) const {
  std::uint64_t version = 0;
  for (const int column : columns) {
    version = std::max(version, versions_[static_cast<std::size_t>(column)]);
  }
  return version;
}

void OperatorSequence::population_changed() {
  std::fill(versions_.begin(), versions_.end(), next_version_++);
  withheld_stale_ = true;
  if (store_ != nullptr) prepare_workspaces();
}

/// Transport changes position, shape and vorticity, nothing else.
void OperatorSequence::touch_core() {
  std::fill_n(versions_.begin(), store_->first_scalar(), next_version_++);
}

/// What transport and upkeep move from here on is the ascent that the next calls account for.
void OperatorSequence::remember_heights() {
  if (previous_height_ < 0) return;
  const double* height = store_->position(store_->dimension() - 1);
  std::copy_n(height, store_->size(), store_->column(previous_height_));
  versions_[static_cast<std::size_t>(previous_height_)] = next_version_++;
}

bool OperatorSequence::splits_around_transport() const {
  if (options_.coupling.scheme != scene::Coupling::Scheme::strang) return false;
  for (const std::size_t which : order_)
    if (bound_[which].op().form == PILEUS_FLOW) return true;
  return false;
}

void OperatorSequence::apply_before_transport(const StepTime& step,
                                              const BetweenOperators& between) {
  if (options_.coupling.scheme != scene::Coupling::Scheme::strang) return;
  bool first = true;
  for (const std::size_t which : order_) {
    const std::uint32_t form = bound_[which].op().form;
    if (form != PILEUS_FLOW) continue;  // projections and observers act once, at the end
    if (!first && between) between();
    first = false;
    apply(which, {step.number, step.time, 0.5 * step.dt}, false);
  }
  remember_heights();
}

void OperatorSequence::apply_after_transport(const StepTime& step,
                                             const BetweenOperators& between) {
  const bool strang = options_.coupling.scheme == scene::Coupling::Scheme::strang;
  if (!order_.empty()) touch_core();
  for (auto which = order_.rbegin(); which != order_.rend(); ++which) {
    if (which != order_.rbegin() && between) between();
    if (strang && bound_[*which].op().form == PILEUS_FLOW) {
      apply(*which, {step.number, step.time + 0.5 * step.dt, 0.5 * step.dt}, true);
    } else {
      apply(*which, step, true);
    }
  }
  remember_heights();
}

/// If nothing the conditions read has changed since they were false for every parcel, they are
/// false still: one comparison.
bool OperatorSequence::skip_by_epoch(std::size_t which) {
  if (!options_.coupling.skip_inactive || bound_[which].entry->table->active_if.empty())
    return false;
  const OperatorProgress& progress = progress_[which];
  if (progress.idle_at == 0 || version_of(progress.condition_columns) > progress.idle_at)
    return false;
  workspaces_.front().applied[which].skipped_by_epoch += store_->size();
  return true;
}

void OperatorSequence::apply(std::size_t which, const StepTime& at, bool second_half) {
  if (bound_[which].dormant || bound_[which].idle) return;
  refresh(at, Derived::all);
  // An operator with a limit of its own is asked for it whether or not it is skipped.
  if (bound_[which].op().prepare == nullptr && skip_by_epoch(which)) {
    audit_idle(which, step_record(bound_[which], at, second_half));
    return;
  }
  make_mesh_quantities(which);
  const int substeps = prepare(which, at, second_half);
  pileus_step step = step_record(bound_[which], at, second_half);
  step.dt = at.dt / substeps;
  for (int k = 0; k < substeps; ++k) {
    if (k > 0) {
      refresh(at, Derived::all);
      make_mesh_quantities(which);
    }
    step.time = at.time + k * step.dt;
    step.call = static_cast<std::uint32_t>(k) * calls_per_substep;
    apply_once(which, step);
  }
}

/// The time, of all threads, is charged to the operator that asks first.
void OperatorSequence::make_mesh_quantities(std::size_t which) {
  if (bound_[which].mesh.empty()) return;
  const double before = core_seconds();
  mesh_quantities_->update(bound_[which].mesh, versions_);
  whole_.applied[which].seconds += core_seconds() - before;
}

/// Calls the prepare hook and returns the number of sub-steps its limit asks for.
int OperatorSequence::prepare(std::size_t which, const StepTime& at, bool second_half) {
  BoundOperator& bound = bound_[which];
  const int wanted = bound.entry->substeps;
  if (bound.op().prepare == nullptr) return std::max(wanted, 1);
  double limit = std::numeric_limits<double>::infinity();
  const pileus_step record = step_record(bound, at, second_half);
  pileus_block whole = runner_->block(which, all_parcels(), Derived::none, whole_);
  for (pileus_view& view : whole_.views[which]) view.access = PILEUS_READ;
  host::CallResult result = bound.instance->prepare(record, whole, limit);
  if (result.ok() && !(limit > 0)) {
    result.status = PILEUS_E_INTERNAL;
    std::snprintf(result.error.text, sizeof result.error.text,
                  "it returned the step limit %g s, which is not positive", limit);
  }
  if (!result.ok()) fail({-1, which, false, 1, record, result, {}}, "prepare");
  progress_[which].step_limit = limit;
  if (wanted > 0) return wanted;
  const double needed = std::ceil(at.dt / limit);
  if (needed > most_substeps) {
    throw Error(ExitCode::numerical,
                fmt::format("operator '{}' needs steps of at most {:.6g} s, more than {} in the "
                            "present step of {:.6g} s; lower time.step.largest",
                            bound.entry->name, limit, most_substeps, at.dt));
  }
  return std::max(1, static_cast<int>(needed));
}

void OperatorSequence::apply_once(std::size_t which, const pileus_step& step) {
  match_threads();
  const BoundOperator& bound = bound_[which];
  const std::size_t budgets = bound.entry->table->budgets.size();
  const std::size_t blocks = bound.is_local() ? block_count() : 1;
  const auto run = [&](std::size_t block, const ParcelRange& range, Workspace& work) {
    BlockBooks* books = block_books_.data() + block * budgets;
    std::fill_n(books, budgets, BlockBooks{});
    const ActiveParcels active = find_active_parcels(which, range, work);
    audit_block(which, step, range, active, work);
    block_active_[block] = active.count > 0 ? 1 : 0;
    if (active.count > 0) runner_->apply(which, step, range, active, work, books);
  };
  if (!bound.is_local()) {
    run(0, all_parcels(), whole_);
  } else if ((bound.op().flags & PILEUS_SERIAL) != 0) {
    for (std::size_t b = 0; b < blocks; ++b) run(b, block_range(b), workspaces_.front());
  } else {
    parallel_tasks(blocks, [&](std::size_t b) {
      run(b, block_range(b), workspaces_[static_cast<std::size_t>(omp_get_thread_num())]);
    });
  }
  throw_first_failure();
  throw_first_finding();
  if (mesh_quantities_ != nullptr) {
    if (bound.moves_parcels) mesh_quantities_->access().confine();
    if (bound.deforms_parcels) mesh_quantities_->access().blunt_shapes();
  }
  close_books(which, blocks);
}

/// Parcels to call the operator for, the cheapest way to exclude the others first.
ActiveParcels OperatorSequence::find_active_parcels(std::size_t which, const ParcelRange& range,
                                                    Workspace& work) {
  if (!options_.coupling.skip_inactive) return {0, range.count, {}};
  const BoundOperator& bound = bound_[which];
  OperatorCounts& counts = work.applied[which];
  if (range.block >= 0 &&
      bounds_.rule_out(bound, *store_, versions_, static_cast<std::size_t>(range.block),
                       range.begin, range.count)) {
    counts.skipped_by_bounds += range.count;
    return {0, 0, {}};
  }
  const ActiveParcels active = find_active(bound, *store_, range.begin, range.count, work);
  counts.skipped_by_list += range.count - active.active();
  return active;
}

void OperatorSequence::close_books(std::size_t which, std::size_t blocks) {
  const BoundOperator& bound = bound_[which];
  OperatorProgress& progress = progress_[which];
  const std::size_t budgets = progress.change.size();
  bool any = false;
  for (std::size_t block = 0; block < blocks; ++block) {
    any = any || block_active_[block] != 0;
    for (std::size_t b = 0; b < budgets; ++b) {
      progress.change[b].add(block_books_[block * budgets + b].change);
      progress.source[b].add(block_books_[block * budgets + b].source);
    }
  }
  if (!any) {
    progress.idle_at = version_of(progress.condition_columns);
    return;
  }
  for (const std::size_t s : bound.written) {
    versions_[static_cast<std::size_t>(bound.slots[s].column)] = next_version_;
  }
  for (const std::size_t s : bound.accumulated) {
    const int field = version_of_surface(*store_, bound.slots[s].surface);
    versions_[static_cast<std::size_t>(field)] = next_version_;
  }
  // The flow is solved for from the vorticity and the mean wind.
  if (!bound.written_domain.empty())
    versions_[static_cast<std::size_t>(store_->dimension()) + 1] = next_version_;
  for (const int item : bound.kept_items)
    versions_[static_cast<std::size_t>(version_of_item(*store_, surface_, item))] = next_version_;
  ++next_version_;
}

void OperatorSequence::throw_first_failure() {
  const BlockFailure* first = nullptr;
  for (const Workspace& work : workspaces_) {
    if (work.failure.happened() && (first == nullptr || work.failure.block < first->block)) {
      first = &work.failure;
    }
  }
  if (whole_.failure.happened()) first = &whole_.failure;
  if (first == nullptr) return;
  const BlockFailure failure = *first;
  for (Workspace& work : workspaces_) work.failure = {};
  whole_.failure = {};
  fail(failure, failure.in_diagnose ? "diagnose" : "apply");
}

void OperatorSequence::fail(const BlockFailure& failure, const char* phase) {
  const ParcelRange range =
      failure.block >= 0 ? block_range(static_cast<std::size_t>(failure.block)) : all_parcels();
  const auto bundle = make_bundle(bound_[failure.which], *store_, range, failure, phase);
  throw OperatorFailure(describe_failure(*bundle), bundle);
}

}  // namespace pileus::coupling
