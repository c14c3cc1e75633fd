#include "model/prescribed_velocity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/parallel.hpp"
#include "base/units.hpp"
#include "model/sixth_order_difference.hpp"
#include "scene/problems.hpp"

namespace pileus::model {
namespace {

/// Positions of the directions among the coordinates x, y, z and t of a formula.
template <int D>
constexpr std::array<std::size_t, D> coordinate_of() {
  if constexpr (D == 3)
    return {0, 1, 2};
  else
    return {0, 2};
}
constexpr std::size_t time_coordinate = 3;

scene::PointFormula compiled(const scene::FlowControl::Component& component,
                             const scene::Scene& scene) {
  try {
    return scene::PointFormula(component.formula, {"x", "y", "z", "t"},
                               {scene.constants, scene.formulas});
  } catch (const scene::FormulaProblem& problem) {
    throw Error(ExitCode::usage,
                fmt::format("{}: error: {}", scene::describe(component.where), problem.text));
  }
}

template <int D>
std::array<scene::FlowControl::Component, D> components_of(const scene::FlowControl& flow) {
  if constexpr (D == 3)
    return {flow.x, flow.y, flow.z};
  else
    return {flow.x, flow.z};
}

}  // namespace

template <int D>
PrescribedVelocity<D>::PrescribedVelocity(const scene::Scene& scene, const mesh::Grid<D>& grid)
    : text_(components_of<D>(scene.flow)), grid_(grid), per_thread_(1) {
  for (const auto& component : text_) per_thread_.front().push_back(compiled(component, scene));
  match_threads();
}

/// muParser keeps its stack in the parser: every thread works with a copy of its own.
template <int D>
void PrescribedVelocity<D>::match_threads() {
  const auto threads = static_cast<std::size_t>(std::max(1, omp_get_max_threads()));
  while (per_thread_.size() < threads) per_thread_.push_back(Components(per_thread_.front()));
}

template <int D>
bool PrescribedVelocity<D>::steady() const {
  return std::none_of(per_thread_.front().begin(), per_thread_.front().end(),
                      [](const auto& formula) { return formula.uses(time_coordinate); });
}

template <int D>
double PrescribedVelocity<D>::value(scene::PointFormula& formula, const std::array<double, 4>& at,
                                    std::size_t component, double time) const {
  const double result = formula(at.data());
  if (std::isfinite(result)) return result;
  throw Error(
      ExitCode::numerical,
      fmt::format("{}: error: the prescribed velocity is {} at x = {} m, y = {} m, z = {} m, "
                  "t = {} s",
                  scene::describe(text_[component].where),
                  std::isnan(result) ? "not a number" : "infinite", shortest(at[0]),
                  shortest(at[1]), shortest(at[2]), shortest(time)));
}

template <int D>
double PrescribedVelocity<D>::derivative(scene::PointFormula& formula, std::array<double, 4> at,
                                         std::size_t axis) const {
  const std::size_t coordinate = coordinate_of<D>()[axis];
  if (!formula.uses(coordinate)) return 0;
  const double centre = at[coordinate], h = grid_.spacing[axis] * difference_step;
  double sum = 0;
  for (std::size_t m = 0; m < difference_weights.size(); ++m) {
    const double offset = static_cast<double>(m + 1) * h;
    at[coordinate] = centre + offset;
    const double ahead = formula(at.data());
    at[coordinate] = centre - offset;
    sum += difference_weights[m] * (ahead - formula(at.data()));
  }
  return sum / h;
}

template <int D>
void PrescribedVelocity<D>::sample(double time, std::size_t count,
                                   const std::array<const double*, D>& position,
                                   const dynamics::FlowSamples<D>& out) {
  Components& formulas = per_thread_[static_cast<std::size_t>(omp_get_thread_num())];
  constexpr std::size_t last = dynamics::StageJob<D>::gradient_components;
  for (std::size_t c = 0, slot = 0; c < D; ++c) {
    scene::PointFormula& formula = formulas[c];
    const bool uniform = !formula.uses(0) && !formula.uses(1) && !formula.uses(2);
    // w_z follows from the others, as it does for the parcels of a flow without divergence.
    const std::size_t axes = std::min<std::size_t>(D, last - slot);
    for (std::size_t i = 0; i < count; ++i) {
      std::array<double, 4> at{0, 0, 0, time};
      for (std::size_t d = 0; d < D; ++d) at[coordinate_of<D>()[d]] = position[d][i];
      const bool known = uniform && i > 0;
      out.velocity[c][i] = known ? out.velocity[c][0] : value(formula, at, c, time);
      for (std::size_t axis = 0; axis < axes; ++axis)
        out.gradient[slot + axis][i] = derivative(formula, at, axis);
    }
    slot += axes;
  }
}

template <int D>
double PrescribedVelocity<D>::relative_divergence(double time) {
  double divergence = 0, gradient = 0;
  for (std::size_t column = 0; column < grid_.columns(); ++column)
    for (int k = 0; k < grid_.nz(); ++k) {
      const auto nx = static_cast<std::size_t>(grid_.nx());
      const std::array<std::size_t, 3> index = {column % nx, column / nx,
                                                static_cast<std::size_t>(k)};
      std::array<double, 4> at{0, 0, 0, time};
      for (std::size_t d = 0; d < D; ++d)
        at[coordinate_of<D>()[d]] =
            grid_.lower[d] +
            (static_cast<double>(index[d == D - 1 ? 2 : d]) + 0.5) * grid_.spacing[d];
      double sum = 0;
      for (std::size_t d = 0; d < D; ++d) {
        const double along = derivative(per_thread_.front()[d], at, d);
        sum += along;
        gradient = std::max(gradient, std::abs(along));
      }
      divergence = std::max(divergence, std::abs(sum));
    }
  return gradient > 0 ? divergence / gradient : 0;
}

template class PrescribedVelocity<2>;
template class PrescribedVelocity<3>;

}  // namespace pileus::model
