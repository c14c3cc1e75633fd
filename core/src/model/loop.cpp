#include "model/loop.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>

#include "base/error.hpp"
#include "base/signals.hpp"
#include "model/activation_record.hpp"
#include "model/failure_files.hpp"
#include "model/initial_state.hpp"
#include "model/private_state_record.hpp"
#include "model/provenance.hpp"
#include "output/posix_file.hpp"
#include "planner/plan_text.hpp"

namespace pileus::model {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Processor time of all threads of this process, s.
double core_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

coupling::SequenceOptions sequence_options(const scene::Scene& scene) {
  coupling::SequenceOptions options;
  options.coupling = scene.coupling;
  options.seed = scene.seed;
  options.stop = stop_requested;
  for (const auto& [name, field] : scene.initial.scalars) options.initial.push_back(name);
  return options;
}

constexpr double status_interval = 1.0;  // s of wall time between updates of status.json

}  // namespace

Loop::Loop(const scene::Scene& scene, PlannedRun planned, const output::RunDirectory& directory,
           Progress& progress)
    : scene_(scene),
      directory_(directory),
      progress_(progress),
      plan_(std::move(planned.plan)),
      sequence_(std::move(planned.operators), sequence_options(scene)),
      physics_(sequence_, planner::Tripwires(plan_)),
      simulation_(make_simulation(scene, sequence_.required_scalars(), physics_,
                                  sequence_.required_items())) {
  sequence_.bind(simulation_->store(), simulation_->plugin_grid(), &simulation_->mesh_access());
  std::vector<std::string> budgets;
  for (const coupling::BudgetTotal& total : sequence_.ledger().totals)
    budgets.push_back(total.budget);
  if (scene.diagnostics.slabs.wanted)
    slabs_ = std::make_unique<SlabStatistics>(scene, simulation_->store());
  diagnostics_ =
      std::make_unique<Diagnostics>(scene, *simulation_, sequence_.surface(),
                                    sequence_.changed_quantities(), budgets, slabs_.get());
  check_expectations(scene.expect, diagnostics_->list());
  record_ = std::make_unique<Record>(diagnostics_->list());
}

Loop::~Loop() = default;

void Loop::open_streams(output::Start start) {
  streams_ =
      std::make_unique<OutputStreams>(scene_, *simulation_, sequence_.surface(), slabs_.get(),
                                      *record_, directory_, run_provenance(scene_, plan_), start);
}

void Loop::start(bool overwrite) {
  simulation_->initialise(scene_);
  give_initial_surface(scene_, simulation_->plugin_grid(), sequence_.surface());
  sequence_.init({0, 0.0, 0.0});
  if (overwrite) {
    // Constructed once for its checks: nothing is removed for a run that cannot start.
    open_streams(output::Start::overwrite());
    directory_.remove_previous_run();
  }
  open_streams(output::Start::fresh());
  output::replace_file(directory_ / "plan.json", planner::plan_json(plan_));
  totals_.parcels_initial = simulation_->store().size();
  initial_budgets_ = sequence_.ledger().totals;
}

bool Loop::resume() {
  const auto path = output::find_newest_valid_checkpoint(directory_.path());
  if (!path) return false;
  const output::Checkpoint checkpoint = output::read_checkpoint(*path, simulation_->store());
  simulation_->set_clock(checkpoint.time, checkpoint.step, checkpoint.dt);
  simulation_->restore(checkpoint.data);
  physics_.resume_at(checkpoint.step);
  sequence_.surface().restore(checkpoint.data.arrays);
  restore_activations(checkpoint.data, physics_);
  activations_reported_ = physics_.activations().size();
  try {
    sequence_.resume({checkpoint.step, checkpoint.time, checkpoint.dt},
                     private_states_of(checkpoint.data));
  } catch (const Error& error) {
    throw Error(error.code(), fmt::format("cannot continue from the checkpoint '{}': {}",
                                          path->string(), error.what()));
  }
  sequence_.restore_books(checkpoint.data.arrays.at("books"));
  record_->restore(checkpoint.data, checkpoint.time);
  diagnostics_->restore(checkpoint.data);
  restore_totals(checkpoint.data);
  // The record of the checkpoint's own time is written again: a checkpoint precedes its outputs.
  open_streams(output::Start::resume_at(std::nextafter(checkpoint.time, -1.0)));
  streams_->resume(*record_, checkpoint.data);
  output::replace_file(directory_ / "plan.json", planner::plan_json(plan_));
  progress_.message(fmt::format("continuing from {} (t = {:.6g} s, step {})",
                                path->filename().string(), checkpoint.time, checkpoint.step));
  if (checkpoint.data.texts.at("scene") != scene_.resolved_yaml)
    progress_.message("the scene has changed since this checkpoint was written");
  return true;
}

