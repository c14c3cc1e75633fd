#include "study/member_results.hpp"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "output/read_fields.hpp"

namespace pileus::study {

namespace fs = std::filesystem;

namespace {

/// Streams that members may have; the first is that of every run.
constexpr const char *series_file = "series.nc", *profiles_file = "profiles.nc";

std::string stream_problem(const fs::path& path) {
  if (!fs::exists(path)) return fmt::format("{} is missing", path.string());
  try {
    const output::ResultsFile file(path);
    for (const output::StoredVariable& variable : file.variables()) file.read(variable.name);
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

}  // namespace

std::string results_problem(const fs::path& sweep, const Member& member) {
  const fs::path folder = member_folder(sweep, member.index);
  const fs::path summary = folder / "summary.json";
  std::ifstream text(summary);
  if (!text) return fmt::format("{} is missing", summary.string());
  if (!nlohmann::json::parse(text, nullptr, false).is_object())
    return fmt::format("{} is damaged", summary.string());
  std::string problem = stream_problem(folder / series_file);
  if (problem.empty() && member.profiles_every > 0)
    problem = stream_problem(folder / profiles_file);
  return problem;
}

std::vector<MemberRecord> load_records(const fs::path& sweep, const Ensemble& ensemble,
                                       std::vector<std::string>& problems) {
  std::vector<MemberRecord> records;
  for (const Member& member : ensemble.members) {
    MemberRecord record = member.key.empty() ? MemberRecord() : load_record(sweep, member);
    if (record.status == MemberRecord::Status::done) {
      const std::string problem = results_problem(sweep, member);
      if (!problem.empty()) {
        problems.push_back(
            fmt::format("member {} counts as not done: {}", index_text(member.index), problem));
        record = MemberRecord();
      }
    }
    records.push_back(std::move(record));
  }
  return records;
}

}  // namespace pileus::study
