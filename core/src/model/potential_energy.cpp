#include "model/potential_energy.hpp"

#include <omp.h>

#include <algorithm>

#include "base/parallel.hpp"

namespace pileus::model {

using Form = scene::EnergyControl::Form;

PotentialEnergy::PotentialEnergy(const scene::Scene& scene) : control_(scene.energy) {
  if (control_.form == Form::formula)
    formula_.assign(static_cast<std::size_t>(omp_get_max_threads()),
                    scene::Formula(control_.formula, {"b", "z"}, scene.constants));
}

double PotentialEnergy::available(const Simulation& simulation) {
  const bool has_density = control_.form == Form::linear || control_.form == Form::formula;
  return has_density ? density_mean(simulation) : above_sorted(simulation);
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

/// Stacks the parcels as horizontal layers, the least buoyant at the bottom. Buoyancies are told
/// apart in `classes` equal steps of their range: a class is one layer, and its parcels are
/// referred to the layer's middle. The error is a 2·classes-th of the range times the layer's
/// thickness.
double PotentialEnergy::above_sorted(const Simulation& simulation) {
  constexpr std::size_t classes = 16384;
  const parcels::Store& store = simulation.store();
  const double* volume = store.volume();
  const double* b = simulation.buoyancy();
  const double* z = store.position(simulation.dimension() - 1);
  const auto [low, high] = std::minmax_element(b, b + store.size());
  const double least = *low, per_class = (*high - least) / classes;
  if (!(per_class > 0)) return 0;
  const auto class_of = [&](double value) {
    return std::min(classes - 1, static_cast<std::size_t>((value - least) / per_class));
  };
  layer_volume_.assign(classes, 0.0);
  for (std::size_t p = 0; p < store.size(); ++p) layer_volume_[class_of(b[p])] += volume[p];
  const double area = simulation.domain_volume() / simulation.height();
  layer_height_.resize(classes);
  double below = 0;
  for (std::size_t c = 0; c < classes; ++c) {
    layer_height_[c] = simulation.bottom() + (below + 0.5 * layer_volume_[c]) / area;
    below += layer_volume_[c];
  }
  const double sum = ordered_reduce(
      store.size(), 0.0,
      [&](std::size_t begin, std::size_t end) {
        double partial = 0;
        for (std::size_t p = begin; p < end; ++p)
          partial += volume[p] * b[p] * (layer_height_[class_of(b[p])] - z[p]);
        return partial;
      },
      [](double x, double y) { return x + y; });
  return sum / simulation.domain_volume();
}

}  // namespace pileus::model
