#include "scene/gridded_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/units.hpp"
#include "scene/hdf5_reader.hpp"
#include "scene/problems.hpp"

namespace pileus::scene {
namespace {

/// Coordinates in metres, checked to ascend.
std::vector<double> metres(const FileAxis& axis) {
  std::vector<double> points = axis.points;
  if (!axis.units.empty()) {
    const UnitConversion zero = convert_units(0, axis.units, "m");
    const UnitConversion one = convert_units(1, axis.units, "m");
    if (!one.ok())
      throw WrongContent(fmt::format("the coordinate '{}': {}", axis.name, one.problem));
    for (double& point : points) point = zero.value + point * (one.value - zero.value);
  }
  for (std::size_t i = 1; i < points.size(); ++i)
    if (!(points[i] > points[i - 1]))
      throw WrongContent(fmt::format("the coordinate '{}' does not ascend", axis.name));
  return points;
}

/// Multiplies and shifts values from the file's units into the wanted ones.
void convert(std::vector<double>& values, const std::string& from, const std::string& to) {
  if (from.empty() || from == to) return;
  const UnitConversion zero = convert_units(0, from, to);
  const UnitConversion one = convert_units(1, from, to);
  if (!one.ok()) throw WrongContent(fmt::format("the variable's units: {}", one.problem));
  for (double& value : values) value = zero.value + value * (one.value - zero.value);
}

std::string shape_text(const std::vector<hsize_t>& shape) {
  std::string text;
  for (const hsize_t n : shape) text += (text.empty() ? "" : " x ") + std::to_string(n);
  return text.empty() ? "a single number" : text;
}

}  // namespace

GriddedField::GriddedField(const FieldDescription& field, const Domain& domain) {
  const auto dimension = static_cast<std::size_t>(domain.dimension);
  try {
    Hdf5Reader reader(field.path);
    reader.open(field.variable);
    const std::vector<hsize_t>& shape = reader.shape();
    const bool empty = std::find(shape.begin(), shape.end(), hsize_t{0}) != shape.end();
    if ((shape.size() != dimension && shape.size() != dimension + 1) || empty)
      throw WrongContent(
          fmt::format("the variable '{}' of '{}' is {}; a {}-dimensional scene takes [time,] {}",
                      field.variable, field.path, shape_text(shape), dimension,
                      dimension == 3 ? "z, y, x" : "z, x"));
    values_ = reader.last_record(dimension);
    convert(values_, field.file_units.empty() ? reader.attribute("units") : field.file_units,
            field.units);
    const std::size_t first = shape.size() - dimension;
    axes_[1].points = {0.0};
    for (std::size_t d = 0; d < dimension; ++d) {  // d: direction of the domain, x first
      const bool vertical = d + 1 == dimension;
      const std::size_t in_file = first + (dimension - 1 - d);
      Axis& axis = axes_[vertical ? 2 : d];
      axis.points = metres(reader.axis(in_file));
      axis.period = vertical ? 0 : domain.extent[d];
      const auto n = static_cast<std::size_t>(shape[in_file]);
      if (axis.points.empty()) {
        const double parts = vertical ? double(std::max<std::size_t>(n - 1, 1)) : double(n);
        for (std::size_t i = 0; i < n; ++i)
          axis.points.push_back(domain.lower[d] + domain.extent[d] * double(i) / parts);
      }
      if (!vertical && axis.points.back() - axis.points.front() > axis.period * (1 + 1e-9))
        throw WrongContent(
            fmt::format("the data span {} m in direction {}, more than the domain's "
                        "period of {} m",
                        shortest(axis.points.back() - axis.points.front()), d == 0 ? "x" : "y",
                        shortest(axis.period)));
    }
  } catch (const UnreadableFile& failure) {
    throw Error(ExitCode::file,
                fmt::format("{}: error: {}", describe(field.where), failure.what()));
  } catch (const WrongContent& failure) {
    throw Error(ExitCode::usage,
                fmt::format("{}: error: {}", describe(field.where), failure.what()));
  }
}

GriddedField::Axis::Place GriddedField::Axis::find(double coordinate) const {
  const std::size_t n = points.size();
  if (n == 1) return {0, 0, 0.0};
  if (period > 0) {
    coordinate -= period * std::floor((coordinate - points.front()) / period);
    if (coordinate >= points.back()) {  // between the last point and the first one's next image
      const double gap = points.front() + period - points.back();
      // A file that repeats the first point at the far end leaves no gap.
      if (!(gap > 1e-9 * period)) return {n - 1, 0, 0.0};
      return {n - 1, 0, std::min(1.0, (coordinate - points.back()) / gap)};
    }
  }
  if (coordinate <= points.front()) return {0, 0, 0.0};
  if (coordinate >= points.back()) return {n - 1, n - 1, 0.0};
  const auto above = std::upper_bound(points.begin(), points.end(), coordinate);
  const auto high = static_cast<std::size_t>(above - points.begin());
  return {high - 1, high, (coordinate - points[high - 1]) / (points[high] - points[high - 1])};
}

double GriddedField::operator()(double x, double y, double z) const {
  const Axis::Place px = axes_[0].find(x), py = axes_[1].find(y), pz = axes_[2].find(z);
  const std::size_t nx = axes_[0].points.size(), ny = axes_[1].points.size();
  const auto row = [&](std::size_t j, std::size_t k) {
    const double* line = values_.data() + (k * ny + j) * nx;
    return (1 - px.weight) * line[px.low] + px.weight * line[px.high];
  };
  const auto layer = [&](std::size_t k) {
    return (1 - py.weight) * row(py.low, k) + py.weight * row(py.high, k);
  };
  return (1 - pz.weight) * layer(pz.low) + pz.weight * layer(pz.high);
}

}  // namespace pileus::scene
