// Runs the checks C01 to C27 on the operators of a plugin library, each in a process of its own.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace pileus::conform {

struct Request {
  std::filesystem::path library;
  std::vector<std::string> only;  // ids of checks; empty: all
  std::uint64_t seed = 1;         // of the first random state
  double time_limit = 60;         // s of processor time, of one check
};

enum class Verdict { passed, failed, not_applicable };

struct Result {
  std::string check, title;
  std::string operator_id;  // empty: of the library
  Verdict verdict = Verdict::passed;
  std::string text;        // why, or a remark
  std::uint64_t seed = 0;  // of the random state that shows a failure, 0: none
  std::uint64_t uid = 0;   // of the parcel that shows it, 0: none
};

struct Report {
  std::string library;
  std::vector<Result> results;
  std::size_t count(Verdict verdict) const;
};

/// Errors  Error(ExitCode::usage) for a check of an unknown name; Error(ExitCode::file) when no
///         process can be started
Report conform(const Request& request);

/// A table for people.
std::string render(const Report& report);
/// The same for programs.
std::string render_json(const Report& report, const Request& request);

}  // namespace pileus::conform