void Loop::run() {
  started_ = last_checkpoint_ = last_status_ = Clock::now();
  progress_.begin(scene_.title.empty() ? scene_.name : scene_.title, simulation_->time(),
                  scene_.time.end);
  core_started_ = core_seconds();
  const auto settle_clocks = [&] {
    totals_.wall += seconds_since(started_);
    totals_.core += core_seconds() - core_started_;
  };
  try {
    advance();
    settle_clocks();
  } catch (const Error& error) {
    settle_clocks();
    progress_.end();
    status_ = output::Summary::Status::failed;
    message_ = error.what();
    if (error.code() != ExitCode::numerical && error.code() != ExitCode::plugin) throw;
    const std::string bundle =
        write_failure(directory_.path(), error, *simulation_, scene_.resolved_yaml);
    message_ += fmt::format("{} The state is in {}.", message_.ends_with('.') ? "" : ".", bundle);
    write_status("failed");
    throw Error(error.code(), message_);
  }
  progress_.end();
  write_status(status_ == output::Summary::Status::done ? "done" : "stopped");
}

void Loop::advance() {
  timed_evaluate();
  for (;;) {
    checkpoint_if_due();
    if (simulation_->time() >= scene_.time.end) break;
    if (scene_.time.max_steps > 0 && simulation_->step() >= scene_.time.max_steps) break;
    if (stop_requested()) {
      checkpoint();
      streams_->flush_series(*record_);
      status_ = output::Summary::Status::stopped;
      message_ = "Stopped on request; a checkpoint was written, continue with --resume.";
      return;
    }
    const auto step_started = Clock::now();
    const dynamics::TimeStep allowed = simulation_->allowed_step();
    observe_and_begin(next_time(allowed.seconds), false);
    finish_step();
    timed_evaluate();
    const double seconds = seconds_since(step_started);
    seconds_per_step_ = seconds_per_step_ > 0 ? 0.9 * seconds_per_step_ + 0.1 * seconds : seconds;
    report_progress(allowed);
    report_activations();
  }
  observe_and_begin(simulation_->time(), true);
  streams_->flush_series(*record_);
  checkpoint();
}

void Loop::timed_evaluate() {
  const double before = core_seconds();
  simulation_->evaluate();
  totals_.loop_core += core_seconds() - before;
}

void Loop::finish_step() {
  const double before = core_seconds();
  const auto parcels = static_cast<double>(simulation_->store().size());
  const StepReport report = simulation_->finish_step();
  totals_.loop_core += core_seconds() - before;
  totals_.parcel_steps += parcels;
  totals_.splits += report.upkeep.splits;
  totals_.merges += report.upkeep.merges.merged;
  ++steps_since_checkpoint_;
}

