#include "study/picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <limits>

#include "base/error.hpp"

namespace pileus::study {

namespace {

// Lightness rises evenly from night blue to white, so that equal steps of the value look equal and
// a print in grey still reads; condensate ends in the white of a cloud.
constexpr const char* sequential_palette =
    "set palette defined (0 '#0a1433', 1 '#14285c', 2 '#1f4487', 3 '#3163a8', 4 '#4c84bd', "
    "5 '#70a3cd', 6 '#98c0dc', 7 '#c1dae9', 8 '#e3eef5', 9 '#ffffff')\n";
// Two branches of equal lightness meet in a light grey at zero.
constexpr const char* diverging_palette =
    "set palette defined (-4 '#16325c', -3 '#2f66a3', -2 '#73a5cf', -1 '#bfd8e8', 0 '#f4f4f2', "
    "1 '#f3cdb5', 2 '#e08f6a', 3 '#bb4436', 4 '#6e1423')\n";

constexpr std::array<const char*, 6> curve_colours = {"#1f4487", "#c8553d", "#3c896d",
                                                      "#8d5a97", "#c99a2e", "#555555"};

/// Text between single quotes of a gnuplot script; enhanced text is off where it is used.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    result += c;
    if (c == '\'') result += c;
  }
  return result + "'";
}

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
};

Range range_of(const SectionPicture& picture) {
  Range range;
  for (const SectionPanel& panel : picture.panels) {
    for (const double value : panel.values) {
      if (!std::isfinite(value)) continue;
      range.low = std::min(range.low, value);
      range.high = std::max(range.high, value);
    }
  }
  if (!(range.low <= range.high)) range = {0, 1};
  if (picture.diverging) {
    range.high = std::max(std::abs(range.low), std::abs(range.high));
    range.low = -range.high;
  }
  // A field that is constant but for rounding is shown as constant.
  const double largest = std::max(std::abs(range.low), std::abs(range.high));
  const double narrowest = largest > 0 ? 1e-5 * largest : 1;
  if (range.high - range.low < narrowest) {
    const double middle = 0.5 * (range.low + range.high);
    range = {middle - 0.5 * narrowest, middle + 0.5 * narrowest};
  }
  return range;
}

std::string data_block(std::size_t index, const SectionPanel& panel) {
  std::string block = fmt::format("$panel{} << EOD\n", index);
  for (std::size_t row = 0; row < panel.rows; ++row) {
    for (std::size_t column = 0; column < panel.columns; ++column) {
      fmt::format_to(std::back_inserter(block), "{:.7g} ",
                     panel.values[row * panel.columns + column]);
    }
    block += '\n';
  }
  return block + "EOD\n";
}

/// Width of a panel over its height.
double aspect_of(const SectionPicture& picture) {
  const SectionPanel& panel = picture.panels.front();
  return (panel.right - panel.left) / (panel.top - panel.bottom);
}

/// Where the panels stand, in px from the lower left corner: side by side when they are about as
/// tall as wide, one above the other when they are wide.
struct Layout {
  static constexpr int left_margin = 104, right_margin = 172, top_margin = 84, bottom_margin = 76;
  static constexpr int gap_across = 18, gap_up = 44;
  static constexpr double widest = 1180, tallest = 400;  // of the panels together; of one

  explicit Layout(const SectionPicture& picture) : panels(static_cast<int>(picture.panels.size())) {
    const double aspect = aspect_of(picture);
    across = aspect > 1.6 ? 1 : panels;
    up = (panels + across - 1) / across;
    width = std::min(tallest * aspect, (widest - (across - 1) * gap_across) / across);
    height = width / aspect;
  }
  double left(int panel) const { return left_margin + panel % across * (width + gap_across); }
  double bottom(int panel) const {
    const int row = panel / across;
    return bottom_margin + (up - 1 - row) * (height + gap_up);
  }
  double panels_height() const { return up * height + (up - 1) * gap_up; }
  PictureSize size() const {
    return {
        static_cast<int>(left_margin + across * width + (across - 1) * gap_across + right_margin),
        static_cast<int>(bottom_margin + panels_height() + top_margin)};
  }

