// Volume-weighted histograms of parcel quantities and their distance from published ones.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "model/simulation.hpp"
#include "scene/scene.hpp"

namespace pileus::model {

class Histogram {
 public:
  /// Throws Error (usage) for an unknown quantity or an unreadable reference.
  Histogram(const scene::HistogramControl& control, const Simulation& simulation);

  std::vector<std::array<std::string, 3>> outputs() const;

  /// Density over the bins, normalised to one over the whole range (values outside count at the
  /// ends); then: the centre of the highest bin above the first, the upper edge of the last
  /// non-empty bin, and per reference the r.m.s. difference over the bins above the first, where
  /// clear air sits.
  std::vector<double> measure(const Simulation& simulation);

  /// Density of the last measure(), per unit of the binned quantity.
  const std::vector<double>& density() const { return density_; }
  const scene::HistogramControl& control() const { return control_; }

 private:
  scene::HistogramControl control_;
  int scalar_;
  std::vector<std::vector<double>> references_;
  std::vector<double> density_;
};

}  // namespace pileus::model
