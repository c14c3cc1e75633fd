// From a run's files to the pictures of its report.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "output/read_fields.hpp"
#include "study/picture.hpp"

namespace pileus::study {

/// "m s-2" → "m s⁻²"; "1" and "" → "".
std::string pretty_units(std::string_view units);

/// Indices of at most `count` records: the last one, and others evenly spaced before it; the first
/// is among them only when `count` allows no fewer.
std::vector<std::size_t> spread_records(std::size_t records, std::size_t count);

/// For each of `times` (s) the index of the nearest record.
std::vector<std::size_t> nearest_records(const std::vector<double>& record_times,
                                         const std::vector<double>& times);

/// Names of the gridded fields of a file, those over (time, z, y, x) or (time, z, x), in the order
/// in which a report shows them: condensate first, buoyancy next, then as in the file.
std::vector<std::string> gridded_fields(const output::ResultsFile& file);

/// Vertical sections of a field through the middle of the domain at some records; the periodic
/// direction is closed. Throws Error(file) when the field is missing.
SectionPicture section_picture(const output::ResultsFile& file, const std::string& field,
                               const std::vector<std::size_t>& records);

/// The series of a file by unit, at most six curves in a picture.
std::vector<CurvePicture> series_pictures(const output::ResultsFile& file);

/// Each profile of a file at the start, the middle and the end of the run.
std::vector<CurvePicture> profile_pictures(const output::ResultsFile& file);

}  // namespace pileus::study