  int panels, across = 1, up = 1;
  double width = 0, height = 0;  // of one panel
};

/// Frame, labels and ranges of one panel, and its plot command.
std::string panel_commands(const SectionPicture& picture, const Layout& layout, int index) {
  const PictureSize size = layout.size();
  const double width = size.width, height = size.height;
  const SectionPanel& panel = picture.panels[static_cast<std::size_t>(index)];
  const double left = layout.left(index), bottom = layout.bottom(index);
  std::string script = fmt::format(
      "set lmargin at screen {:.5f}\nset rmargin at screen {:.5f}\n"
      "set bmargin at screen {:.5f}\nset tmargin at screen {:.5f}\n",
      left / width, (left + layout.width) / width, bottom / height,
      (bottom + layout.height) / height);
  const bool is_leftmost = index % layout.across == 0;
  const bool is_lowest = index / layout.across == layout.up - 1;
  script += is_leftmost ? fmt::format("set ylabel {} noenhanced\nset format y '%g'\n",
                                      quoted(picture.vertical_label))
                        : std::string("unset ylabel\nset format y ''\n");
  script += is_lowest ? fmt::format("set xlabel {} noenhanced\nset format x '%g'\n",
                                    quoted(picture.horizontal_label))
                      : std::string("unset xlabel\nset format x ''\n");
  if (index > 0) script += "unset label 1\n";
  script += index + 1 < layout.panels  // one colour bar, drawn with the last panel
                ? std::string("unset colorbox\n")
                : fmt::format(
                      "set colorbox user origin screen {:.5f},{:.5f} size screen {:.5f},{:.5f} "
                      "noborder\nset cblabel {} noenhanced offset 0.5,0\n",
                      1 - (Layout::right_margin - 14) / width, Layout::bottom_margin / height,
                      14 / width, layout.panels_height() / height, quoted(picture.value_label));
  script += fmt::format("set title {} noenhanced offset 0,-0.5\n", quoted(panel.title));
  script += fmt::format("set xrange [{0:.8g}:{1:.8g}]\nset yrange [{2:.8g}:{3:.8g}]\n", panel.left,
                        panel.right, panel.bottom, panel.top);
  const double across = (panel.right - panel.left) / static_cast<double>(panel.columns - 1);
  const double up = (panel.top - panel.bottom) / static_cast<double>(panel.rows - 1);
  return script +
         fmt::format(
             "plot $panel{} matrix using ({:.8g}+$1*{:.8g}):({:.8g}+$2*{:.8g}):3 with image\n",
             index, panel.left, across, panel.bottom, up);
}

}  // namespace

SectionPanel refine(const SectionPanel& panel, std::size_t factor) {
  SectionPanel fine = panel;
  fine.columns = (panel.columns - 1) * factor + 1;
  fine.rows = (panel.rows - 1) * factor + 1;
  fine.values.assign(fine.columns * fine.rows, 0);
  const auto node = [&](std::size_t column, std::size_t row) {
    return panel.values[std::min(row, panel.rows - 1) * panel.columns +
                        std::min(column, panel.columns - 1)];
  };
  for (std::size_t j = 0; j < fine.rows; ++j) {
    const double up = static_cast<double>(j % factor) / static_cast<double>(factor);
    for (std::size_t i = 0; i < fine.columns; ++i) {
      const double across = static_cast<double>(i % factor) / static_cast<double>(factor);
      const std::size_t column = i / factor, row = j / factor;
      fine.values[j * fine.columns + i] =
          (1 - up) * ((1 - across) * node(column, row) + across * node(column + 1, row)) +
          up * ((1 - across) * node(column, row + 1) + across * node(column + 1, row + 1));
    }
  }
  return fine;
}

PictureSize size_of(const SectionPicture& picture) {
  return Layout(picture).size();
}

PictureSize size_of(const CurvePicture&) {
  return {760, 440};
}

