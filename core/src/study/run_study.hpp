// A study from its file to its table, files and pictures.
#pragma once
#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "study/point_process.hpp"
#include "study/study_progress.hpp"
#include "study/work_precision.hpp"

namespace pileus::study {

struct StudyRequest {
  std::string path;
  std::string directory;  // empty: results/studies/<name>
  std::string pictures;   // a folder that gets copies of the pictures; empty: none
  bool keep = false;      // leave the findings in results/ beside the study file
  bool force = false;     // run everything again
  bool draw = true;
};

struct StudyResult {
  Findings findings;
  std::vector<Verdict> verdicts;
  std::filesystem::path directory;
  bool stopped = false;
  /// done; numerical when a bound was missed; stopped.
  ExitCode code() const;
};

/// Runs what earlier calls have not finished, every run in a process of its own, then measures,
/// judges and writes study.nc, study.csv, study.json and pictures to the study's folder and the
/// table to `out`. A run that fails is reported and does not end the study; finished runs are known
/// by their resolved scene and the program's version. A stop that is requested ends the run in
/// progress and the study, which the next call continues.
///
/// Errors  Error(ExitCode::usage) for mistakes in the study, nothing was written; plugin; file
StudyResult run_study(const StudyRequest& request, const StudyProgress::Options& progress,
                      std::ostream& messages, std::ostream& out,
                      const PointRunner& run = run_process);

}  // namespace pileus::study
