// Pictures of an ensemble's spread: percentile bands and the median of a series over time.
#pragma once
#include <ostream>
#include <string>
#include <vector>

#include "study/picture.hpp"
#include "study/sweep_collection.hpp"

namespace pileus::study {

struct BandPicture {
  std::string title, x_label, y_label;
  std::vector<double> x;
  std::vector<double> low, lower, median, upper, high;  // percentiles 5, 25, 50, 75 and 95 at x
  std::vector<std::vector<double>> members;             // drawn as thin lines
};

/// The complete gnuplot script with its data, without `set terminal` and `set output`.
std::string gnuplot_script(const BandPicture& picture);
PictureSize size_of(const BandPicture& picture);

/// The picture of one variable of a stream of series.
BandPicture band_picture(const CollectedStream& series, std::size_t variable,
                         const std::string& title, std::size_t members);

/// Removes the pictures of an earlier collection from the sweep's folder.
void remove_pictures(const SweepResult& result);

/// Draws the series that the sweep asks for, or a few, to <name>_<series>.svg, .png and .gp in the
/// sweep's folder. A series that does not exist is named in `out`, with the nearest.
void draw_spread(const SweepResult& result, const CollectedStream& series, std::ostream& out);

}  // namespace pileus::study
