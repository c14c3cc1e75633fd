// A run on one page: pictures of its files and the numbers of its summary.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace pileus::study {

struct ReportRequest {
  std::string directory;      // of the run
  std::string field;          // only this gridded field; empty: all of them
  std::vector<double> times;  // s; sections at the nearest records; empty: four spread over the run
};

/// Draws the pictures of a run into <directory>/report/ (script, SVG and PNG each) and writes
/// <directory>/report.html, which holds them all and needs no other file. Returns that page's path.
/// Throws Error: usage when the folder holds no results or not this field, file when something
/// cannot be read, written or drawn.
std::filesystem::path write_report(const ReportRequest& request);

/// Draws the sections of one field (the request's, or the first a report would show) to `picture`,
/// whose ending is .png or .svg. The folder's own files stay as they are.
void write_section(const ReportRequest& request, const std::filesystem::path& picture);

}  // namespace pileus::study
