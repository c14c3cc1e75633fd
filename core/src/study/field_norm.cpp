#include "study/field_norm.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "output/read_fields.hpp"

namespace pileus::study {

namespace {

/// A position between two nodes of an axis.
struct Bracket {
  std::size_t below, above;
  double share;  // of `above`
};

Bracket bracket(const std::vector<double>& nodes, double period, double position) {
  const std::size_t last = nodes.size() - 1;
  if (last == 0) return {0, 0, 0};
  const double spacing = nodes[1] - nodes[0];
  double at = (position - nodes[0]) / spacing;  // meshes are uniform
  // Nodes that are meant to coincide are not told apart by their rounding.
  if (std::abs(at - std::round(at)) < 1e-6) at = std::round(at);
  const auto count = static_cast<double>(nodes.size());
  if (period > 0) at -= count * std::floor(at / count);
  at = std::clamp(at, 0.0, period > 0 ? count : static_cast<double>(last));
  const auto below = std::min(static_cast<std::size_t>(at), last);
  const double share = at - static_cast<double>(below);
  const std::size_t above = below < last ? below + 1 : period > 0 ? 0 : last;
  return {below, above, share};
}

/// One axis of `field` replaced by the nodes of `nodes`.
GriddedField along_axis(const GriddedField& field, std::size_t axis,
                        const std::vector<double>& nodes) {
  std::size_t outer = 1, inner = 1;
  for (std::size_t a = 0; a < field.axes.size(); ++a)
    (a < axis ? outer : inner) *= a == axis ? 1 : field.axes[a].size();
  const std::size_t old_count = field.axes[axis].size();
  GriddedField result = field;
  result.axes[axis] = nodes;
  result.values.assign(outer * nodes.size() * inner, 0);
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const Bracket b = bracket(field.axes[axis], field.period[axis], nodes[n]);
    for (std::size_t o = 0; o < outer; ++o) {
      const double* from_below = &field.values[(o * old_count + b.below) * inner];
      const double* from_above = &field.values[(o * old_count + b.above) * inner];
      double* to = &result.values[(o * nodes.size() + n) * inner];
      for (std::size_t i = 0; i < inner; ++i)
        to[i] = (1 - b.share) * from_below[i] + b.share * from_above[i];
    }
  }
  return result;
}

/// Share of the volume that a node stands for, up to a constant: half on the walls.
double weight_of(const GriddedField& field, std::size_t node) {
  const std::size_t levels = field.axes.front().size();
  const std::size_t level = node / (field.values.size() / levels);
  return levels > 1 && (level == 0 || level + 1 == levels) ? 0.5 : 1.0;
}

std::vector<double> histogram(const GriddedField& field, const ErrorNorm& norm) {
  std::vector<double> density(static_cast<std::size_t>(norm.bins), 0.0);
  double total = 0;
  const double width = (norm.high - norm.low) / norm.bins;
  for (std::size_t n = 0; n < field.values.size(); ++n) {
    const double place = std::clamp((field.values[n] - norm.low) / width, 0.0, norm.bins - 1.0);
    const double weight = weight_of(field, n);
    density[static_cast<std::size_t>(place)] += weight;
    total += weight;
  }
  for (double& d : density) d /= total * width;
  return density;
}

/// √(Σ w (a − b)²/Σ w); without `b` about zero.
double rms(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

}  // namespace

GriddedField read_field(const std::filesystem::path& folder, const std::string& name) {
  const output::ResultsFile file(folder / "fields.nc");
  const output::StoredVariable* variable = file.find(name);
  if (variable == nullptr || variable->extent.size() < 3)
    throw Error(ExitCode::file, fmt::format("{}: has no gridded field '{}'",
                                            (folder / "fields.nc").string(), name));
  GriddedField field;
  std::vector<std::size_t> start(variable->extent.size(), 0), count = variable->extent;
  start[0] = count[0] - 1;
  count[0] = 1;
  field.values = file.read(name, start, count);
  for (std::size_t a = 1; a < variable->dimensions.size(); ++a) {
    field.axes.push_back(file.read(variable->dimensions[a]));
    const std::vector<double>& nodes = field.axes.back();
    const double spacing = nodes.size() > 1 ? nodes[1] - nodes[0] : 1;
    field.period.push_back(a == 1 ? 0 : spacing * static_cast<double>(nodes.size()));
  }
  return field;
}

std::vector<double> values_at(const GriddedField& field, const GriddedField& nodes) {
  GriddedField result = field;
  for (std::size_t a = 0; a < field.axes.size(); ++a) result = along_axis(result, a, nodes.axes[a]);
  return result.values;
}

double field_error(const GriddedField& field, const GriddedField& finest) {
  const std::vector<double> right = values_at(finest, field);
  double difference = 0, weights = 0, mean = 0, deviation = 0;
  for (std::size_t n = 0; n < right.size(); ++n) {
    const double weight = weight_of(field, n);
    weights += weight;
    mean += weight * right[n];
    difference += weight * (field.values[n] - right[n]) * (field.values[n] - right[n]);
  }
  mean /= weights;
  for (std::size_t n = 0; n < right.size(); ++n)
    deviation += weight_of(field, n) * (right[n] - mean) * (right[n] - mean);
  const double scale = deviation > 0 ? std::sqrt(deviation / weights) : 1;
  return std::sqrt(difference / weights) / scale;
}

double histogram_error(const GriddedField& field, const GriddedField& finest,
                       const ErrorNorm& norm) {
  const std::vector<double> right = histogram(finest, norm);
  const std::vector<double> zero(right.size(), 0.0);
  return rms(histogram(field, norm), right) / rms(right, zero);
}

}  // namespace pileus::study
