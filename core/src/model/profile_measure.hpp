// Numbers taken from a profile over equidistant heights.
#pragma once
#include <cstddef>
#include <span>

#include "scene/scene.hpp"

namespace pileus::model {

/// Values at bottom + k spacing, k = 0, 1, ….
struct Profile {
  std::span<const double> values;
  double bottom = 0, spacing = 1;  // m

  double height(std::size_t k) const { return bottom + static_cast<double>(k) * spacing; }
};

/// Linear between levels, constant beyond the ends.
double value_at(const Profile& profile, double height);

/// Height of the extremum of the parabola through the level of the smallest value and its two
/// neighbours; the level itself at an end. NaN where nothing is a number.
double height_of_smallest(const Profile& profile);
double height_of_largest(const Profile& profile);

/// What of a profile is asked for: all but `value` over the levels from `low` to `high`.
using ProfileMeasure = scene::SlabValueControl::Measure;

/// The levels in [low, high] (m) that hold numbers count; NaN where none does, and where fewer than
/// two define a straight line.
/// `slope`: of the least-squares line (per m). `nonlinearity`: largest deviation from that line
/// over its largest magnitude. `logarithmic_slope`: of the least-squares line over ln of the height
/// above the profile's bottom, without the bottom itself.
double measure(const Profile& profile, ProfileMeasure what, double low, double high);

}  // namespace pileus::model
