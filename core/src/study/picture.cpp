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

// Layout in px: what is left for the panels after labels, title and colour bar.
constexpr int panel_height = 400, left_margin = 80, right_margin = 140, top_margin = 84,
              bottom_margin = 76, gap = 18;

int panel_width(const SectionPicture& picture) {
  return std::clamp(static_cast<int>(panel_height * aspect_of(picture)), 120, 1600);
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
  const int panels = static_cast<int>(picture.panels.size());
  return {left_margin + panels * panel_width(picture) + (panels - 1) * gap + right_margin,
          top_margin + panel_height + bottom_margin};
}

PictureSize size_of(const CurvePicture&) {
  return {760, 440};
}

std::string gnuplot_script(const SectionPicture& picture) {
  const PictureSize size = size_of(picture);
  const Range range = range_of(picture);
  const double width = size.width, height = size.height;
  std::string script = "set encoding utf8\nunset key\n";
  for (std::size_t p = 0; p < picture.panels.size(); ++p)
    script += data_block(p, picture.panels[p]);
  script += picture.diverging ? diverging_palette : sequential_palette;
  script += fmt::format("set cbrange [{:.10g}:{:.10g}]\n", range.low, range.high);
  script += "set tics out nomirror\nset border 3 lc rgb '#444444'\nset format cb '%.3g'\n";
  script += fmt::format("set label 1 {} noenhanced at screen {:.5f},{:.5f} left font ',15'\n",
                        quoted(picture.title), left_margin / width, 1 - 24 / height);
  script +=
      fmt::format("set xlabel {} noenhanced\nset multiplot\n", quoted(picture.horizontal_label));
  for (std::size_t p = 0; p < picture.panels.size(); ++p) {
    const SectionPanel& panel = picture.panels[p];
    const double left = left_margin + static_cast<double>(p) * (panel_width(picture) + gap);
    script += fmt::format("set lmargin at screen {:.5f}\nset rmargin at screen {:.5f}\n",
                          left / width, (left + panel_width(picture)) / width);
    script += fmt::format("set bmargin at screen {:.5f}\nset tmargin at screen {:.5f}\n",
                          bottom_margin / height, (bottom_margin + panel_height) / height);
    if (p == 0) {
      script += fmt::format("set ylabel {} noenhanced\n", quoted(picture.vertical_label));
    } else {
      script += "unset ylabel\nset format y ''\nunset label 1\n";
    }
    // One colour bar, beside the last panel.
    script += p + 1 < picture.panels.size()
                  ? std::string("unset colorbox\n")
                  : fmt::format(
                        "set colorbox user origin screen {:.5f},{:.5f} size screen "
                        "{:.5f},{:.5f} noborder\nset cblabel {} noenhanced offset 1,0\n",
                        1 - (right_margin - 14) / width, bottom_margin / height, 14 / width,
                        panel_height / height, quoted(picture.value_label));
    script += fmt::format("set title {} noenhanced offset 0,-0.3\n", quoted(panel.title));
    script += fmt::format("set xrange [{0:.8g}:{1:.8g}]\nset yrange [{2:.8g}:{3:.8g}]\n",
                          panel.left, panel.right, panel.bottom, panel.top);
    const double across = (panel.right - panel.left) / static_cast<double>(panel.columns - 1);
    const double up = (panel.top - panel.bottom) / static_cast<double>(panel.rows - 1);
    script += fmt::format(
        "plot $panel{} matrix using ({:.8g}+$1*{:.8g}):({:.8g}+$2*{:.8g}):3 with image\n", p,
        panel.left, across, panel.bottom, up);
  }
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
