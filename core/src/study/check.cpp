#include "study/check.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>

#include "base/terminal.hpp"

namespace pileus::study {

namespace fs = std::filesystem;

namespace {

bool is_yaml(const fs::path& path) {
  return path.extension() == ".yaml" || path.extension() == ".yml";
}

std::vector<fs::path> sorted_entries(const fs::path& folder) {
  std::vector<fs::path> entries;
  for (const auto& entry : fs::directory_iterator(folder)) entries.push_back(entry.path());
  std::sort(entries.begin(), entries.end());
  return entries;
}

/// The scenes directly in a folder; none when it holds no YAML.
std::vector<fs::path> scenes_in(const fs::path& folder) {
  // "scenes/wave/" ends in an empty name.
  const fs::path clean = folder.has_filename() ? folder : folder.parent_path();
  const std::string name = clean.filename().string();
  for (const char* ending : {"_small.yaml", ".yaml"}) {
    if (fs::path variant = clean / (name + ending); fs::is_regular_file(variant)) return {variant};
  }
  std::vector<fs::path> scenes;
  for (fs::path& entry : sorted_entries(clean)) {
    if (fs::is_regular_file(entry) && is_yaml(entry)) scenes.push_back(std::move(entry));
  }
  return scenes;
}

/// A new folder among the temporary files.
fs::path make_temporary_folder() {
  std::string pattern = (fs::temp_directory_path() / "pileus-check-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) {
    throw Error(ExitCode::file, fmt::format("cannot create a temporary folder {}: {}", pattern,
                                            std::strerror(errno)));
  }
  return pattern;
}

std::string describe_bounds(const output::ExpectSummary& expectation) {
  const auto number = [](double value) { return fmt::format("{:.6g}", value); };
  if (expectation.low && expectation.high) {
    return fmt::format("in [{}, {}]", number(*expectation.low), number(*expectation.high));
  }
  if (expectation.low) return ">= " + number(*expectation.low);
  if (expectation.high) return "<= " + number(*expectation.high);
  return "finite";
}

std::string line_of(const output::ExpectSummary& expectation) {
  std::string what = expectation.diagnostic;
  if (!expectation.at || expectation.statistic != "final") what += " " + expectation.statistic;
  if (expectation.from) what += fmt::format(" from {:.6g} s", *expectation.from);
  if (expectation.at)
    what += fmt::format(" {} {:.6g} s", expectation.from ? "to" : "at", *expectation.at);
  std::string line = fmt::format("  {}  {:<44} {:>13.6g}  {}", expectation.passed ? "pass" : "MISS",
                                 what, expectation.value, describe_bounds(expectation));
  if (!expectation.source.empty()) line += "  (" + expectation.source + ")";
  return line;
}

CheckedScene check_scene(const fs::path& scene, const CheckRequest& request,
                         const fs::path& results, Progress& progress, const Runner& run) {
  CheckedScene checked;
  checked.scene = scene;
  model::RunRequest run_request;
  run_request.scene_path = scene.string();
  run_request.overrides = request.overrides;
  run_request.output_directory = (results / scene.stem()).string();
  run_request.threads = request.threads;
  run_request.force = true;  // the folder is ours, or the user names it for this purpose again
  const auto start = std::chrono::steady_clock::now();
  try {
    model::RunResult result = run(run_request, progress);
    checked.directory = result.directory;
    checked.expectations = std::move(result.summary.expect);
    if (result.summary.status == output::Summary::Status::stopped) {
      checked.code = ExitCode::stopped;
      checked.failure = "stopped on request";
    } else if (checked.expectations.empty()) {
      checked.code = ExitCode::numerical;
      checked.failure = "the scene expects nothing; bounds belong in its section 'expect'";
    } else if (!result.expectations_met) {
      checked.code = ExitCode::numerical;
    }
  } catch (const Error& error) {
    checked.code = error.code();
    checked.failure = error.what();
  }
  checked.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return checked;
}

/// Briefly: one line, and one more for every bound that was missed.
void print(const CheckedScene& checked, bool briefly, std::ostream& out) {
  const char* verdict = checked.passed() ? "pass" : "FAIL";
  if (briefly)
    out << fmt::format("{}  {:<36} {:>3} bounds  {}\n", verdict, checked.scene.stem().string(),
                       checked.expectations.size(), format_duration(checked.seconds));
  else
    out << fmt::format("{}  {}  ({})\n", verdict, checked.scene.string(),
                       format_duration(checked.seconds));
  for (const output::ExpectSummary& each : checked.expectations)
    if (!briefly || !each.passed) out << line_of(each) << '\n';
  if (!checked.failure.empty()) out << "  " << checked.failure << '\n';
  out << std::flush;
}

void print_total(const CheckResult& result, std::ostream& out) {
  std::size_t bounds = 0, missed = 0, failed = 0;
  for (const CheckedScene& checked : result.scenes) {
    bounds += checked.expectations.size();
    missed += static_cast<std::size_t>(
        std::count_if(checked.expectations.begin(), checked.expectations.end(),
                      [](const output::ExpectSummary& each) { return !each.passed; }));
    failed += checked.passed() ? 0 : 1;
  }
  double seconds = 0;
  for (const CheckedScene& checked : result.scenes) seconds += checked.seconds;
  out << fmt::format("\n{} scenes, {} passed, {} failed; {} expectations, {} met, {} missed; {}\n",
                     result.scenes.size(), result.scenes.size() - failed, failed, bounds,
                     bounds - missed, missed, format_duration(seconds));
}

}  // namespace

std::vector<fs::path> scenes_of(const fs::path& path) {
  if (!fs::exists(path)) {
    throw Error(ExitCode::usage, fmt::format("{}: there is no such file or folder", path.string()));
  }
  if (!fs::is_directory(path)) return {path};
  std::vector<fs::path> scenes = scenes_in(path);
  if (scenes.empty()) {
    for (const fs::path& entry : sorted_entries(path)) {
      if (!fs::is_directory(entry)) continue;
      for (fs::path& scene : scenes_in(entry)) scenes.push_back(std::move(scene));
    }
  }
  if (scenes.empty()) {
    throw Error(ExitCode::usage, fmt::format("{}: the folder holds no scene", path.string()));
  }
  return scenes;
}

ExitCode CheckResult::code() const {
  for (const CheckedScene& checked : scenes) {
    if (!checked.passed()) return checked.code;
  }
  return ExitCode::done;
}

CheckResult check(const CheckRequest& request, Progress& progress, std::ostream& out,
                  const Runner& run) {
  std::vector<std::pair<fs::path, bool>> scenes;  // and whether one of a folder of several
  for (const std::string& path : request.paths) {
    std::vector<fs::path> found = scenes_of(path);
    for (fs::path& scene : found) scenes.emplace_back(std::move(scene), found.size() > 1);
  }
  const bool is_temporary = request.results_directory.empty();
  const fs::path results =
      is_temporary ? make_temporary_folder() : fs::path(request.results_directory);
  CheckResult result;
  for (const auto& [scene, one_of_several] : scenes) {
    result.scenes.push_back(check_scene(scene, request, results, progress, run));
    print(result.scenes.back(), one_of_several && !request.all_bounds, out);
    if (result.scenes.back().code == ExitCode::stopped) break;
  }
  print_total(result, out);
  if (!is_temporary || result.code() != ExitCode::done) {
    out << fmt::format("results in {}\n", results.string());
  } else {
    std::error_code ignored;  // a leftover among temporary files is no failure of the check
    fs::remove_all(results, ignored);
  }
  return result;
}

}  // namespace pileus::study
