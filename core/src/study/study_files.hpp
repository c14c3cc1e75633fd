// The files a study leaves: the findings for programs, for spreadsheets and for later choices.
#pragma once
#include <filesystem>
#include <string>

#include "study/work_precision.hpp"

namespace pileus::study {

/// One row per point in netCDF-4 form, published points included.
void write_findings_netcdf(const std::filesystem::path& path, const Findings& findings);
/// The same as comma-separated values with a header row.
void write_findings_csv(const std::filesystem::path& path, const Findings& findings);
/// What `pileus run --target-error` chooses from: settings, errors and cost of every point, with
/// machine, version and date. The base scene is named relative to the file.
void write_findings_json(const std::filesystem::path& path, const Findings& findings);

/// SHA-256 of a scene file's content (with what it extends), comments and layout aside.
/// Throws Error(usage) when it cannot be read.
std::string scene_fingerprint(const std::string& path);

/// The processor's name and number of cores, as the operating system gives them.
std::string machine_name();

}  // namespace pileus::study
