#include "model/potential_energy.hpp"

#include <omp.h>

#include <algorithm>
#include <numeric>

#include "base/parallel.hpp"

namespace pileus::model {

using Form = scene::EnergyControl::Form;

PotentialEnergy::PotentialEnergy(const scene::Scene& scene) : control_(scene.energy) {
  if (control_.form == Form::formula)
    formula_.assign(static_cast<std::size_t>(omp_get_max_threads()),
                    scene::Formula(control_.formula, {"b", "z"}, scene.constants));
}

double PotentialEnergy::available(const Simulation& simulation) {
  return control_.form == Form::sorted ? above_sorted(simulation) : density_mean(simulation);
}

double PotentialEnergy::density_mean(const Simulation& simulation) {
  const parcels::Store& store = simulation.store();
  const double* volume = store.volume();
  const double* b = simulation.buoyancy();
  const double* z = store.position(simulation.dimension() - 1);
  const double n2 = control_.squared_buoyancy_frequency;
  const double sum = ordered_reduce(
      store.size(), 0.0,
      [&](std::size_t begin, std::size_t end) {
        double partial = 0;
        if (control_.form == Form::linear) {
          for (std::size_t p = begin; p < end; ++p) {
            const double anomaly = b[p] - n2 * z[p];
            partial += volume[p] * anomaly * anomaly;
          }
          return partial / (2 * n2);
        }
        scene::Formula& density = formula_[static_cast<std::size_t>(omp_get_thread_num())];
        for (std::size_t p = begin; p < end; ++p) {
          const double arguments[2] = {b[p], z[p]};
          partial += volume[p] * density(arguments);
        }
        return partial;
      },
      [](double a, double c) { return a + c; });
  return sum / simulation.domain_volume();
}

/// Stacks the parcels as horizontal layers, the least buoyant at the bottom: a layer's centre lies
/// where half of its volume is below.
double PotentialEnergy::above_sorted(const Simulation& simulation) {
  const parcels::Store& store = simulation.store();
  const double* volume = store.volume();
  const double* b = simulation.buoyancy();
  const double* z = store.position(simulation.dimension() - 1);
  const std::uint64_t* uid = store.uid();
  order_.resize(store.size());
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  std::sort(order_.begin(), order_.end(), [&](std::size_t p, std::size_t q) {
    return b[p] != b[q] ? b[p] < b[q] : uid[p] < uid[q];
  });
  const double area = simulation.domain_volume() / simulation.height();
  double stacked = 0, difference = 0;
  for (const std::size_t p : order_) {
    const double layer = simulation.bottom() + (stacked + 0.5 * volume[p]) / area;
    difference += volume[p] * b[p] * (layer - z[p]);
    stacked += volume[p];
  }
  return difference / simulation.domain_volume();
}

}  // namespace pileus::model
