#include "study/sweep_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "base/nearest_word.hpp"
#include "study/scene_settings.hpp"
#include "study/sweep_statistics.hpp"

namespace pileus::study {

namespace fs = std::filesystem;

namespace {

/// Drawn where a sweep does not say, those that a run has.
constexpr std::array<const char*, 5> usual_series = {"mean_liquid_water", "cloud_fraction",
                                                     "max_vertical_velocity", "kinetic_energy",
                                                     "total_energy"};
constexpr std::size_t few = 3, most_lines = 60;

/// Text between single quotes of a gnuplot script; enhanced text is off where it is used.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    result += c;
    if (c == '\'') result += c;
  }
  return result + "'";
}

/// A line of numbers; an empty one, which gnuplot takes for a gap, when one is missing.
std::string data_line(std::initializer_list<double> numbers) {
  std::string line;
  for (const double number : numbers) {
    if (!std::isfinite(number)) return "\n";
    line += fmt::format("{}{:.8g}", line.empty() ? "" : " ", number);
  }
  return line + '\n';
}

std::vector<std::string> names_of(const CollectedStream& series) {
  std::vector<std::string> names;
  for (const output::Variable& variable : series.variables) names.push_back(variable.name);
  return names;
}

std::vector<std::string> chosen_series(const SweepResult& result,
                                       const std::vector<std::string>& names, std::ostream& out) {
  std::vector<std::string> chosen;
  const auto exists = [&](const std::string& name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  for (const std::string& name : result.ensemble.sweep.pictures) {
    if (exists(name)) {
      chosen.push_back(name);
      continue;
    }
    const std::string nearest = nearest_word(name, names);
    out << fmt::format("pictures: the members have no series '{}'{}\n", name,
                       nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest));
  }
  if (!result.ensemble.sweep.pictures.empty()) return chosen;
  for (const char* name : usual_series)
    if (exists(name) && chosen.size() < few) chosen.emplace_back(name);
  for (const std::string& name : names)
    if (chosen.empty()) chosen.push_back(name);
  return chosen;
}

}  // namespace

PictureSize size_of(const BandPicture&) {
  return {760, 440};
}

std::string gnuplot_script(const BandPicture& picture) {
  std::string script =
      "set encoding utf8\nset tics out nomirror\nset border 3 lc rgb '#444444'\n"
      "set grid lc rgb '#dddddd'\nset key outside right top noenhanced\nset format '%g'\n"
      "$bands << EOD\n";
  for (std::size_t i = 0; i < picture.x.size(); ++i)
    script += data_line({picture.x[i], picture.low[i], picture.lower[i], picture.median[i],
                         picture.upper[i], picture.high[i]});
  script += "EOD\n";
  for (std::size_t m = 0; m < picture.members.size(); ++m) {
    script += fmt::format("$member{} << EOD\n", m);
    for (std::size_t i = 0; i < picture.x.size(); ++i)
      script += data_line({picture.x[i], picture.members[m][i]});
    script += "EOD\n";
  }
  script +=
      fmt::format("set title {} noenhanced\nset xlabel {} noenhanced\nset ylabel {} noenhanced\n",
                  quoted(picture.title), quoted(picture.x_label), quoted(picture.y_label));
  script +=
      "plot $bands using 1:2:6 with filledcurves fc rgb '#cfdff0' title '5 to 95 %', "
      "$bands using 1:3:5 with filledcurves fc rgb '#8fb4dc' title '25 to 75 %'";
  for (std::size_t m = 0; m < picture.members.size(); ++m)
    script += fmt::format(", $member{} using 1:2 with lines lw 0.4 lc rgb '#777777' {}", m,
                          m == 0 ? "title 'members'" : "notitle");
  return script + ", $bands using 1:4 with lines lw 2.4 lc rgb '#16325c' title 'median'\n";
}

BandPicture band_picture(const CollectedStream& series, std::size_t variable,
                         const std::string& title, std::size_t members) {
  const output::Variable& of = series.variables[variable];
  const std::size_t size = series.record_size();
  BandPicture picture{
      title,
      "time (s)",
      of.units.empty() || of.units == "1" ? of.name : fmt::format("{} ({})", of.name, of.units),
      series.axes.front().values,
      {},
      {},
      {},
      {},
      {},
      {}};
  std::vector<double> column;
  for (std::size_t i = 0; i < size; ++i) {
    column.clear();
    for (std::size_t m = 0; m < members; ++m)
      column.push_back(series.values[variable][m * size + i]);
    const MemberStatistics statistics = statistics_of(column);
    picture.low.push_back(statistics.at_percentile[0]);
    picture.lower.push_back(statistics.at_percentile[1]);
    picture.median.push_back(statistics.at_percentile[2]);
    picture.upper.push_back(statistics.at_percentile[3]);
    picture.high.push_back(statistics.at_percentile[4]);
  }
  for (std::size_t m = 0; m < members && members <= most_lines; ++m) {
    if (!series.present[variable][m]) continue;
    const auto first = series.values[variable].begin() + static_cast<std::ptrdiff_t>(m * size);
    picture.members.emplace_back(first, first + static_cast<std::ptrdiff_t>(size));
  }
  return picture;
}

void remove_pictures(const SweepResult& result) {
  const std::string prefix = identifier(result.ensemble.sweep.name) + "_";
  std::vector<fs::path> scripts;
  for (const auto& entry : fs::directory_iterator(result.directory))
    if (entry.path().extension() == ".gp" && entry.path().filename().string().starts_with(prefix))
      scripts.push_back(entry.path());
  for (fs::path file : scripts)  // a picture without its script is not ours
    for (const char* ending : {".svg", ".png", ".gp"}) fs::remove(file.replace_extension(ending));
}

void draw_spread(const SweepResult& result, const CollectedStream& series, std::ostream& out) {
  const Sweep& sweep = result.ensemble.sweep;
  const std::vector<std::string> names = names_of(series);
  for (const std::string& name : chosen_series(result, names, out)) {
    const auto variable =
        static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
    const BandPicture picture = band_picture(series, variable, sweep.title, result.records.size());
    draw(gnuplot_script(picture), size_of(picture),
         result.directory / fmt::format("{}_{}", identifier(sweep.name), name));
  }
}

}  // namespace pileus::study
