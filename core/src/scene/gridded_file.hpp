// A variable of a netCDF-4 or plain HDF5 file on its own rectilinear grid.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "scene/scene.hpp"

namespace pileus::scene {

/// Trilinear interpolation of one variable: periodic in the horizontal, constant beyond the lowest
/// and highest level.
class GriddedField {
 public:
  /// Reads `field.variable` of `field.path`: dimensions [time,] z, y, x (2D: [time,] z, x), of
  /// which the last record is taken. Coordinates come from the dimension scales; without them the
  /// points are spread evenly over the domain (x, y: n points from the lower corner; z: n levels
  /// from wall to wall). Units are the variable's attribute, unless the scene states them. Throws
  /// pileus::Error, pointing at the scene: ExitCode::file when the file cannot be opened or is cut
  /// short, ExitCode::usage when its content is not what the scene says.
  GriddedField(const FieldDescription& field, const Domain& domain);

  /// Value at a point (y is ignored in two dimensions), in the units of the field description.
  double operator()(double x, double y, double z) const;

 private:
  struct Axis {
    std::vector<double> points;  // ascending
    double period = 0;           // 0: not periodic
    struct Place {
      std::size_t low, high;
      double weight;  // of `high`
    };
    Place find(double coordinate) const;
  };
  std::array<Axis, 3> axes_;    // x, y, z; y has one point in two dimensions
  std::vector<double> values_;  // x fastest
};

}  // namespace pileus::scene
