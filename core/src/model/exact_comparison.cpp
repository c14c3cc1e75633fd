#include "model/exact_comparison.hpp"

#include <cmath>
#include <numbers>

namespace pileus::model {

ExactComparison::ExactComparison(const scene::ExactSolution& exact, const scene::Scene& scene,
                                 const Simulation& simulation)
    : exact_(exact),
      formula_(exact.formula, {"x", "y", "z", "t"}, scene.constants),
      three_dimensional_(simulation.dimension() == 3),
      axes_(simulation.axes()) {}

std::vector<std::array<std::string, 3>> ExactComparison::outputs() const {
  std::vector<std::array<std::string, 3>> list = {
      {exact_.variable + "_rms_error", "1", "r.m.s. error relative to the exact field's r.m.s."}};
  if (exact_.frequency != 0) {
    list.push_back({exact_.variable + "_amplitude", "1", "amplitude relative to the exact one"});
    list.push_back({exact_.variable + "_phase_error", "rad", "phase ahead of the exact wave"});
    list.push_back({exact_.variable + "_frequency_error", "1", "relative error of the frequency"});
  }
  return list;
}

double ExactComparison::exact_value(double x, double y, double z, double t) {
  const double arguments[4] = {x, y, z, t};
  return formula_(arguments);
}

std::vector<double> ExactComparison::compare(Simulation& simulation) {
  simulation.grid_field(exact_.variable, field_);
  const std::vector<double>& zs = axes_.front().values;
  const std::vector<double>& xs = axes_.back().values;
  const std::vector<double> origin = {0.0};
  const std::vector<double>& ys = three_dimensional_ ? axes_[1].values : origin;
  const double t = simulation.time();
  const bool wave = exact_.frequency != 0;
  const double quarter = wave ? 0.5 * std::numbers::pi / exact_.frequency : 0;

  double error2 = 0, exact2 = 0, in_phase = 0, in_quadrature = 0;
  std::size_t at = 0;
  for (std::size_t k = 0; k < zs.size(); ++k) {
    const double weight = k == 0 || k + 1 == zs.size() ? 0.5 : 1.0;
    for (const double y : ys)
      for (const double x : xs) {
        const double found = field_[at++];
        const double e = exact_value(x, y, zs[k], t);
        error2 += weight * (found - e) * (found - e);
        exact2 += weight * e * e;
        if (!wave) continue;
        in_phase += weight * found * e;
        in_quadrature += weight * found * exact_value(x, y, zs[k], t + quarter);
      }
  }
  std::vector<double> result = {std::sqrt(error2 / exact2)};
  if (wave) {
    // A wave cos(φ − σt) that is ahead by ε projects as cos ε on itself and as sin ε on its own
    // shape a quarter period later.
    const double phase = std::atan2(in_quadrature, in_phase);
    result.push_back(std::hypot(in_phase, in_quadrature) / exact2);
    result.push_back(phase);
    result.push_back(t > 0 ? phase / (exact_.frequency * t) : 0.0);
  }
  return result;
}

}  // namespace pileus::model
