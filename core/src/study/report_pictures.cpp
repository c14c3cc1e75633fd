#include "study/report_pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.hpp"

namespace pileus::study {

using output::ResultsFile;
using output::StoredVariable;

namespace {

/// Pixels across a section picture panel are about this; coarser meshes are refined to it.
constexpr std::size_t panel_points = 400;
constexpr std::size_t curves_per_picture = 6;
constexpr std::size_t longest_title = 48;  // characters

/// A unit for reading: kilometres beyond 2 km, grams per kilogram for mixing ratios.
struct Display {
  double factor = 1;
  std::string units;
};
Display display_length(double extent) {
  return extent >= 2000 ? Display{1e-3, "km"} : Display{1, "m"};
}
Display display_value(const StoredVariable& variable) {
  const bool is_mass_fraction = variable.name.starts_with("mass_fraction") && variable.units == "1";
  if (variable.units == "kg kg-1" || is_mass_fraction) return {1e3, "g kg⁻¹"};
  return {1, pretty_units(variable.units)};
}

std::string with_units(const std::string& quantity, const std::string& units) {
  return units.empty() ? quantity : fmt::format("{} / {}", quantity, units);
}

std::string readable_name(const StoredVariable& variable) {
  // A definition of several words more than a title can hold stays with the file.
  if (!variable.long_name.empty() && variable.long_name.size() <= longest_title) {
    return variable.long_name;
  }
  std::string name = variable.name;
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

bool is_field(const StoredVariable& variable) {
  const auto& d = variable.dimensions;
  return d == std::vector<std::string>{"time", "z", "y", "x"} ||
         d == std::vector<std::string>{"time", "z", "x"};
}

/// 0 for what a picture of a cloud shows first; "liquid water buoyancy" is no condensate.
int rank_of(const std::string& name) {
  const auto has = [&](const char* part) { return name.find(part) != std::string::npos; };
  if (has("buoyancy")) return 1;
  return has("liquid") || has("cloud") ? 0 : 2;
}

/// Both signs matter when the smaller extreme is more than noise.
bool has_both_signs(const SectionPicture& picture) {
  double low = 0, high = 0;
  for (const SectionPanel& panel : picture.panels) {
    for (const double value : panel.values) {
      low = std::min(low, value);
      high = std::max(high, value);
    }
  }
  return std::min(-low, high) > 0.02 * std::max(-low, high);
}

struct SectionAxes {
  std::vector<double> x, z;  // m
  bool has_y = false;
  std::size_t middle = 0;  // index along y
  double y = 0;            // m
};

SectionAxes read_axes(const ResultsFile& file, const StoredVariable& variable) {
  SectionAxes axes;
  axes.x = file.read("x");
  axes.z = file.read("z");
  axes.has_y = variable.dimensions.size() == 4;
  if (axes.has_y) {
    const std::vector<double> y = file.read("y");
    axes.middle = y.size() / 2;
    axes.y = y[axes.middle];
  }
  return axes;
}

SectionPanel read_panel(const ResultsFile& file, const StoredVariable& variable,
                        const SectionAxes& axes, std::size_t record, double factor) {
  const std::size_t n_x = axes.x.size(), n_z = axes.z.size();
  const std::vector<double> values =
      axes.has_y ? file.read(variable.name, std::vector<std::size_t>{record, 0, axes.middle, 0},
                             std::vector<std::size_t>{1, n_z, 1, n_x})
                 : file.read(variable.name, std::vector<std::size_t>{record, 0, 0},
                             std::vector<std::size_t>{1, n_z, n_x});
  SectionPanel panel;
  panel.columns = n_x + 1;
  panel.rows = n_z;
  for (std::size_t k = 0; k < n_z; ++k) {
    // The node beyond the last is the first again.
    for (std::size_t i = 0; i <= n_x; ++i) {
      panel.values.push_back(factor * values[k * n_x + i % n_x]);
    }
  }
  return panel;
}

}  // namespace

std::string pretty_units(std::string_view units) {
  if (units == "1") return "";
  static const std::map<char, std::string> superscripts = {
      {'-', "⁻"}, {'0', "⁰"}, {'1', "¹"}, {'2', "²"}, {'3', "³"}, {'4', "⁴"},
      {'5', "⁵"}, {'6', "⁶"}, {'7', "⁷"}, {'8', "⁸"}, {'9', "⁹"}};
  std::string result;
  bool in_symbol = false;  // "1e-3 m2": digits are exponents in the second word only
  for (std::size_t i = 0; i < units.size(); ++i) {
    const char c = units[i];
    if (i == 0 || units[i - 1] == ' ') in_symbol = std::isalpha(static_cast<unsigned char>(c)) != 0;
    result += in_symbol && superscripts.contains(c) ? superscripts.at(c) : std::string(1, c);
  }
  return result;
}

std::vector<std::size_t> spread_records(std::size_t records, std::size_t count) {
  std::vector<std::size_t> chosen;
  const std::size_t wanted = std::min(records, count);
  for (std::size_t i = 1; i <= wanted; ++i) chosen.push_back(records * i / wanted - 1);
  return chosen;
}

std::vector<std::size_t> nearest_records(const std::vector<double>& record_times,
                                         const std::vector<double>& times) {
  std::vector<std::size_t> chosen;
  for (const double time : times) {
    const auto nearest = std::min_element(
        record_times.begin(), record_times.end(),
        [&](double a, double b) { return std::abs(a - time) < std::abs(b - time); });
    chosen.push_back(static_cast<std::size_t>(nearest - record_times.begin()));
  }
  return chosen;
}

std::vector<std::string> gridded_fields(const ResultsFile& file) {
  std::vector<std::string> names;
  for (const StoredVariable& variable : file.variables()) {
    if (is_field(variable)) names.push_back(variable.name);
  }
  std::stable_sort(names.begin(), names.end(), [](const std::string& a, const std::string& b) {
    return rank_of(a) < rank_of(b);
  });
  return names;
}

SectionPicture section_picture(const ResultsFile& file, const std::string& field,
                               const std::vector<std::size_t>& records) {
  const StoredVariable* variable = file.find(field);
  if (variable == nullptr || !is_field(*variable)) {
    throw Error(ExitCode::usage, fmt::format("there is no gridded field '{}'; there are {}", field,
                                             fmt::join(gridded_fields(file), ", ")));
  }
  const SectionAxes axes = read_axes(file, *variable);
  const std::vector<double> times = file.read("time");
  const double width = axes.x.back() - axes.x.front() + (axes.x[1] - axes.x[0]);
  const Display length = display_length(std::max(width, axes.z.back() - axes.z.front()));
  const Display value = display_value(*variable);

  SectionPicture picture;
  picture.title = readable_name(*variable);
  if (axes.has_y) {
    picture.title +=
        fmt::format(", section at y = {:.4g} {}", length.factor * axes.y, length.units);
  }
  picture.horizontal_label = with_units("x", length.units);
  picture.vertical_label = with_units("z", length.units);
  // The name stands in the title; beside the scale its unit is enough.
  picture.value_label = value.units;
  for (const std::size_t record : records) {
    SectionPanel panel = read_panel(file, *variable, axes, record, value.factor);
    panel.title = fmt::format("t = {:.6g} s", times[record]);
    panel.left = length.factor * axes.x.front();
    panel.right = panel.left + length.factor * width;
    panel.bottom = length.factor * axes.z.front();
    panel.top = length.factor * axes.z.back();
    picture.panels.push_back(refine(
        panel, std::max<std::size_t>(1, panel_points / std::max(panel.columns, panel.rows))));
  }
  picture.diverging = has_both_signs(picture);
  return picture;
}

std::vector<CurvePicture> series_pictures(const ResultsFile& file) {
  const std::vector<double> times = file.read("time");
  std::vector<CurvePicture> pictures;
  std::map<std::string, std::size_t> open;  // units → the picture that still takes curves
  for (const StoredVariable& variable : file.variables()) {
    if (variable.dimensions != std::vector<std::string>{"time"} || variable.name == "time")
      continue;
    const auto found = open.find(variable.units);
    if (found == open.end() || pictures[found->second].curves.size() == curves_per_picture) {
      open[variable.units] = pictures.size();
      const std::string units = pretty_units(variable.units);
      pictures.push_back({"", "t / s", units.empty() ? "dimensionless" : units, {}});
    }
    CurvePicture& picture = pictures[open[variable.units]];
    std::string label = variable.name;
    std::replace(label.begin(), label.end(), '_', ' ');
    picture.curves.push_back({std::move(label), times, file.read(variable.name)});
  }
  return pictures;
}

std::vector<CurvePicture> profile_pictures(const ResultsFile& file) {
  const std::vector<double> times = file.read("time"), heights = file.read("z");
  std::vector<std::size_t> records = {0, times.size() / 2, times.size() - 1};
  records.erase(std::unique(records.begin(), records.end()), records.end());
  const Display length = display_length(heights.back() - heights.front());
  std::vector<double> z = heights;
  for (double& height : z) height *= length.factor;

  std::vector<CurvePicture> pictures;
  for (const StoredVariable& variable : file.variables()) {
    if (variable.dimensions != std::vector<std::string>{"time", "z"}) continue;
    const Display value = display_value(variable);
    CurvePicture picture{readable_name(variable),
                         with_units(readable_name(variable), value.units),
                         with_units("z", length.units),
                         {}};
    for (const std::size_t record : records) {
      std::vector<double> values = file.read(variable.name, std::vector<std::size_t>{record, 0},
                                             std::vector<std::size_t>{1, heights.size()});
      for (double& each : values) each *= value.factor;
      picture.curves.push_back({fmt::format("t = {:.6g} s", times[record]), std::move(values), z});
    }
    pictures.push_back(std::move(picture));
  }
  return pictures;
}

}  // namespace pileus::study
