// The velocity a scene prescribes by formulas.
#pragma once
#include <array>
#include <vector>

#include "dynamics/velocity_field.hpp"
#include "mesh/grid.hpp"
#include "scene/point_formula.hpp"
#include "scene/scene.hpp"

namespace pileus::model {

/// The gradient is a central difference of the sixth order (sixth_order_difference.hpp), and
/// exactly zero in directions that a formula does not name.
template <int D>
class PrescribedVelocity final : public dynamics::VelocityField<D> {
 public:
  /// Throws Error (usage) pointing at a formula that cannot be compiled.
  PrescribedVelocity(const scene::Scene& scene, const mesh::Grid<D>& grid);

  void match_threads() override;
  void sample(double time, std::size_t count, const std::array<const double*, D>& position,
              const dynamics::FlowSamples<D>& out) override;
  bool steady() const override;

  /// Largest |∇·u| over the largest |∂u_i/∂x_i| at the cells' centres at a time; 0 for a flow
  /// without gradients.
  double relative_divergence(double time);

 private:
  using Components = std::vector<scene::PointFormula>;  // one per direction

  double value(scene::PointFormula& formula, const std::array<double, 4>& at, std::size_t component,
               double time) const;
  double derivative(scene::PointFormula& formula, std::array<double, 4> at, std::size_t axis) const;

  std::array<scene::FlowControl::Component, D> text_;
  mesh::Grid<D> grid_;
  std::vector<Components> per_thread_;
};

}  // namespace pileus::model
