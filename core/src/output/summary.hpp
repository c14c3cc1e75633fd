// What a run leaves behind for programs: summary.json at its end, status.json while it runs.
#pragma once
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace pileus::output {

/// "Not available": written as null where the schema allows it.
inline constexpr double not_available = std::numeric_limits<double>::quiet_NaN();

struct PhaseSummary {
  std::string name;
  double seconds = 0;  // wall time
  double share = 0;    // of the time loop
  std::uint64_t calls = 0;
};

struct DiagnosticSummary {
  std::string name, units;
  double initial = not_available, final = not_available;
  double min = not_available, max = not_available, mean = not_available;
  std::optional<double> relative_change;  // (final − initial)/|initial|, of conserved ones
};

/// What calling or skipping parcels amounted to.
struct CallSummary {
  std::uint64_t calls = 0;    // of apply or diagnose, in parcels
  std::uint64_t skipped = 0;  // parcels left out because they were inactive
  double seconds = 0;         // summed over threads
  std::uint64_t retries = 0, repairs = 0;
  double share = 0;  // of the run's wall time on all its threads
  // The skipped parcels by what ruled them out, and those called after all to compare.
  std::uint64_t skipped_by_epoch = 0, skipped_by_bounds = 0, skipped_by_list = 0, audited = 0;
  // At most: what the skipped ones would have cost at the price of the others, s.
  double seconds_saved = 0;

  void add(const CallSummary& other);
};

/// An effect; its calls are those of all operators that provide it.
struct EffectSummary {
  std::string name;
  std::string verdict;  // on, off or watch
  std::string reason;   // one sentence
  CallSummary calls = {};
};

/// What the run did without because effects were off.
struct LeftOutSummary {
  double bytes_per_parcel = 0;
  double seconds = not_available;  // of one core, at measured costs
};

/// The watch over effects that were left out.
struct WatchSummary {
  std::uint64_t checks = 0;
  double seconds = 0;  // wall time
};

struct OperatorSummary {
  std::string name;
  CallSummary calls = {};
};

/// A closed sum: final = initial + sources + defect.
struct BudgetSummary {
  std::string name, units;
  double initial = 0, final = 0, sources = 0, defect = 0;
};

struct ExpectSummary {
  std::string diagnostic, statistic;
  std::optional<double> at;  // s
  double value = not_available;
  std::optional<double> low, high;  // inclusive bounds
  bool passed = false;
  std::string source;               // where the bound comes from
  std::optional<double> from = {};  // s, where the statistic begins; nothing: at the start
};

struct OutputSummary {
  std::string path;     // relative to the folder of the run
  std::string content;  // one line
  std::uint64_t records = 0;
};

struct Summary {
  enum class Status { done, stopped, failed };
  Status status = Status::done;
  std::string message;  // why it stopped or failed
  std::string scene, title;
  int dimension = 3, threads = 1;
  std::uint64_t steps = 0;
  double simulated_time = 0;  // s
  double wall = 0, core = 0;  // s
  std::uint64_t parcels_initial = 0, parcels_final = 0;
  double parcels_mean = 0;
  double ns_per_parcel_step = not_available;
  double bytes_per_parcel = not_available;
  std::uint64_t peak_memory = 0;  // bytes
  std::vector<PhaseSummary> phases;
  std::vector<DiagnosticSummary> diagnostics;
  std::vector<EffectSummary> effects;
  std::vector<OperatorSummary> operators;
  WatchSummary watch;
  LeftOutSummary left_out;
  std::vector<BudgetSummary> budgets;
  std::vector<ExpectSummary> expect;
  std::string state_sha256;
  std::map<std::string, std::uint64_t> seeds;
  std::string version, commit, compiler;
  std::map<std::string, std::string> libraries;  // name → version
  std::string directory;                         // folder of the run
  std::vector<OutputSummary> outputs;
};

struct RunStatus {
  std::string state;  // running, done, stopped or failed
  std::string scene;
  double time = 0, end = 0;  // s, simulated
  std::uint64_t step = 0;
  double dt = 0;  // s
  std::uint64_t parcels = 0;
  double wall = 0;             // s, so far
  double eta = not_available;  // s, to go
  double steps_per_second = not_available, ns_per_parcel_step = not_available;
  long pid = 0;
};

/// The JSON text of schemas/summary.schema.json. Numbers keep every bit; numbers that are not
/// finite become null where the schema allows it, elsewhere std::invalid_argument is thrown.
std::string to_json(const Summary& summary);
/// The JSON text of schemas/status.schema.json; same rules.
std::string to_json(const RunStatus& status);

/// Replaces the file atomically. Throws Error(ExitCode::file).
void write_summary(const std::filesystem::path& path, const Summary& summary);
void write_status(const std::filesystem::path& path, const RunStatus& status);

/// The end of a run for people: time by phase, operators, what was conserved, what was expected,
/// where the results are. Several lines of at most 100 columns.
std::string print_ledger(const Summary& summary);

}  // namespace pileus::output
