#include "dynamics/prescribed_transport.hpp"

#include <algorithm>
#include <cmath>

#include "base/parallel.hpp"
#include "mesh/node_extrema.hpp"
#include "parcels/walls.hpp"

namespace pileus::dynamics {
namespace {

/// Parcels sampled at a time: a multiple of 8, few enough for the samples to stay in the cache.
constexpr std::size_t sampled_parcels = 256;

void run_stage(GivenStageJob<3>& job) {
  kernels().given_stage_3d(job);
}
void run_stage(GivenStageJob<2>& job) {
  kernels().given_stage_2d(job);
}

/// Extrema of the samples of a column of `levels` nodes.
mesh::FlowSummary summarise(const FlowSamples<3>& s, int levels, double* scratch) {
  const auto& g = s.gradient;
  double *xi = scratch, *eta = scratch + levels;
  for (int k = 0; k < levels; ++k) {
    xi[k] = g[7][k] - g[5][k];
    eta[k] = g[2][k] - g[6][k];
  }
  const mesh::GradientColumns columns{g[0], g[1], g[3], g[4], g[6], g[7], xi, eta, levels};
  mesh::FlowSummary summary;
  summary.strain = mesh::largest_strain(columns);
  summary.vorticity = std::sqrt(mesh::largest_squared_vorticity(columns));
  for (std::size_t d = 0; d < 3; ++d)
    summary.speed[d] = mesh::largest_magnitude(s.velocity[d], levels);
  return summary;
}

mesh::FlowSummary summarise(const FlowSamples<2>& s, int levels, double*) {
  mesh::FlowSummary summary;
  for (int k = 0; k < levels; ++k) {
    const double u_x = s.gradient[0][k], u_z = s.gradient[1][k], w_x = s.gradient[2][k];
    summary.strain = std::max(summary.strain, std::hypot(u_x, 0.5 * (u_z + w_x)));
    summary.vorticity = std::max(summary.vorticity, std::abs(w_x - u_z));
  }
  for (std::size_t d = 0; d < 2; ++d)
    summary.speed[d] = mesh::largest_magnitude(s.velocity[d], levels);
  return summary;
}

/// Positions in the flow record of the components of a gradient.
template <int D>
constexpr std::array<int, StageJob<D>::gradient_components> gradient_slots() {
  using R = mesh::FlowRecord<D>;
  if constexpr (D == 3)
    return {R::u_x, R::u_y, R::u_z, R::v_x, R::v_y, R::v_z, R::w_x, R::w_y};
  else
    return {R::u_x, R::u_z, R::w_x};
}

}  // namespace

/// Two columns beside position and samples serve as scratch.
template <int D>
PrescribedTransport<D>::Scratch::Scratch(std::size_t points)
    : room((points + 7) / 8 * 8), memory(room * (2 * D + StageJob<D>::gradient_components + 2)) {
  std::fill_n(memory.data(), memory.size(), 0.0);
  double* next = memory.data() + 2 * room;
  const auto take = [&](double*& column) {
    column = next;
    next += room;
  };
  for (double*& column : position) take(column);
  for (double*& column : samples.velocity) take(column);
  for (double*& column : samples.gradient) take(column);
}

template <int D>
PrescribedTransport<D>::PrescribedTransport(const mesh::Grid<D>& grid,
                                            std::unique_ptr<VelocityField<D>> velocity,
                                            const LowStorageScheme& scheme, ShapeIntegrator shape,
                                            ReferenceProfile reference, double aspect_limit)
    : ParcelMotion<D>(grid, scheme, shape, std::move(reference), aspect_limit),
      velocity_(std::move(velocity)),
      column_summary_(grid.columns()) {
  std::fill_n(flow_.data(), flow_.size(), 0.0);
  match_threads();
}

template <int D>
void PrescribedTransport<D>::match_threads() {
  const auto threads = static_cast<std::size_t>(std::max(1, omp_get_max_threads()));
  if (scratch_.size() >= threads) return;
  const auto levels = static_cast<std::size_t>(grid_.nz() + 1);
  while (scratch_.size() < threads) scratch_.emplace_back(std::max(sampled_parcels, levels));
  velocity_->match_threads();
}

template <int D>
const mesh::FlowSummary& PrescribedTransport<D>::evaluate(
    parcels::Store& store, BuoyancySource& source, const std::vector<std::size_t>& tile_begin,
    const MeanWind&, double time, PhaseTimes& times) {
  reserve(store.size());
  match_threads();
  {
    const PhaseScope scope(times, Phase::closure);
    buoyancy_ = source.buoyancy(store, time);
  }
  store_ = &store;
  tile_begin_ = &tile_begin;
  is_deposited_ = false;
  time_ = time;
  const PhaseScope scope(times, Phase::interpolate);
  if (!nodes_are_sampled_ || !velocity_->steady()) summary_ = sample_nodes(time, true);
  nodes_are_sampled_ = true;
  return summary_;
}

template <int D>
const double* PrescribedTransport<D>::deposited() {
  if (!is_deposited_ && store_ != nullptr) deposit_state(*store_, buoyancy_, *tile_begin_);
  is_deposited_ = true;
  return deposited_.data();
}

template <int D>
const mesh::FlowSummary* PrescribedTransport<D>::summary_at(double time, PhaseTimes& times) {
  if (velocity_->steady()) return nullptr;
  const PhaseScope scope(times, Phase::interpolate);
  ahead_ = sample_nodes(time, false);
  return &ahead_;
}

/// Samples the flow at the nodes; only where it is to be kept it becomes that of flow().
template <int D>
mesh::FlowSummary PrescribedTransport<D>::sample_nodes(double time, bool keep) {
  parallel_chunks(
      grid_.columns(),
      [&](std::size_t begin, std::size_t end) {
        Scratch& scratch = scratch_[static_cast<std::size_t>(omp_get_thread_num())];
        for (std::size_t column = begin; column < end; ++column)
          sample_column(time, column, keep, scratch);
      },
      16);
  mesh::FlowSummary summary;
  for (const mesh::FlowSummary& column : column_summary_) mesh::merge_extrema(summary, column);
  return summary;
}

template <int D>
void PrescribedTransport<D>::sample_column(double time, std::size_t column, bool keep,
                                           Scratch& scratch) {
  const auto levels = static_cast<std::size_t>(grid_.nz() + 1);
  const std::size_t nx = static_cast<std::size_t>(grid_.nx());
  const std::size_t index[2] = {column % nx, column / nx};
  for (std::size_t k = 0; k < levels; ++k)
    for (std::size_t d = 0; d < D; ++d) {
      const std::size_t i = d == D - 1 ? k : index[d];
      scratch.position[d][k] = grid_.lower[d] + static_cast<double>(i) * grid_.spacing[d];
    }
  std::array<const double*, D> at{};
  std::copy(scratch.position.begin(), scratch.position.end(), at.begin());
  velocity_->sample(time, levels, at, scratch.samples);
  constexpr auto slots = gradient_slots<D>();
  for (std::size_t k = 0; keep && k < levels; ++k) {
    double* record =
        flow_.data() + grid_.node(column, static_cast<int>(k)) * mesh::FlowRecord<D>::width;
    for (std::size_t d = 0; d < D; ++d) record[d] = scratch.samples.velocity[d][k];
    for (std::size_t c = 0; c < slots.size(); ++c)
      record[slots[c]] = scratch.samples.gradient[c][k];
  }
  column_summary_[column] =
      summarise(scratch.samples, static_cast<int>(levels), scratch.memory.data());
}

template <int D>
void PrescribedTransport<D>::stage(parcels::Store& store, std::size_t s, double time, double dt,
                                   bool evaluate_only, PhaseTimes& times) {
  const PhaseScope scope(times, Phase::interpolate);
  GivenStageJob<D> whole{};
  static_cast<StageJob<D>&>(whole) = stage_job(store, s, dt, evaluate_only);
  const auto advance = [&](std::size_t begin, std::size_t end, Scratch& scratch) {
    GivenStageJob<D> job = whole;
    std::array<const double*, D> at;
    for (std::size_t d = 0; d < D; ++d) at[d] = store.position(static_cast<int>(d)) + begin;
    velocity_->sample(time, end - begin, at, scratch.samples);
    std::copy(scratch.samples.velocity.begin(), scratch.samples.velocity.end(), job.velocity);
    std::copy(scratch.samples.gradient.begin(), scratch.samples.gradient.end(), job.gradient);
    job.begin = begin;
    job.end = end;
    job.broken = 0;
    run_stage(job);
    return job.broken;
  };
  broken_shapes_ += ordered_reduce(
      store.size(), std::size_t{0},
      [&](std::size_t begin, std::size_t end) {
        Scratch& scratch = scratch_[static_cast<std::size_t>(omp_get_thread_num())];
        std::size_t broken = 0;
        for (std::size_t b = begin; b < end; b += sampled_parcels)
          broken += advance(b, std::min(b + sampled_parcels, end), scratch);
        return broken;
      },
      [](std::size_t a, std::size_t b) { return a + b; });
}

template <int D>
void PrescribedTransport<D>::begin_step(parcels::Store& store, MeanWind&, double dt,
                                        PhaseTimes& times) {
  stage(store, 0, time_, dt, false, times);
}

template <int D>
void PrescribedTransport<D>::finish_step(parcels::Store& store, BuoyancySource&,
                                         const std::vector<std::size_t>&, MeanWind&, double time,
                                         double dt, PhaseTimes& times) {
  for (std::size_t s = 1; s < scheme_.stages(); ++s)
    stage(store, s, time + scheme_.c[s] * dt, dt, false, times);
  const PhaseScope scope(times, Phase::stage_update);
  parcels::confine<D>(store, grid_);
}

template <int D>
void PrescribedTransport<D>::probe(parcels::Store& store, PhaseTimes& times) {
  stage(store, 0, time_, 0.0, true, times);
}

template <int D>
std::size_t PrescribedTransport<D>::allocated_bytes() const {
  std::size_t bytes = ParcelMotion<D>::allocated_bytes();
  for (const Scratch& scratch : scratch_) bytes += scratch.memory.allocated_bytes();
  return bytes;
}

template class PrescribedTransport<2>;
template class PrescribedTransport<3>;

}  // namespace pileus::dynamics
