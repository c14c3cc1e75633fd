// A store, a flow and the increments of a Runge–Kutta stage, for the tests of the stage kernels.
#pragma once
#include <cstring>
#include <functional>

#include "../parcels/parcel_cloud.hpp"
#include "base/aligned_array.hpp"
#include "dynamics/kernels.hpp"
#include "dynamics/runge_kutta.hpp"
#include "parcels/deposit.hpp"
#include "parcels/kernels.hpp"

namespace pileus::testing {

inline std::vector<const dynamics::Kernels*> stage_tables() {
  std::vector<const dynamics::Kernels*> list = {&baseline::dynamics_kernels};
  const bool has_avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
                        __builtin_cpu_supports("bmi2");
  if (has_avx2) list.push_back(&avx2::dynamics_kernels);
  if (has_avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw"))
    list.push_back(&avx512::dynamics_kernels);
  return list;
}

template <int D>
struct Stage {
  using Job = dynamics::StageJob<D>;
  static constexpr int width = mesh::FlowRecord<D>::width;
  static constexpr int increments = D + Job::vorticity_components + Job::gradient_components;

  Stage(const mesh::Grid<D>& mesh_grid, std::size_t count, double spread, unsigned seed)
      : grid(mesh_grid), store(D, {}), flow(grid.nodes() * width) {
    Random random(seed);
    fill_randomly<D>(store, grid, count, grid.domain_volume() / static_cast<double>(count), spread,
                     random);
    for (auto& a : increment) {
      a.discard_and_resize(count + 8);
      a.fill(0);
    }
    flow.fill(0);
    job.keep = job.advance = 0;
    job.first = job.last = job.evaluate_only = true;
    job.shape_integrator = dynamics::ShapeIntegrator::exponential;
  }
  /// value(node position, f) for every node, halo levels included.
  void fill_flow(const std::function<double(const std::array<double, D>&, int)>& value) {
    for (int j = 0; j < grid.ny(); ++j)
      for (int i = 0; i < grid.nx(); ++i)
        for (int k = -1; k <= grid.nz() + 1; ++k) {
          std::array<double, D> x;
          x[0] = grid.lower[0] + i * grid.spacing[0];
          if (D == 3) x[1] = grid.lower[1] + j * grid.spacing[1];
          x[D - 1] = grid.bottom() + k * grid.spacing[D - 1];
          for (int f = 0; f < width; ++f)
            flow[grid.node(grid.column(i, j), k) * width + static_cast<std::size_t>(f)] =
                value(x, f);
        }
  }
  void update_offsets() { offsets.update(store); }
  /// One stage with the table's kernel, in ranges of `chunk` parcels (a multiple of eight).
  void run(const dynamics::Kernels& table, std::size_t chunk = 1u << 30) {
    job.grid = parcels::make_kernel_grid(grid);
    job.flow = flow.data();
    for (int c = 0; c < parcels::SupportOffsets<D>::components; ++c)
      job.offset[c] = offsets.component(c);
    for (int d = 0; d < D; ++d) {
      job.position[d] = store.position(d);
      job.position_increment[d] = increment[d].data();
    }
    for (int c = 0; c < Job::vorticity_components; ++c) {
      job.vorticity[c] = store.vorticity(c);
      job.vorticity_increment[c] = increment[D + c].data();
    }
    for (int c = 0; c < Job::shape_components; ++c) job.shape[c] = store.shape(c);
    for (int c = 0; c < Job::gradient_components; ++c)
      job.shape_increment[c] = increment[D + Job::vorticity_components + c].data();
    job.size_volume = store.size_volume();
    job.aspect_limit = 100;
    broken = 0;
    for (std::size_t begin = 0; begin < store.size(); begin += chunk) {
      job.begin = begin;
      job.end = std::min(begin + chunk, store.size());
      job.broken = 0;
      if constexpr (D == 3)
        table.stage_3d(job);
      else
        table.stage_2d(job);
      broken += job.broken;
    }
  }
  /// All state and increments of the parcels, for comparisons of bits.
  std::vector<double> everything() const {
    std::vector<double> all;
    for (int c = 0; c < store.state_columns(); ++c)
      all.insert(all.end(), store.column(c), store.column(c) + store.size());
    for (const auto& a : increment) all.insert(all.end(), a.data(), a.data() + store.size());
    return all;
  }

  mesh::Grid<D> grid;
  parcels::Store store;
  AlignedArray<double> flow;
  std::array<AlignedArray<double>, increments> increment;
  parcels::SupportOffsets<D> offsets;
  Job job{};
  std::size_t broken = 0;
};

}  // namespace pileus::testing
