#include "study/report.hpp"

#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>

#include "base/error.hpp"
#include "output/read_fields.hpp"
#include "study/picture.hpp"
#include "study/report_page.hpp"
#include "study/report_pictures.hpp"

namespace pileus::study {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t sections_per_picture = 4;

std::optional<std::string> read_text(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return std::nullopt;
  return std::string(std::istreambuf_iterator<char>(file), {});
}

void write_text(const fs::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  if (!file.flush())
    throw Error(ExitCode::file, fmt::format("{}: cannot be written", path.string()));
}

std::optional<output::ResultsFile> open_if_there(const fs::path& path) {
  if (!fs::exists(path)) return std::nullopt;
  return std::optional<output::ResultsFile>(std::in_place, path);
}

bool has_records(const std::optional<output::ResultsFile>& file) {
  if (!file) return false;
  const output::StoredVariable* time = file->find("time");
  return time != nullptr && !time->extent.empty() && time->extent.front() > 0;
}

void make_folder(const fs::path& folder) {
  std::error_code problem;
  fs::create_directories(folder, problem);
  if (problem) {
    throw Error(ExitCode::file,
                fmt::format("{}: cannot be created: {}", folder.string(), problem.message()));
  }
}

/// Draws and returns the SVG text.
template <class Picture>
std::string draw_svg(const Picture& picture, const fs::path& stem) {
  draw(gnuplot_script(picture), size_of(picture), stem);
  fs::path svg = stem;
  svg += ".svg";
  return read_text(svg).value_or("");
}

std::vector<std::size_t> chosen_records(const output::ResultsFile& fields,
                                        const std::vector<double>& times) {
  const std::vector<double> record_times = fields.read("time");
  return times.empty() ? spread_records(record_times.size(), sections_per_picture)
                       : nearest_records(record_times, times);
}

nlohmann::json read_summary(const fs::path& path) {
  const std::optional<std::string> text = read_text(path);
  if (!text) return nullptr;
  try {
    return nlohmann::json::parse(*text);
  } catch (const nlohmann::json::exception& error) {
    throw Error(ExitCode::file, fmt::format("{}: {}", path.string(), error.what()));
  }
}

PageSection draw_sections(const output::ResultsFile& fields, const ReportRequest& request,
                          const fs::path& folder) {
  PageSection section{"Vertical sections", {}};
  const std::vector<std::string> names =
      request.field.empty() ? gridded_fields(fields) : std::vector<std::string>{request.field};
  const std::vector<std::size_t> records = chosen_records(fields, request.times);
  for (const std::string& name : names) {
    section.svgs.push_back(
        draw_svg(section_picture(fields, name, records), folder / ("section_" + name)));
  }
  return section;
}

PageSection draw_curves(const std::string& heading, const std::vector<CurvePicture>& pictures,
                        const fs::path& folder, const std::string& name) {
  PageSection section{heading, {}};
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    section.svgs.push_back(draw_svg(pictures[i], folder / fmt::format("{}_{}", name, i + 1)));
  }
  return section;
}

[[noreturn]] void refuse_folder(const fs::path& directory) {
  throw Error(ExitCode::usage,
              fmt::format("{}: holds no results of a run (no fields.nc, series.nc, profiles.nc)",
                          directory.string()));
}

}  // namespace

fs::path write_report(const ReportRequest& request) {
  const fs::path directory = request.directory;
  const auto fields = open_if_there(directory / "fields.nc");
  const auto series = open_if_there(directory / "series.nc");
  const auto profiles = open_if_there(directory / "profiles.nc");
  if (!has_records(fields) && !has_records(series) && !has_records(profiles)) {
    refuse_folder(directory);
  }
  const fs::path folder = directory / "report";
  make_folder(folder);
  std::vector<PageSection> sections;
  if (has_records(fields)) sections.push_back(draw_sections(*fields, request, folder));
  if (has_records(series)) {
    sections.push_back(draw_curves("Time series", series_pictures(*series), folder, "series"));
  }
  if (has_records(profiles)) {
    sections.push_back(draw_curves("Profiles", profile_pictures(*profiles), folder, "profile"));
  }
  const fs::path page = directory / "report.html";
  write_text(page, report_page(read_summary(directory / "summary.json"), sections));
  return page;
}

void write_section(const ReportRequest& request, const fs::path& picture) {
  const fs::path directory = request.directory;
  const std::string ending = picture.extension().string();
  if (ending != ".png" && ending != ".svg") {
    throw Error(ExitCode::usage,
                fmt::format("{}: a picture ends in .png or .svg", picture.string()));
  }
  const auto fields = open_if_there(directory / "fields.nc");
  if (!has_records(fields)) refuse_folder(directory);
  const std::string field = request.field.empty() ? gridded_fields(*fields).front() : request.field;
  if (picture.has_parent_path()) make_folder(picture.parent_path());
  // Drawn beside its destination under a name of its own, then moved: never half a picture there.
  fs::path stem = picture;
  stem.replace_extension();
  stem += ".drawing";
  const SectionPicture section =
      section_picture(*fields, field, chosen_records(*fields, request.times));
  draw(gnuplot_script(section), size_of(section), stem);
  fs::rename(stem.string() + ending, picture);
  for (const char* other : {".gp", ".svg", ".png"}) fs::remove(stem.string() + other);
}

}  // namespace pileus::study
