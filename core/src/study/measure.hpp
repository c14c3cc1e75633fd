// The errors of a finished run, by the study's norms.
#pragma once
#include <filesystem>
#include <vector>

#include "study/outcome.hpp"
#include "study/study_file.hpp"

namespace pileus::study {

/// The errors of the run in `folder`, one per norm of the study, NaN where one is not defined (a
/// statistic that does not exist, such as the growth rate of a series with a zero). `finest` is the
/// folder of the run that errors are compared with, where they need one.
///
/// Errors  Error(ExitCode::usage) for a diagnostic that the run does not have, naming the nearest;
///         Error(ExitCode::file) for results that cannot be read
std::vector<double> measure_errors(const Study& study, const std::filesystem::path& folder,
                                   const std::filesystem::path& finest);

/// The same for an experiment that measures itself: norms name its numbers as diagnostics.
std::vector<double> errors_of_numbers(const Study& study, const RunOutcome& outcome);

}  // namespace pileus::study
