#include "study/outcome.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>

#include "base/error.hpp"
#include "output/posix_file.hpp"

namespace pileus::study {

using Json = nlohmann::ordered_json;

namespace {

/// Phases of summary.json that are no part of a time step.
bool is_beside_steps(std::string_view phase) {
  return phase == "diagnostics" || phase == "output";
}

double number_in(const Json& json, const char* name) {
  const auto entry = json.find(name);
  return entry != json.end() && entry->is_number() ? entry->get<double>()
                                                   : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

std::string date_now() {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
}

RunOutcome outcome_of_run(const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "summary.json";
  try {
    std::ifstream file(path);
    const Json summary = Json::parse(file);
    RunOutcome outcome;
    outcome.date = date_now();
    outcome.commit = summary.at("commit").get<std::string>();
    outcome.steps = summary.at("steps").get<double>();
    outcome.parcels = number_in(summary.at("parcels"), "mean");
    outcome.total_wall = number_in(summary, "wall_s");
    outcome.core_time =
        number_in(summary, "ns_per_parcel_step") * 1e-9 * outcome.parcels * outcome.steps;
    outcome.wall_time = 0;
    for (const auto& [name, phase] : summary.at("phases").items())
      if (!is_beside_steps(name)) outcome.wall_time += phase.at("seconds").get<double>();
    return outcome;
  } catch (const Json::exception& problem) {
    throw Error(ExitCode::file,
                fmt::format("{}: cannot be read: {}", path.string(), problem.what()));
  }
}

std::optional<RunOutcome> load_outcome(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) return std::nullopt;
  try {
    const Json json = Json::parse(file);
    RunOutcome outcome;
    outcome.key = json.at("key").get<std::string>();
    outcome.failure = json.at("failure").get<std::string>();
    outcome.commit = json.at("commit").get<std::string>();
    outcome.date = json.at("date").get<std::string>();
    outcome.core_time = number_in(json, "core_time");
    outcome.wall_time = number_in(json, "wall_time");
    outcome.total_wall = number_in(json, "total_wall");
    outcome.parcels = number_in(json, "parcels");
    outcome.steps = number_in(json, "steps");
    outcome.numbers = json.at("numbers").get<std::map<std::string, double>>();
    return outcome;
  } catch (const Json::exception&) {
    return std::nullopt;
  }
}

void save_outcome(const std::filesystem::path& path, const RunOutcome& outcome) {
  const Json json = {{"key", outcome.key},
                     {"failure", outcome.failure},
                     {"commit", outcome.commit},
                     {"date", outcome.date},
                     {"core_time", outcome.core_time},
                     {"wall_time", outcome.wall_time},
                     {"total_wall", outcome.total_wall},
                     {"parcels", outcome.parcels},
                     {"steps", outcome.steps},
                     {"numbers", outcome.numbers}};
  output::replace_file(path, json.dump(2) + "\n");
}

}  // namespace pileus::study
