// What one run of a study left behind: whether it ended well, and what it cost.
#pragma once
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>

namespace pileus::study {

struct RunOutcome {
  std::string key;      // of the planned run
  std::string failure;  // empty: the run reached its end
  std::string commit, date;
  double core_time = std::numeric_limits<double>::quiet_NaN();  // s, of the time steps alone
  double wall_time = std::numeric_limits<double>::quiet_NaN();  // s, likewise
  double total_wall = 0;                                        // s, of the process
  double parcels = 0, steps = 0;                                // mean number of parcels; steps
  std::map<std::string, double> numbers;                        // measured by the experiment itself

  double parcel_steps() const { return parcels * steps; }
};

/// From the summary.json of a finished run. Throws Error(file) when it cannot be read.
RunOutcome outcome_of_run(const std::filesystem::path& folder);

/// The outcome kept in a file; nothing when there is none or it is damaged.
std::optional<RunOutcome> load_outcome(const std::filesystem::path& path);
/// Replaces the file atomically. Throws Error(file).
void save_outcome(const std::filesystem::path& path, const RunOutcome& outcome);

/// The date and time now, in UTC.
std::string date_now();

}  // namespace pileus::study
