// Evaluates a field of a scene at any set of points.
#pragma once
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scene/gridded_file.hpp"
#include "scene/point_formula.hpp"
#include "scene/scene.hpp"

namespace pileus::scene {

class FieldSampler {
 public:
  /// Compiles the formula or reads the file; throws pileus::Error pointing at the scene's line.
  FieldSampler(const FieldDescription& field, const Vocabulary& vocabulary, const Domain& domain);
  FieldSampler(const FieldDescription& field, const Scene& scene);
  ~FieldSampler();
  FieldSampler(FieldSampler&&) noexcept;
  FieldSampler& operator=(FieldSampler&&) noexcept;

  /// out[i] = the field, noise included, at (x[i], y[i], z[i]) in metres, in the field's SI units.
  /// `y` is not read in two dimensions and may be null. Runs on all threads; the values do not
  /// depend on their number. Throws pileus::Error naming the first point whose value is not finite.
  void sample(std::size_t n, const double* x, const double* y, const double* z, double* out) const;

  /// Whether the field is one constant without noise, and which.
  std::optional<double> uniform_value() const;

  /// Whether the field depends on height alone: a constant, a profile, or a formula without x and
  /// y, and no noise.
  bool height_alone() const;

  /// Value of a piecewise-linear profile, constant beyond its ends.
  static double interpolate(const Profile& profile, double z);

 private:
  void sample_range(std::size_t begin, std::size_t end, const double* x, const double* y,
                    const double* z, double* out, PointFormula* formula) const;
  double noise(double x, double y, double z) const;

  FieldDescription field_;
  Vocabulary vocabulary_;
  Domain domain_;
  std::unique_ptr<const PointFormula> compiled_;  // of a formula; copied once per thread
  std::optional<GriddedField> gridded_;
};

}  // namespace pileus::scene
