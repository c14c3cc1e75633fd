// Pictures of results: the data and the gnuplot script that draws them, as SVG and as PNG.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace pileus::study {

/// One vertical section: values at nodes, horizontal index fastest.
struct SectionPanel {
  std::string title;
  std::size_t columns = 0, rows = 0;  // nodes across and up
  double left = 0, right = 0;         // of the outermost nodes, in the axes' unit
  double bottom = 0, top = 0;
  std::vector<double> values;  // columns × rows
};

/// Sections side by side under one colour scale, in equal aspect.
struct SectionPicture {
  std::string title;
  std::string horizontal_label, vertical_label, value_label;
  bool diverging = false;  // a scale symmetric about zero: blue below, red above
  std::vector<SectionPanel> panels;
};

struct Curve {
  std::string label;         // empty: no entry in the legend
  std::vector<double> x, y;  // equally long; a value that is not finite breaks the line
};

struct CurvePicture {
  std::string title, x_label, y_label;
  std::vector<Curve> curves;
};

/// Values between nodes by bilinear interpolation, which is how the model itself reads its mesh:
/// `factor` points per node distance, so (columns−1)·factor+1 across and alike upwards.
SectionPanel refine(const SectionPanel& panel, std::size_t factor);

/// The complete gnuplot script with its data, without `set terminal` and `set output`.
std::string gnuplot_script(const SectionPicture& picture);
std::string gnuplot_script(const CurvePicture& picture);

struct PictureSize {
  int width = 800, height = 500;  // px
};
PictureSize size_of(const SectionPicture& picture);
PictureSize size_of(const CurvePicture& picture);

/// Writes `stem`.gp and draws `stem`.svg and `stem`.png from it with gnuplot.
/// Throws Error(file) when a file cannot be written, or gnuplot is missing or fails (with its
/// words).
void draw(const std::string& script, PictureSize size, const std::filesystem::path& stem);

}  // namespace pileus::study
