// A gridded field against the solution a scene knows.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "model/simulation.hpp"
#include "scene/formula.hpp"
#include "scene/scene.hpp"

namespace pileus::model {

class ExactComparison {
 public:
  ExactComparison(const scene::ExactSolution& exact, const scene::Scene& scene,
                  const Simulation& simulation);

  /// Name, units and meaning of the numbers compare() returns.
  std::vector<std::array<std::string, 3>> outputs() const;

  /// r.m.s. error over the r.m.s. of the exact field (walls at half weight); with a frequency also
  /// amplitude over exact amplitude, phase error (rad) and relative frequency error, from the
  /// projections on the exact field and on the exact field a quarter period earlier.
  std::vector<double> compare(Simulation& simulation);

 private:
  double exact_value(double x, double y, double z, double t);

  scene::ExactSolution exact_;
  scene::Formula formula_;
  bool three_dimensional_;
  std::vector<output::Axis> axes_;
  std::vector<double> field_;
};

}  // namespace pileus::model
