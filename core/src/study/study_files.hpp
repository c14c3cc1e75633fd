// The files a study leaves: the findings for programs, for spreadsheets and for later choices.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "study/work_precision.hpp"

namespace pileus::study {

/// One row per point in netCDF-4 form, published points included.
void write_findings_netcdf(const std::filesystem::path& path, const Findings& findings);
/// The same as comma-separated values with a header row.
void write_findings_csv(const std::filesystem::path& path, const Findings& findings);
/// What `pileus run --target-error` chooses from: settings, errors and cost of every point, with
/// machine, version and date. The base scene is named relative to the file.
void write_findings_json(const std::filesystem::path& path, const Findings& findings);

/// SHA-256 of what a scene file (with what it extends) simulates under some settings, key=value:
/// comments, layout, title, description, outputs and expectations aside, and whatever the settings
/// replace. Throws Error(usage) when it cannot be read or a setting has no
/// place in it.
std::string scene_fingerprint(const std::string& path, const std::vector<std::string>& settings);

/// The processor's name and number of cores, as the operating system gives them.
std::string machine_name();

}  // namespace pileus::study
