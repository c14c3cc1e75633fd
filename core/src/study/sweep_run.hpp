// A sweep from its file to its members' results and what is collected from them.
#pragma once
#include <filesystem>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "study/point_process.hpp"
#include "study/sweep_progress.hpp"
#include "study/sweep_record.hpp"

namespace pileus::study {

struct SweepRequest {
  std::string path;
  std::string directory;              // empty: results/sweeps/<name>
  int jobs = 0;                       // members at a time; 0: as many as there are cores for
  int threads = 0;                    // of a member; 0: as the sweep says
  std::optional<std::size_t> member;  // run this one only, and collect nothing
  bool retry = false;                 // run failed members again, from their start
  bool force = false;                 // run all members again
  bool collect_only = false;          // run nothing
  bool copy = false;                  // copy series into ensemble.nc, do not refer to them
  bool draw = true;
};

struct SweepResult {
  Ensemble ensemble;
  std::vector<MemberRecord> records;  // by member
  std::filesystem::path directory;
  bool stopped = false;
  std::vector<std::string> in_use;  // why members were left alone: other processes run them
  /// done, stopped, or the largest exit code of a member.
  ExitCode code() const;
};

/// Reads a sweep and its members; throws Error(usage) with everything that is wrong.
Ensemble read_ensemble(const std::string& path, const Scrutiny& scrutiny = {});

/// Where a sweep's results go.
std::filesystem::path sweep_folder(const SweepRequest& request, const Sweep& sweep);

/// Runs the members that earlier calls have not finished, a few at a time and each in a process of
/// its own, then collects. A member that fails is reported at the end and does not end the sweep;
/// members that were interrupted go on from their checkpoints. A stop that is requested is passed
/// on to the members, which the next call continues.
///
/// Errors  Error(ExitCode::usage) for mistakes in the sweep or the scene of a member, nothing was
///         written; plugin; file
SweepResult run_sweep(const SweepRequest& request, const SweepProgress::Options& progress,
                      std::ostream& messages, std::ostream& out,
                      const PointRunner& run = run_process);

}  // namespace pileus::study
