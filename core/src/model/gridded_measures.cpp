#include "model/gridded_measures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "scene/formula.hpp"

namespace pileus::model {
namespace {

std::vector<double> sample(const std::string& text, const scene::Scene& scene,
                           const NodeField& nodes) {
  scene::Formula formula(text, {"x", "y", "z"}, scene.constants);
  std::vector<double> values;
  values.reserve(nodes.x.size() * nodes.y.size() * nodes.z.size());
  for (const double z : nodes.z)
    for (const double y : nodes.y)
      for (const double x : nodes.x) {
        const double arguments[3] = {x, y, z};
        values.push_back(formula(arguments));
      }
  return values;
}

double dot(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace

NodeField nodes_of(const Simulation& simulation) {
  const std::vector<output::Axis> axes = simulation.axes();
  NodeField nodes;
  nodes.z = axes.front().values;
  nodes.x = axes.back().values;
  nodes.y = axes.size() == 3 ? axes[1].values : std::vector<double>{0.0};
  const pileus_grid grid = simulation.plugin_grid();
  nodes.period = static_cast<double>(grid.cells[0]) * grid.spacing[0];
  return nodes;
}

Mode::Mode(const scene::ModeControl& control, const scene::Scene& scene, const NodeField& nodes)
    : name_(control.name), variable_(control.variable) {
  const std::vector<double> cosine = sample(control.cosine, scene, nodes);
  const std::size_t level = nodes.x.size() * nodes.y.size();
  const auto weighted = [&](std::vector<double> shape) {
    for (std::size_t i = 0; i < level; ++i) {
      shape[i] *= 0.5;
      shape[shape.size() - 1 - i] *= 0.5;
    }
    return shape;
  };
  cosine_ = weighted(cosine);
  cc_ = dot(cosine_, cosine);
  bool usable = cc_ > 0 && std::isfinite(cc_);
  if (!control.sine.empty()) {
    const std::vector<double> sine = sample(control.sine, scene, nodes);
    sine_ = weighted(sine);
    cs_ = dot(cosine_, sine);
    ss_ = dot(sine_, sine);
    usable = usable && cc_ * ss_ - cs_ * cs_ > 1e-12 * cc_ * ss_;
  }
  if (!usable)
    throw Error(ExitCode::usage,
                fmt::format("{}:{}:{}: error: the shapes of the mode '{}' vanish, are not finite, "
                            "or are the same on this mesh.",
                            control.where.file, control.where.line, control.where.column, name_));
}

std::vector<std::array<std::string, 3>> Mode::outputs() const {
  std::vector<std::array<std::string, 3>> list = {
      {name_ + "_amplitude", "1", "amplitude of a mode of " + variable_ + ", in its unit"}};
  if (!sine_.empty()) list.push_back({name_ + "_phase", "rad", "phase of the mode"});
  return list;
}

std::vector<double> Mode::measure(const NodeField& field) const {
  const double fc = dot(cosine_, field.values);
  if (sine_.empty()) return {std::abs(fc / cc_)};
  const double fs = dot(sine_, field.values);
  const double determinant = cc_ * ss_ - cs_ * cs_;
  const double a = (fc * ss_ - fs * cs_) / determinant;
  const double b = (fs * cc_ - fc * cs_) / determinant;
  return {std::hypot(a, b), std::atan2(b, a)};
}

double front_position(const NodeField& field, const scene::FrontControl& front) {
  const std::vector<double>& zs = field.z;
  const double height = std::clamp(front.height.value_or(zs.front()), zs.front(), zs.back());
  const auto above = std::upper_bound(zs.begin() + 1, zs.end() - 1, height);
  const auto upper = static_cast<std::size_t>(above - zs.begin());
  const double fraction = (height - zs[upper - 1]) / (zs[upper] - zs[upper - 1]);
  const double sign = front.side == scene::FrontControl::Side::above ? 1.0 : -1.0;

  const std::size_t nx = field.x.size();
  const double spacing = field.period / static_cast<double>(nx);
  double farthest = 0;
  for (std::size_t j = 0; j < field.y.size(); ++j) {
    // How far beyond the threshold, at node i; the last node is the first one, a period further.
    const auto excess = [&](std::size_t i) {
      const double low = field.at(i % nx, j, upper - 1), high = field.at(i % nx, j, upper);
      return sign * (low + fraction * (high - low) - front.threshold);
    };
    const auto reach = [&](double nodes) {
      return std::abs(field.x.front() + nodes * spacing - field.centre());
    };
    for (std::size_t i = 0; i < nx; ++i) {
      const double here = excess(i), next = excess(i + 1);
      const auto x = static_cast<double>(i);
      if (here >= 0) farthest = std::max(farthest, reach(x));
      if (next >= 0) farthest = std::max(farthest, reach(x + 1));
      if ((here < 0) != (next < 0)) farthest = std::max(farthest, reach(x + here / (here - next)));
    }
  }
  return farthest;
}

double asymmetry(const NodeField& field, bool odd) {
  const std::size_t nx = field.x.size();
  double difference = 0, largest = 0;
  for (std::size_t k = 0; k < field.z.size(); ++k)
    for (std::size_t j = 0; j < field.y.size(); ++j)
      for (std::size_t i = 0; i < nx; ++i) {
        const double value = field.at(i, j, k), image = field.at((nx - i) % nx, j, k);
        difference = std::max(difference, std::abs(odd ? value + image : value - image));
        largest = std::max(largest, std::abs(value));
      }
  return largest > 0 ? difference / largest : 0.0;
}

}  // namespace pileus::model
