// Whether a member that is done has the results that a sweep collects.
#pragma once
#include <string>
#include <vector>

#include "study/sweep_run.hpp"

namespace pileus::study {

/// Why the results of a member cannot be collected, as one line that names the file; empty when
/// they can. Reads them to their end: a file that was cut short may open all the same.
std::string results_problem(const std::filesystem::path& sweep, const Member& member);

/// The records of the members in the sweep's folder. One whose results are missing or damaged is
/// not done, whatever its marker says, and waits; it is named in `problems`. Members without a key
/// are not looked at.
std::vector<MemberRecord> load_records(const std::filesystem::path& sweep, const Ensemble& ensemble,
                                       std::vector<std::string>& problems);

}  // namespace pileus::study