/// Outputs of the evaluated state, then the first stage of the step, which is what gives the
/// parcels' velocity at that state.
void Loop::observe_and_begin(double until, bool last) {
  const double time = simulation_->time();
  const bool observe = last || record_->size() == 0 || streams_->series_due(time);
  const bool slabs = slabs_ && (observe || streams_->wants_slabs(time, last));
  {
    const PhaseScope scope(simulation_->times(), Phase::output);
    streams_->write_due(*simulation_, last);
  }
  if (observe) {
    const PhaseScope scope(simulation_->times(), Phase::diagnostics);
    diagnostics_->observe_state(*simulation_);
    if (!initial_budgets_.empty())
      diagnostics_->observe_budgets(budget_summaries(sequence_.ledger()));
  }
  // Last of all: it takes the flow on the mesh.
  if (slabs) observe_slabs(observe);
  const double before = core_seconds();
  if (last)
    simulation_->probe();
  else
    simulation_->begin_step(until);
  totals_.loop_core += core_seconds() - before;
  if (!observe) return;
  const PhaseScope scope(simulation_->times(), Phase::diagnostics);
  diagnostics_->observe_velocity(*simulation_);
  record_->append(time, diagnostics_->values());
  streams_->series_done(time);
}

/// The parcels' velocity has to belong to their state before the first stage moves them. Once for
/// the series, a sample and a record of profiles.
void Loop::observe_slabs(bool for_series) {
  const double time = simulation_->time();
  const bool for_profiles = streams_->has_open_profiles();
  {
    const PhaseScope scope(simulation_->times(), Phase::diagnostics);
    simulation_->probe();
    slabs_->measure(*simulation_);
    if (for_series) diagnostics_->observe_slabs(*simulation_);
  }
  if (!for_profiles) return;
  const PhaseScope scope(simulation_->times(), Phase::output);
  streams_->write_slabs(time);
}

/// End of the next step: equal steps, none longer than allowed, to the next time an output or the
/// end wants to see.
double Loop::next_time(double allowed) const {
  const double time = simulation_->time();
  double until;
  if (scene_.time.fixed) {
    until = std::min(time + allowed, scene_.time.end);
  } else {
    double target = scene_.time.end;
    const double landing = streams_->next_landing_after(time);
    if (landing < target) target = landing;
    const double steps = std::ceil((target - time) / allowed * (1 - 1e-12));
    until = steps <= 1 ? target : time + (target - time) / steps;
  }
  // A step that is lost in the rounding of the end's time takes for ever to reach it.
  const bool endless = allowed < std::numeric_limits<double>::epsilon() * scene_.time.end;
  if (endless || !(until > time))
    throw Error(ExitCode::numerical,
                fmt::format("The time step has become too small to advance t = {:.17g} s: {:.3g} s "
                            "is allowed at step {}.",
                            time, allowed, simulation_->step()));
  return until;
}

void Loop::checkpoint_if_due() {
  const bool by_steps = scene_.output.checkpoint_every_steps > 0 &&
                        steps_since_checkpoint_ >= scene_.output.checkpoint_every_steps;
  const bool by_clock = scene_.output.checkpoint_every_wall > 0 &&
                        seconds_since(last_checkpoint_) >= scene_.output.checkpoint_every_wall &&
                        steps_since_checkpoint_ > 0;
  if (by_steps || by_clock) checkpoint();
}

void Loop::checkpoint() {
  const PhaseScope scope(simulation_->times(), Phase::output);
  output::Checkpoint checkpoint{
      simulation_->time(), simulation_->step(), simulation_->last_dt(), {}};
  simulation_->save(checkpoint.data);
  record_->save(checkpoint.data);
  diagnostics_->save(checkpoint.data, checkpoint.time);
  streams_->save(checkpoint.data, checkpoint.time);
  save_totals(checkpoint.data);
  checkpoint.data.arrays["books"] = sequence_.books();
  checkpoint.data.arrays.merge(sequence_.surface().named_values());
  save_activations(physics_, checkpoint.data);
  save_private_states(sequence_, checkpoint.data);
  checkpoint.data.texts["scene"] = scene_.resolved_yaml;
  checkpoint.data.texts["version"] = std::string(build_record().version);
  checkpoint.data.texts["commit"] = std::string(build_record().commit);
  output::write_checkpoint(directory_.path(), simulation_->store(), checkpoint,
                           scene_.output.checkpoints_kept);
  streams_->flush_series(*record_);
  last_checkpoint_ = Clock::now();
  steps_since_checkpoint_ = 0;
}

