#include "dynamics/transport.hpp"

#include "base/parallel.hpp"
#include "parcels/walls.hpp"

namespace pileus::dynamics {
namespace {

void run_stage(StageJob<3>& job) {
  kernels().stage_3d(job);
}
void run_stage(StageJob<2>& job) {
  kernels().stage_2d(job);
}

template <int D>
using NetVorticity = std::array<double, StageJob<D>::vorticity_components>;

/// Volume-weighted mean vorticity of the parcels.
template <int D>
NetVorticity<D> mean_vorticity(const parcels::Store& store, double domain_volume) {
  constexpr std::size_t components = StageJob<D>::vorticity_components;
  NetVorticity<D> sum = ordered_reduce(
      store.size(), NetVorticity<D>{},
      [&](std::size_t begin, std::size_t end) {
        NetVorticity<D> partial{};
        const double* volume = store.volume();
        for (std::size_t c = 0; c < components; ++c) {
          const double* omega = store.vorticity(static_cast<int>(c));
          double total = 0;
          for (std::size_t p = begin; p < end; ++p) total += volume[p] * omega[p];
          partial[c] = total;
        }
        return partial;
      },
      [](NetVorticity<D> a, const NetVorticity<D>& b) {
        for (std::size_t c = 0; c < components; ++c) a[c] += b[c];
        return a;
      });
  for (double& s : sum) s /= domain_volume;
  return sum;
}

}  // namespace

template <int D>
Transport<D>::Transport(const mesh::Grid<D>& grid, const mesh::FlowOptions& flow, double coriolis,
                        const LowStorageScheme& scheme, ShapeIntegrator shape, double sharpening,
                        ReferenceProfile reference, double aspect_limit)
    : ParcelMotion<D>(grid, scheme, shape, std::move(reference), aspect_limit),
      coriolis_(coriolis),
      solver_(grid, flow),
      sharpen_deposited_(grid, mesh::DepositRecord<D>::width, mesh::DepositRecord<D>::vorticity,
                         mesh::DepositRecord<D>::buoyancy + 1, sharpening),
      sharpen_flow_(grid, mesh::FlowRecord<D>::width, 0, mesh::FlowRecord<D>::width, sharpening) {}

template <int D>
const mesh::FlowSummary& Transport<D>::evaluate(parcels::Store& store, BuoyancySource& source,
                                                const std::vector<std::size_t>& tile_begin,
                                                const MeanWind& wind, double time,
                                                PhaseTimes& times) {
  reserve(store.size());
  const double* buoyancy;
  {
    const PhaseScope scope(times, Phase::closure);
    buoyancy = source.buoyancy(store, time);
  }
  {
    const PhaseScope scope(times, Phase::deposit);
    deposit_state(store, buoyancy, tile_begin);
  }
  {
    const PhaseScope scope(times, Phase::compensation);
    sharpen_deposited_.apply(deposited_.data());
  }
  solver_.solve(deposited_.data(), wind.velocity, flow_.data(), &summary_, times);
  flow_is_sharp_ = false;
  return summary_;
}

template <int D>
void Transport<D>::evaluate_velocity(const parcels::Store& store,
                                     const std::vector<std::size_t>& tile_begin,
                                     const MeanWind& wind, PhaseTimes& times) {
  {
    const PhaseScope scope(times, Phase::deposit);
    deposit_vorticity(store, tile_begin);
  }
  {
    const PhaseScope scope(times, Phase::compensation);
    sharpen_deposited_.apply(deposited_.data());
  }
  solver_.invert(deposited_.data(), wind.velocity, flow_.data(), times);
  flow_is_sharp_ = false;
}

template <int D>
void Transport<D>::stage(parcels::Store& store, MeanWind& wind, std::size_t s, double dt,
                         bool evaluate_only, PhaseTimes& times) {
  sharpen_flow(times);
  const PhaseScope scope(times, Phase::interpolate);
  StageJob<D> whole = stage_job(store, s, dt, evaluate_only);
  whole.flow = flow_.data();
  broken_shapes_ += ordered_reduce(
      store.size(), std::size_t{0},
      [&](std::size_t begin, std::size_t end) {
        StageJob<D> job = whole;
        job.begin = begin;
        job.end = end;
        job.broken = 0;
        run_stage(job);
        return job.broken;
      },
      [](std::size_t a, std::size_t b) { return a + b; });
  if (evaluate_only) return;

  // The domain-mean wind turns inertially, d⟨u⟩/dt = f⟨v⟩, d⟨v⟩/dt = −f⟨u⟩ (3D).
  const std::array<double, 2> u = wind.velocity;
  const std::array<double, 2> rate{D == 3 ? coriolis_ * u[1] : 0.0,
                                   D == 3 ? -coriolis_ * u[0] : 0.0};
  for (std::size_t d = 0; d < 2; ++d) {
    wind.increment[d] = (s == 0 ? 0.0 : scheme_.a[s] * wind.increment[d]) + rate[d];
    wind.velocity[d] += scheme_.b[s] * dt * wind.increment[d];
  }
  // The change of the net vorticity that the walls and rotation call for, with the same scheme.
  for (std::size_t c = 0; c < net_vorticity_.size(); ++c) {
    const double due = D == 3 && c < 2 ? summary_.net_vorticity_rate[c] : 0.0;
    net_vorticity_increment_[c] = (s == 0 ? 0.0 : scheme_.a[s] * net_vorticity_increment_[c]) + due;
    net_vorticity_change_[c] += scheme_.b[s] * dt * net_vorticity_increment_[c];
  }
}

/// Once per evaluated flow: what interpolation is about to take away is added beforehand.
template <int D>
void Transport<D>::sharpen_flow(PhaseTimes& times) {
  if (flow_is_sharp_) return;
  const PhaseScope scope(times, Phase::compensation);
  sharpen_flow_.apply(flow_.data());
  flow_is_sharp_ = true;
}

template <int D>
void Transport<D>::begin_step(parcels::Store& store, MeanWind& wind, double dt, PhaseTimes& times) {
  {
    const PhaseScope scope(times, Phase::stage_update);
    net_vorticity_ = mean_vorticity<D>(store, grid_.domain_volume());
    net_vorticity_change_ = {};
  }
  stage(store, wind, 0, dt, false, times);
}

template <int D>
void Transport<D>::finish_step(parcels::Store& store, BuoyancySource& source,
                               const std::vector<std::size_t>& tile_begin, MeanWind& wind,
                               double time, double dt, PhaseTimes& times) {
  for (std::size_t s = 1; s < scheme_.stages(); ++s) {
    evaluate(store, source, tile_begin, wind, time + scheme_.c[s] * dt, times);
    stage(store, wind, s, dt, false, times);
  }
  const PhaseScope scope(times, Phase::stage_update);
  parcels::confine<D>(store, grid_);
  settle_net_vorticity(store);
}

/// The parcels' mean vorticity differs from its exact budget by the discretisation of the stages;
/// the difference is taken from all parcels alike.
template <int D>
void Transport<D>::settle_net_vorticity(parcels::Store& store) {
  NetVorticity<D> excess = mean_vorticity<D>(store, grid_.domain_volume());
  for (std::size_t c = 0; c < excess.size(); ++c)
    excess[c] -= net_vorticity_[c] + net_vorticity_change_[c];
  parallel_chunks(store.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = 0; c < excess.size(); ++c) {
      double* omega = store.vorticity(static_cast<int>(c));
      for (std::size_t p = begin; p < end; ++p) omega[p] -= excess[c];
    }
  });
}

template <int D>
void Transport<D>::probe(parcels::Store& store, PhaseTimes& times) {
  MeanWind unused;
  stage(store, unused, 0, 0.0, true, times);
}

template <int D>
std::size_t Transport<D>::allocated_bytes() const {
  return ParcelMotion<D>::allocated_bytes() + solver_.allocated_bytes();
}

template class Transport<2>;
template class Transport<3>;

}  // namespace pileus::dynamics