std::string gnuplot_script(const SectionPicture& picture) {
  const Layout layout(picture);
  const PictureSize size = layout.size();
  const Range range = range_of(picture);
  std::string script = "set encoding utf8\nunset key\n";
  for (std::size_t p = 0; p < picture.panels.size(); ++p) {
    script += data_block(p, picture.panels[p]);
  }
  script += picture.diverging ? diverging_palette : sequential_palette;
  script += fmt::format("set cbrange [{:.10g}:{:.10g}]\n", range.low, range.high);
  script += "set tics out nomirror\nset border 3 lc rgb '#444444'\nset format cb '%.3g'\n";
  script += fmt::format(
      "set label 1 {} noenhanced at screen {:.5f},{:.5f} left font ',15'\n", quoted(picture.title),
      static_cast<double>(Layout::left_margin) / size.width, 1 - 24.0 / size.height);
  script += "set multiplot\n";
  for (int p = 0; p < layout.panels; ++p) script += panel_commands(picture, layout, p);
  return script + "unset multiplot\n";
}

std::string gnuplot_script(const CurvePicture& picture) {
  std::string script =
      "set encoding utf8\nset tics out nomirror\nset border 3 lc rgb '#444444'\n"
      "set grid lc rgb '#dddddd'\nset key outside right top noenhanced\nset format '%g'\n";
  for (std::size_t c = 0; c < picture.curves.size(); ++c) {
    const Curve& curve = picture.curves[c];
    script += fmt::format("$curve{} << EOD\n", c);
    for (std::size_t i = 0; i < curve.x.size(); ++i) {
      // An empty line is how gnuplot is told of a gap.
      script += std::isfinite(curve.x[i]) && std::isfinite(curve.y[i])
                    ? fmt::format("{:.8g} {:.8g}\n", curve.x[i], curve.y[i])
                    : std::string("\n");
    }
    script += "EOD\n";
  }
  script +=
      fmt::format("set title {} noenhanced\nset xlabel {} noenhanced\nset ylabel {} noenhanced\n",
                  quoted(picture.title), quoted(picture.x_label), quoted(picture.y_label));
  for (std::size_t c = 0; c < picture.curves.size(); ++c) {
    const Curve& curve = picture.curves[c];
    script += c == 0 ? "plot " : ", ";
    script += fmt::format("$curve{} using 1:2 with lines lw 1.8 lc rgb '{}' {}", c,
                          curve_colours[c % curve_colours.size()],
                          curve.label.empty() ? "notitle" : "title " + quoted(curve.label));
  }
  return script + "\n";
}

void draw(const std::string& script, PictureSize size, const std::filesystem::path& stem) {
  const auto with_ending = [&](const char* ending) {
    std::filesystem::path path = stem;
    path += ending;
    return path.string();
  };
  const std::string script_path = with_ending(".gp");
  const auto outputs = {
      fmt::format("set terminal svg size {},{} font 'sans-serif,13' background '#ffffff'\n"
                  "set output {}\n",
                  size.width, size.height, quoted(with_ending(".svg"))),
      fmt::format("reset\nset terminal pngcairo size {},{} font 'sans,13' fontscale 2 linewidth "
                  "2\nset output {}\n",
                  2 * size.width, 2 * size.height, quoted(with_ending(".png")))};
  {
    std::ofstream file(script_path);
    for (const std::string& output : outputs) file << output << script;
    file << "set output\n";
    if (!file.flush())
      throw Error(ExitCode::file, fmt::format("{}: cannot be written", script_path));
  }
  // Shell quoting: the path stands between single quotes, each of its own replaced by '\''.
  std::string argument;
  for (const char c : script_path) argument += c == '\'' ? std::string("'\\''") : std::string(1, c);
  FILE* gnuplot = popen(fmt::format("gnuplot '{}' 2>&1", argument).c_str(), "r");
  if (gnuplot == nullptr) throw Error(ExitCode::file, "gnuplot cannot be started");
  std::string words;
  for (int c = std::fgetc(gnuplot); c != EOF; c = std::fgetc(gnuplot))
    words += static_cast<char>(c);
  if (const int status = pclose(gnuplot); status != 0) {
    throw Error(ExitCode::file,
                fmt::format("gnuplot could not draw {} (Debian package gnuplot-nox): {}",
                            script_path, words.substr(0, 500)));
  }
}

}  // namespace pileus::study
