#include "model/simulation_of.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "base/log.hpp"
#include "dynamics/prescribed_transport.hpp"
#include "dynamics/transport.hpp"
#include "mesh/node_extrema.hpp"
#include "model/initial_state.hpp"
#include "model/prescribed_velocity.hpp"
#include "output/grid_fields.hpp"
#include "parcels/lattice.hpp"
#include "scene/problems.hpp"

namespace pileus::model {
namespace {

template <int D>
mesh::Grid<D> make_grid(const scene::Domain& domain) {
  std::array<int, D> cells{};
  std::array<double, D> lower{}, extent{};
  std::copy_n(domain.cells.begin(), D, cells.begin());
  std::copy_n(domain.lower.begin(), D, lower.begin());
  std::copy_n(domain.extent.begin(), D, extent.begin());
  return mesh::Grid<D>(cells, lower, extent);
}

dynamics::TimeStepControl make_step_control(const scene::TimeControl& time) {
  // A fluid at rest limits nothing; then the run is one step per output, or the cap.
  const double cap = time.largest > 0 ? time.largest : std::max(time.end, 1e-300);
  return {time.alpha, time.strain_alpha.value(), time.courant, cap, time.fixed};
}

/// Nodes and parcels are counted in 32 bits, parcels with room for their number to grow fourfold.
template <int D>
void require_countable(const mesh::Grid<D>& grid, int per_cell) {
  const double nodes = static_cast<double>(grid.nodes());
  const double parcels = 4.0 * per_cell * static_cast<double>(grid.cell_count());
  if (nodes < std::numeric_limits<std::int32_t>::max() &&
      parcels < std::numeric_limits<std::uint32_t>::max())
    return;
  throw Error(ExitCode::usage,
              fmt::format("The domain has {:.3g} nodes and starts with {:.3g} parcels; one process "
                          "can hold 2.1e9 nodes and start with 1.07e9 parcels.",
                          nodes, parcels / 4));
}

template <int D>
parcels::SplitCriterion<D> split_criterion(const mesh::Grid<D>& grid,
                                           const scene::ParcelControl& control) {
  if (!control.splitting) return parcels::SplitCriterion<D>::never();
  return parcels::SplitCriterion<D>::make(grid, control.max_aspect_ratio, control.max_volume_ratio);
}

/// The reference profile resolves the mesh sixteen-fold: an exact reproduction of linear ones, and
/// of piecewise linear ones with knots on the levels.
constexpr int reference_points_per_cell = 16;

const dynamics::LowStorageScheme& scheme_of(const scene::Scene& scene) {
  return scene.time.scheme == scene::RungeKutta::order4_stages5 ? dynamics::carpenter_kennedy_4()
                                                                : dynamics::williamson_3();
}

dynamics::ShapeIntegrator shape_integrator_of(const scene::Scene& scene) {
  return scene.numerics.shape_integrator == scene::NumericsControl::ShapeIntegrator::exponential
             ? dynamics::ShapeIntegrator::exponential
             : dynamics::ShapeIntegrator::runge_kutta;
}

/// A parcel that one step stretches to this many times the aspect ratio at which it splits has
/// outrun splitting, which halves it once a step: its thinness is not resolved by anything.
constexpr double needle_factor = 25;

/// The largest ratio of a cell's edges: parcels of the cell's own shape are that long.
template <int D>
double edge_ratio(const mesh::Grid<D>& grid) {
  const auto [least, most] = std::minmax_element(grid.spacing.begin(), grid.spacing.end());
  return *most / *least;
}

}  // namespace

template <int D>
SimulationOf<D>::SimulationOf(const scene::Scene& scene, std::vector<parcels::Scalar> scalars,
                              Physics& physics, parcels::ItemDeclaration items)
    : grid_(make_grid<D>(scene.domain)),
      scene_(scene),
      step_control_(make_step_control(scene.time)),
      reference_(profile_over_height(scene.background.reference_buoyancy, scene,
                                     "the reference buoyancy", grid_.bottom(), grid_.top(),
                                     reference_points_per_cell * grid_.nz() + 1)),
      buoyancy_(physics),
      tiling_(grid_),
      upkeep_(grid_, tiling_,
              scene.parcels.merging ? grid_.cell_volume() / scene.parcels.min_volume_ratio : 0.0,
              split_criterion(grid_, scene.parcels)),
      correction_(grid_, {scene.parcels.correction_iterations, scene.parcels.gradient_prefactor,
                          scene.parcels.max_compression}) {
  require_countable(grid_, scene.parcels.per_cell);
  store_ = std::make_unique<parcels::Store>(D, std::move(scalars), std::move(items));
  variance_budget_ = std::make_unique<VarianceBudget>(scene.diagnostics.variance_budgets, *store_,
                                                      grid_.domain_volume());
  mesh_access_.reset(new MeshAccessOf<D>(
      {grid_, *store_, tile_begin_, transport_, wind_, scene.background.coriolis[2]}));
}

template <int D>
void SimulationOf<D>::build_transport(std::array<bool, 2> zero_wall_vorticity) {
  zero_wall_vorticity_ = zero_wall_vorticity;
  if (!scene_.flow.prescribed) {
    transport_ = induced_transport();
    return;
  }
  auto given = prescribed_transport();
  given_ = given.get();
  transport_ = std::move(given);
}

template <int D>
std::unique_ptr<dynamics::ParcelMotion<D>> SimulationOf<D>::induced_transport() const {
  const scene::NumericsControl& numerics = scene_.numerics;
  mesh::FlowOptions flow;
  std::copy_n(scene_.background.coriolis.begin(), 3, flow.planetary_vorticity.begin());
  flow.zero_vertical_vorticity = zero_wall_vorticity_;
  flow.filter = numerics.spectral_filter;
  flow.vertical_derivative =
      numerics.vertical_derivative == scene::NumericsControl::VerticalDerivative::compact
          ? mesh::VerticalDerivative::compact
          : mesh::VerticalDerivative::centred;
  if (!reference_.is_zero())
    for (int k = 0; k <= grid_.nz(); ++k)
      flow.reference_stratification.push_back(
          reference_.gradient(grid_.bottom() + k * grid_.spacing[D - 1]));
  return std::make_unique<dynamics::Transport<D>>(
      grid_, flow, scene_.background.coriolis[2], scheme_of(scene_), shape_integrator_of(scene_),
      0.25 * numerics.window_compensation *
          mesh::lattice_mean_product(parcels::parcels_per_direction(scene_.parcels.per_cell, D)),
      reference_, aspect_limit());
}

template <int D>
std::unique_ptr<dynamics::PrescribedTransport<D>> SimulationOf<D>::prescribed_transport() const {
  auto velocity = std::make_unique<PrescribedVelocity<D>>(scene_, grid_);
  return std::make_unique<dynamics::PrescribedTransport<D>>(
      grid_, std::move(velocity), scheme_of(scene_), shape_integrator_of(scene_), reference_,
      aspect_limit());
}

template <int D>
double SimulationOf<D>::aspect_limit() const {
  return needle_factor * scene_.parcels.max_aspect_ratio * edge_ratio(grid_);
}

template <int D>
void SimulationOf<D>::initialise(const scene::Scene& scene) {
  build_transport({false, false});
  place_parcels(scene);
  fill_initial_state(scene, grid_, *store_, wind_);
  build_transport(walls_without_vorticity());
  if (scene_.flow.prescribed) warn_of_divergence();
}

/// Parcels keep their volume, so they gather where a velocity converges. Looked for at a few times,
/// none of which is a likely zero of a periodic factor.
template <int D>
void SimulationOf<D>::warn_of_divergence() const {
  constexpr double noticeable = 1e-6;
  PrescribedVelocity<D> velocity(scene_, grid_);
  for (const double part : {0.03, 0.11, 0.37, 0.71}) {
    const double time = part * scene_.time.end;
    const double relative = velocity.relative_divergence(time);
    if (relative <= noticeable) continue;
    log(LogLevel::warning,
        fmt::format("{}: the prescribed flow diverges at t = {:.6g} s: |div u| reaches {:.3g} of "
                    "the largest du/dx, dv/dy or dw/dz, and parcels, which keep their volume, "
                    "gather or thin out there.",
                    scene::describe(scene_.flow.where), time, relative));
    return;
  }
}

/// Scattered parcels are brought to fill the cells evenly before they get their fields: later, the
/// volume correction would carry values away from where they belong, and stir a fluid at rest.
template <int D>
void SimulationOf<D>::place_parcels(const scene::Scene& scene) {
  constexpr int settling_rounds = 10;  // each of which cuts the volume error threefold or more
  const scene::ParcelControl& control = scene.parcels;
  parcels::fill_lattice<D>(*store_, grid_,
                           {control.per_cell, control.offset, control.jitter, control.seed});
  thin_parcels<D>(scene, *store_);
  const auto order = [&] {
    upkeep_.reorder(*store_, transport_->offsets(), times_);
    tile_begin_ = upkeep_.tile_begin();
    transport_->offsets().update(*store_);
  };
  order();
  if (control.jitter == 0) return;
  for (int round = 0; round < settling_rounds; ++round)
    correction_.run(*store_, transport_->offsets(), tile_begin_, transport_->deposit(),
                    transport_->room_on_mesh());
  order();
}

/// Vertical vorticity on a wall stays zero if it starts at zero and nothing turns the frame about
/// the vertical, neither Dζ/Dt = (ζ + f_z) w_z nor uneven drag at the ground. "Zero" is below a
/// thousandth of the interior's r.m.s.
template <int D>
std::array<bool, 2> SimulationOf<D>::walls_without_vorticity() const {
  using Choice = scene::Boundaries::WallVorticity;
  if (D == 2 || scene_.flow.prescribed || scene_.boundaries.vertical_vorticity == Choice::free)
    return {false, false};
  if (scene_.boundaries.vertical_vorticity == Choice::zero) return {true, true};
  if (scene_.background.coriolis[2] != 0) return {false, false};
  const bool dragged = buoyancy_.physics.turns_air_at_the_ground();
  AlignedArray<double> field(grid_.nodes() * mesh::DepositRecord<D>::width);
  parcels::SupportOffsets<D> offsets;
  offsets.update(*store_);
  parcels::Deposit<D> deposit(grid_);
  deposit.means(*store_, offsets, tile_begin_,
                {store_->vorticity(store_->vorticity_components() - 1)}, field.data());
  double bottom = 0, top = 0, interior = 0;
  for (std::size_t c = 0; c < grid_.columns(); ++c)
    for (int k = 0; k <= grid_.nz(); ++k) {
      const double zeta = field[grid_.node(c, k) * mesh::DepositRecord<D>::width + 1];
      (k == 0 ? bottom : k == grid_.nz() ? top : interior) += zeta * zeta;
    }
  const double allowed = 1e-6 * interior / std::max(1, grid_.nz() - 1);
  return {bottom <= allowed && !dragged, top <= allowed};
}

/// Bounds and spacing of the mesh: parcels fit no other.
template <int D>
std::vector<double> SimulationOf<D>::corners() const {
  std::vector<double> corners(grid_.lower.begin(), grid_.lower.end());
  corners.insert(corners.end(), grid_.extent.begin(), grid_.extent.end());
  corners.insert(corners.end(), grid_.spacing.begin(), grid_.spacing.end());
  return corners;
}

template <int D>
void SimulationOf<D>::save(output::NamedData& data) const {
  data.arrays["domain"] = corners();
  data.arrays["mean_wind"] = {wind_.velocity[0], wind_.velocity[1]};
  data.counters["zero_wall_vorticity"] = {zero_wall_vorticity_[0], zero_wall_vorticity_[1]};
  data.counters["broken_shapes"] = {broken_shapes()};
  variance_budget_->save(data);
  data.counters["tile_begin"].assign(tile_begin_.begin(), tile_begin_.end());
}

template <int D>
void SimulationOf<D>::restore(const output::NamedData& data) {
  const auto& wind = data.arrays.at("mean_wind");
  wind_.velocity = {wind.at(0), wind.at(1)};
  const auto& zero = data.counters.at("zero_wall_vorticity");
  const auto& tiles = data.counters.at("tile_begin");
  if (data.arrays.at("domain") != corners() || tiles.size() != tiling_.tiles().size() + 1 ||
      tiles.front() != 0 || tiles.back() != store_->size() ||
      !std::is_sorted(tiles.begin(), tiles.end()))
    throw Error(ExitCode::usage,
                "The checkpoint belongs to another domain or mesh than the scene describes.");
  tile_begin_.assign(tiles.begin(), tiles.end());
  broken_before_ = data.counters.at("broken_shapes").at(0);
  variance_budget_->restore(data);
  build_transport({zero.at(0) != 0, zero.at(1) != 0});
}

template <int D>
void SimulationOf<D>::evaluate() {
  flow_summary_ = transport_->evaluate(*store_, buoyancy_, tile_begin_, wind_, time_, times_);
  require_finite();
}

/// Whatever is not finite anywhere on a level spreads over the whole level in the horizontal
/// transforms, so one column shows it. A prescribed flow sees to its own values.
template <int D>
void SimulationOf<D>::require_finite() const {
  double sum = 0;
  const double* column = transport_->flow();
  const auto values = static_cast<std::size_t>(grid_.levels()) * mesh::FlowRecord<D>::width;
  for (std::size_t i = 0; i < values; ++i) sum += column[i];
  if (std::isfinite(sum)) return;
  for (std::size_t p = 0; p < store_->size(); ++p)
    for (int c = 0; c < store_->state_columns(); ++c)
      if (!std::isfinite(store_->column(c)[p]))
        throw Error(
            ExitCode::numerical,
            fmt::format("The state is no longer finite at t = {:.6g} s, step {}: {} of parcel "
                        "{} is {}.",
                        time_, step_, store_->column_name(c), store_->uid()[p],
                        store_->column(c)[p]));
  throw Error(ExitCode::numerical,
              fmt::format("The flow is no longer finite at t = {:.6g} s, step {}, although every "
                          "parcel is: a value has overflowed on the mesh.",
                          time_, step_));
}

/// A flow that is known beforehand counts as it is at its strongest until the end of the step: it
/// may be at rest when the step begins.
template <int D>
dynamics::TimeStep SimulationOf<D>::step_allowed_by_flow() {
  // Parts of the step at which to look, none of them a likely zero of a periodic factor.
  constexpr std::array<double, 4> looked_at = {0.13, 0.41, 0.72, 1.0};
  constexpr double settled = 0.9;
  const auto choose = [&](const mesh::FlowSummary& flow) {
    return dynamics::choose_time_step<D>(step_control_, grid_, flow, scene_.background.coriolis[2]);
  };
  dynamics::TimeStep allowed = choose(flow_summary_);
  while (given_ != nullptr && !step_control_.fixed) {
    const double span = std::min(allowed.seconds, scene_.time.end - time_);
    mesh::FlowSummary strongest = flow_summary_;
    for (const double part : looked_at) {
      const mesh::FlowSummary* later = given_->summary_at(time_ + part * span, times_);
      if (later == nullptr) return allowed;
      mesh::merge_extrema(strongest, *later);
    }
    // Within a shorter step the flow may stay weaker, but for a longer one it is known not to.
    const dynamics::TimeStep shorter = choose(strongest);
    const double looked_at_until = allowed.seconds;
    if (shorter.seconds < allowed.seconds) allowed = shorter;
    if (!(shorter.seconds < settled * looked_at_until)) break;
  }
  return allowed;
}

template <int D>
dynamics::TimeStep SimulationOf<D>::allowed_step() {
  dynamics::TimeStep allowed = step_allowed_by_flow();
  if (!step_control_.fixed) {
    const double physics = buoyancy_.physics.largest_step();
    if (physics < allowed.seconds) allowed = {physics, "operator"};
  }
  return allowed;
}

template <int D>
void SimulationOf<D>::begin_step(double until) {
  until_ = until;
  dt_ = until - time_;
  if (!variance_budget_->started()) account_for_variance(VarianceBudget::Sink::operators);
  bool changed;
  {
    const PhaseScope scope(times_, Phase::operators);
    changed = buoyancy_.physics.apply_before(*store_, time_, dt_, step_);
  }
  if (changed) evaluate();
  transport_->begin_step(*store_, wind_, dt_, times_);
}

template <int D>
void SimulationOf<D>::account_for_variance(VarianceBudget::Sink sink) {
  if (variance_budget_->empty()) return;
  const PhaseScope scope(times_, Phase::diagnostics);
  variance_budget_->book(*store_, sink);
}

template <int D>
StepReport SimulationOf<D>::finish_step() {
  StepReport report;
  report.dt = dt_;
  buoyancy_.within_a_step = true;
  transport_->finish_step(*store_, buoyancy_, tile_begin_, wind_, time_, dt_, times_);
  buoyancy_.within_a_step = false;
  {
    const PhaseScope scope(times_, Phase::operators);
    buoyancy_.physics.apply_after(*store_, time_, dt_, step_);
  }
  account_for_variance(VarianceBudget::Sink::operators);
  report.upkeep = upkeep_.run(*store_, transport_->offsets(), step_, times_);
  account_for_variance(VarianceBudget::Sink::mergers);
  tile_begin_ = upkeep_.tile_begin();
  buoyancy_.physics.population_changed();
  {
    const PhaseScope scope(times_, Phase::correction);
    transport_->offsets().update(*store_);
    correction_.run(*store_, transport_->offsets(), tile_begin_, transport_->deposit(),
                    transport_->room_on_mesh());
  }
  time_ = until_;
  ++step_;
  return report;
}

template <int D>
std::vector<output::Axis> SimulationOf<D>::axes() const {
  return output::node_axes(grid_);
}

template <int D>
std::vector<output::Axis> SimulationOf<D>::ground_axes() const {
  return output::ground_axes(grid_);
}

template <int D>
parcels::VolumeError SimulationOf<D>::volume_error() const {
  constexpr int width = mesh::DepositRecord<D>::width;
  const double inverse = 1.0 / grid_.cell_volume();
  parcels::VolumeError error;
  double sum = 0;
  for (std::size_t c = 0; c < grid_.columns(); ++c)
    for (int k = 0; k <= grid_.nz(); ++k) {
      const double e = transport_->deposited()[grid_.node(c, k) * width] * inverse - 1.0;
      sum += e * e;
      error.largest = std::max(error.largest, std::abs(e));
    }
  error.rms = std::sqrt(sum / static_cast<double>(node_count()));
  return error;
}

template <int D>
double SimulationOf<D>::grid_kinetic_energy() const {
  double sum = 0;
  for (std::size_t c = 0; c < grid_.columns(); ++c)
    for (int k = 0; k <= grid_.nz(); ++k) {
      const std::size_t node = grid_.node(c, k);
      const double* u = transport_->flow() + node * mesh::FlowRecord<D>::width;
      double square = 0;
      for (int d = 0; d < D; ++d) square += u[d] * u[d];
      const double volume = transport_->deposited()[node * mesh::DepositRecord<D>::width];
      sum += (k == 0 || k == grid_.nz() ? 0.5 : 1.0) * volume * square;
    }
  return 0.5 * sum / grid_.domain_volume();
}

template <int D>
GriddedFields<D> SimulationOf<D>::gridded() const {
  return GriddedFields<D>({grid_, *store_, *transport_, tile_begin_, reference_});
}

template <int D>
std::size_t SimulationOf<D>::allocated_bytes() const {
  return store_->allocated_bytes() + transport_->allocated_bytes() + upkeep_.allocated_bytes() +
         correction_.allocated_bytes();
}

std::unique_ptr<Simulation> make_simulation(const scene::Scene& scene,
                                            std::vector<parcels::Scalar> scalars, Physics& physics,
                                            parcels::ItemDeclaration items) {
  if (scene.domain.dimension == 2)
    return std::make_unique<SimulationOf<2>>(scene, std::move(scalars), physics, std::move(items));
  return std::make_unique<SimulationOf<3>>(scene, std::move(scalars), physics, std::move(items));
}

template class SimulationOf<2>;
template class SimulationOf<3>;

}  // namespace pileus::model
