#include "planner/survey.hpp"

#include <algorithm>
#include <limits>
#include <optional>

#include "base/aligned_array.hpp"
#include "base/parallel.hpp"
#include "mesh/grid.hpp"
#include "parcels/lattice.hpp"
#include "parcels/store.hpp"
#include "scene/field_sampler.hpp"

namespace pileus::planner {
namespace {

template <int D>
parcels::Store lattice_of(const scene::Scene& scene) {
  std::array<int, D> cells{};
  std::array<double, D> lower{}, extent{};
  std::copy_n(scene.domain.cells.begin(), D, cells.begin());
  std::copy_n(scene.domain.lower.begin(), D, lower.begin());
  std::copy_n(scene.domain.extent.begin(), D, extent.begin());
  parcels::Store store(D, {});
  parcels::fill_lattice<D>(store, mesh::Grid<D>(cells, lower, extent),
                           {scene.parcels.per_cell, scene.parcels.offset, 0.0, scene.parcels.seed});
  return store;
}

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
};

Range range_of(const AlignedArray<double>& values, std::size_t count) {
  return ordered_reduce(
      count, Range{},
      [&](std::size_t begin, std::size_t end) {
        Range r;
        for (std::size_t i = begin; i < end; ++i) {
          r.low = std::min(r.low, values[i]);
          r.high = std::max(r.high, values[i]);
        }
        return r;
      },
      [](Range a, const Range& b) {
        return Range{std::min(a.low, b.low), std::max(a.high, b.high)};
      });
}

}  // namespace

std::map<std::string, Extrema> survey_initial_state(const scene::Scene& scene) {
  std::map<std::string, Extrema> found;
  std::optional<parcels::Store> store;
  AlignedArray<double> values;
  for (const auto& [name, field] : scene.initial.scalars) {
    const scene::FieldSampler sampler(field, scene);
    if (const auto uniform = sampler.uniform_value()) {
      found[name] = {*uniform, *uniform, true, field.where};
      continue;
    }
    if (!store) {
      store = scene.domain.dimension == 2 ? lattice_of<2>(scene) : lattice_of<3>(scene);
      values.discard_and_resize(store->size());
    }
    const int vertical = scene.domain.dimension - 1;
    sampler.sample(store->size(), store->position(0), vertical == 2 ? store->position(1) : nullptr,
                   store->position(vertical), values.data());
    const Range range = range_of(values, store->size());
    found[name] = {range.low, range.high, scene.parcels.jitter == 0, field.where};
  }
  return found;
}

}  // namespace pileus::planner
