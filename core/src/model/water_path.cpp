#include "model/water_path.hpp"

#include <algorithm>

#include "base/parallel.hpp"
#include "model/initial_state.hpp"

namespace pileus::model {
namespace {

/// Heights per cell at which the density is tabulated: linear in between, it is off by
/// (Δz/16)²/(8 H²), some 1e-7 for cells of 100 m and a scale height H of 8 km.
constexpr int points_per_cell = 16;

}  // namespace

WaterPath::WaterPath(const scene::Scene& scene, const Simulation& simulation)
    : density_(profile_over_height(scene.diagnostics.water_path.density, scene,
                                   "the density of diagnostics.water_path", simulation.bottom(),
                                   simulation.bottom() + simulation.height(),
                                   points_per_cell * scene.domain.cells.back() + 1)),
      bottom_(scene.diagnostics.water_path.bottom.value_or(simulation.bottom())),
      top_(scene.diagnostics.water_path.top.value_or(simulation.bottom() + simulation.height())) {}

double WaterPath::measure(const Simulation& simulation, const double* quantity) const {
  const parcels::Store& store = simulation.store();
  const double* volume = store.volume();
  const double* z = store.position(simulation.dimension() - 1);
  const double sum = ordered_reduce(
      store.size(), 0.0,
      [&](std::size_t begin, std::size_t end) {
        double part = 0;
        for (std::size_t p = begin; p < end; ++p)
          if (z[p] >= bottom_ && z[p] <= top_) part += volume[p] * density_(z[p]) * quantity[p];
        return part;
      },
      [](double a, double b) { return a + b; });
  return sum * simulation.height() / simulation.domain_volume();
}

}  // namespace pileus::model
