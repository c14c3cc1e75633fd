#include "model/histogram.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "model/table_column.hpp"

namespace pileus::model {
Histogram::Histogram(const scene::HistogramControl& control, const Simulation& simulation)
    : control_(control), scalar_(simulation.store().find_scalar(control.variable)) {
  if (scalar_ < 0)
    throw Error(
        ExitCode::usage,
        fmt::format("{}:{}: error: histogram '{}': no parcel quantity '{}' in this run.",
                    control.where.file, control.where.line, control.name, control.variable));
  for (const auto& reference : control.references) {
    references_.push_back(
        read_table_column(reference.path, reference.column,
                          fmt::format("{}:{}", reference.where.file, reference.where.line)));
    if (references_.back().size() != static_cast<std::size_t>(control.bins))
      throw Error(ExitCode::usage,
                  fmt::format("{}:{}: error: '{}' has {} rows, the histogram {} bins.",
                              reference.where.file, reference.where.line, reference.path,
                              references_.back().size(), control.bins));
  }
  density_.assign(static_cast<std::size_t>(control.bins), 0.0);
}

std::vector<std::array<std::string, 3>> Histogram::outputs() const {
  std::vector<std::array<std::string, 3>> list = {
      {control_.name + "_mode", "1", "centre of the highest bin above the first"},
      {control_.name + "_highest", "1", "upper edge of the last non-empty bin"}};
  for (const auto& reference : control_.references)
    list.push_back({control_.name + "_distance_" + reference.label, "1",
                    "r.m.s. difference of densities above the first bin"});
  return list;
}

std::vector<double> Histogram::measure(const Simulation& simulation) {
  const parcels::Store& store = simulation.store();
  const double* volume = store.volume();
  const double* value = store.scalar(scalar_);
  const double width = (control_.high - control_.low) / control_.bins;
  const double inverse_unit = 1.0 / control_.unit;
  std::fill(density_.begin(), density_.end(), 0.0);
  for (std::size_t p = 0; p < store.size(); ++p) {
    const double at = std::floor((value[p] * inverse_unit - control_.low) / width);
    const double bin = std::clamp(at, 0.0, control_.bins - 1.0);
    density_[static_cast<std::size_t>(bin)] += volume[p];
  }
  for (double& d : density_) d /= simulation.domain_volume() * width;

  std::size_t mode = 1, last = 0;
  for (std::size_t i = 1; i < density_.size(); ++i) {
    if (density_[i] > density_[mode]) mode = i;
    if (density_[i] > 0) last = i;
  }
  const auto edge = [&](double i) { return control_.low + i * width; };
  std::vector<double> result = {density_.size() > 1 ? edge(static_cast<double>(mode) + 0.5) : 0.0,
                                edge(static_cast<double>(last) + 1.0)};
  for (const auto& reference : references_) {
    double sum = 0;
    for (std::size_t i = 1; i < density_.size(); ++i)
      sum += (density_[i] - reference[i]) * (density_[i] - reference[i]);
    result.push_back(std::sqrt(sum / static_cast<double>(density_.size() - 1)));
  }
  return result;
}

}  // namespace pileus::model