void Loop::save_totals(output::NamedData& data) const {
  data.counters["totals"] = {totals_.parcels_initial, totals_.splits, totals_.merges};
  data.arrays["totals"] = {totals_.parcel_steps, totals_.loop_core,
                           totals_.wall + seconds_since(started_),
                           totals_.core + core_seconds() - core_started_};
  std::vector<double>& phases = data.arrays["phase_seconds"];
  std::vector<std::uint64_t>& calls = data.counters["phase_calls"];
  phases.clear();
  calls.clear();
  for (const PhaseTimes::Entry& entry : simulation_->times()) {
    phases.push_back(entry.seconds);
    calls.push_back(entry.calls);
  }
  for (const auto& budget : initial_budgets_)
    data.arrays["initial_budget/" + budget.budget] = {budget.total};
}

void Loop::restore_totals(const output::NamedData& data) {
  const auto& counts = data.counters.at("totals");
  totals_.parcels_initial = counts.at(0);
  totals_.splits = counts.at(1);
  totals_.merges = counts.at(2);
  const auto& numbers = data.arrays.at("totals");
  totals_.parcel_steps = numbers.at(0);
  totals_.loop_core = numbers.at(1);
  totals_.wall = numbers.at(2);
  totals_.core = numbers.at(3);
  restore_phases(data);
  constexpr std::string_view prefix = "initial_budget/";
  for (const auto& [name, value] : data.arrays)
    if (name.starts_with(prefix))
      initial_budgets_.push_back({name.substr(prefix.size()), value.at(0)});
}

/// Of a program with other phases nothing is taken over.
void Loop::restore_phases(const output::NamedData& data) {
  const auto& seconds = data.arrays.at("phase_seconds");
  const auto& calls = data.counters.at("phase_calls");
  PhaseTimes& times = simulation_->times();
  if (seconds.size() != calls.size() ||
      seconds.size() != static_cast<std::size_t>(times.end() - times.begin()))
    return;
  std::size_t phase = 0;
  for (PhaseTimes::Entry& entry : times) {
    entry = {seconds[phase], calls[phase]};
    ++phase;
  }
}

void Loop::report_progress(const dynamics::TimeStep& allowed) {
  ProgressState state;
  state.time = simulation_->time();
  state.step = simulation_->step();
  state.time_step = simulation_->last_dt();
  state.limiter = allowed.limiter;
  state.parcels = simulation_->store().size();
  state.splits = totals_.splits;
  state.merges = totals_.merges;
  state.seconds_per_step = seconds_per_step_;
  const std::pair<std::string_view, double> extras[] = {
      {"max w",
       simulation_->flow_summary().speed[static_cast<std::size_t>(simulation_->dimension() - 1)]}};
  state.extras = extras;
  progress_.update(state);
  if (seconds_since(last_status_) < status_interval) return;
  write_status("running");
  last_status_ = Clock::now();
}

void Loop::report_activations() {
  const auto& all = physics_.activations();
  for (; activations_reported_ < all.size(); ++activations_reported_) {
    const Activation& one = all[activations_reported_];
    progress_.message(fmt::format("t = {:.6g} s, step {}: {} switched on; {}", one.time, one.step,
                                  one.effect, one.because));
  }
}

void Loop::write_status(const char* state) const {
  output::RunStatus status;
  status.state = state;
  status.scene = scene_.name;
  status.time = simulation_->time();
  status.end = scene_.time.end;
  status.step = simulation_->step();
  status.dt = simulation_->last_dt();
  status.parcels = simulation_->store().size();
  status.wall = seconds_since(started_);
  if (seconds_per_step_ > 0 && status.dt > 0) {
    status.eta = (status.end - status.time) / status.dt * seconds_per_step_;
    status.steps_per_second = 1.0 / seconds_per_step_;
    status.ns_per_parcel_step = seconds_per_step_ / static_cast<double>(status.parcels) * 1e9;
  }
  status.pid = getpid();
  output::write_status(directory_.path() / "status.json", status);
}

}  // namespace pileus::model
