#include "study/run_study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "base/signals.hpp"
#include "output/checkpoint.hpp"
#include "output/run_directory.hpp"
#include "study/measure.hpp"
#include "study/shape_experiment.hpp"
#include "study/study_files.hpp"
#include "study/study_table.hpp"
#include "study/work_precision_picture.hpp"

namespace pileus::study {

namespace fs = std::filesystem;

namespace {

/// Exit codes of runs that would end in the same way again.
bool is_final(int code) {
  return code == static_cast<int>(ExitCode::done) || code == static_cast<int>(ExitCode::usage) ||
         code == static_cast<int>(ExitCode::plugin) ||
         code == static_cast<int>(ExitCode::numerical) || code > 128;
}

std::string slug_of(const std::string& label) {
  std::string slug;
  for (const char c : label) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '-';
    if (plain)
      slug += c;
    else if (!slug.empty() && slug.back() != '_')
      slug += '_';
  }
  return slug.substr(0, 60);
}

/// Where a run's results are; repeats count from 1.
fs::path folder_of(const fs::path& study, const Point& point, const PlannedRun& run, int repeat) {
  return study / "points" / fmt::format("{}-{}", slug_of(point.label), run.key.substr(0, 8)) /
         fmt::format("repeat_{}", repeat);
}

fs::path outcome_path(const fs::path& run_folder) {
  return run_folder.string() + ".json";
}

/// A run that has been made, by this call or an earlier one.
struct Made {
  RunOutcome outcome;
  fs::path folder;
};

class Runs {
 public:
  Runs(const Study& study, const Layout& layout, fs::path directory, StudyProgress& progress,
       const PointRunner& run)
      : study_(study),
        layout_(layout),
        directory_(std::move(directory)),
        progress_(progress),
        run_(run) {}

  /// False when it was stopped. Repeats go round all points, so that a disturbance of the machine
  /// does not fall on one of them.
  bool make_all() {
    struct Open {
      std::size_t point, run;
      int repeat;
    };
    std::vector<Open> open;
    for (int repeat = 1; repeat <= study_.repeats; ++repeat) {
      for (std::size_t p = 0; p < layout_.points.size(); ++p) {
        const Point& point = layout_.points[p];
        if (point.only_reference && repeat > 1) continue;
        for (std::size_t r = 0; r < point.runs.size(); ++r) {
          if (const auto made = find(point, point.runs[r], repeat)) {
            progress_.already_done(p, made->outcome.total_wall);
          } else {
            open.push_back({p, r, repeat});
            progress_.plan(p);
          }
        }
      }
    }
    for (const Open& one : open) {
      if (stop_requested() || !make(one.point, one.run, one.repeat)) return false;
    }
    return true;
  }

  /// The outcome of a run that has reached its end, or fails in the same way each time.
  std::optional<Made> find(const Point& point, const PlannedRun& run, int repeat) const {
    const fs::path folder = folder_of(directory_, point, run, repeat);
    auto outcome = load_outcome(outcome_path(folder));
    if (!outcome || outcome->key != run.key) return std::nullopt;
    return Made{std::move(*outcome), folder};
  }

 private:
  bool make(std::size_t p, std::size_t r, int repeat) {
    const Point& point = layout_.points[p];
    const PlannedRun& run = point.runs[r];
    const fs::path folder = folder_of(directory_, point, run, repeat);
    // Two points with the same scene are one run.
    if (const auto made = find(point, run, repeat)) {
      progress_.begin(p);
      progress_.end("as before", made->outcome.total_wall);
      return true;
    }
    fs::create_directories(folder.parent_path());
    progress_.begin(p);
    const auto started = std::chrono::steady_clock::now();
    RunOutcome outcome;
    if (study_.experiment == Study::Experiment::shape_integrators) {
      outcome = run_shape_experiment(layout_, point);
    } else {
      if (const auto stopped = run_scene(run, folder, outcome)) return !*stopped;
      if (outcome.failure.empty()) measure_once(folder);
    }
    outcome.key = run.key;
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - started;
    if (!outcome.failure.empty()) outcome.total_wall = taken.count();
    save_outcome(outcome_path(folder), outcome);
    progress_.end(outcome.failure.empty()
                      ? "done"
                      : "failed: " + outcome.failure.substr(0, outcome.failure.find('\n')),
                  taken.count());
    return true;
  }

  /// True when the study is to stop; nothing when the run has an outcome.
  std::optional<bool> run_scene(const PlannedRun& run, const fs::path& folder,
                                RunOutcome& outcome) {
    std::ofstream(folder.parent_path() / "scene.yaml") << run.resolved;
    ProcessRequest request{study_.scene_path(), run.overrides, folder, study_.threads, false, {}};
    // Wall times by phase begin anew after a restart, processor times do not.
    request.resume = study_.cost != Cost::wall_time && !output::list_checkpoints(folder).empty();
    const ProcessResult result = run_(request, [this](double share) { progress_.update(share); });
    if (stop_requested() || result.code == static_cast<int>(ExitCode::stopped)) return true;
    if (!is_final(result.code))
      throw Error(ExitCode::file, fmt::format("{}: the run ended with code {}: {}", folder.string(),
                                              result.code, result.words));
    if (result.code != 0) {
      outcome.failure = fmt::format("exit code {}: {}", result.code, result.words);
      outcome.date = date_now();
      return std::nullopt;
    }
    outcome = outcome_of_run(folder);
    for (const auto& entry : fs::directory_iterator(folder))
      if (entry.path().filename().string().starts_with("checkpoint_")) fs::remove(entry.path());
    return std::nullopt;
  }

  /// Names of diagnostics can only be checked when a run has some: with the first, not the last.
  void measure_once(const fs::path& folder) {
    if (measured_) return;
    measure_errors(study_, folder, {});
    measured_ = true;
  }

  const Study& study_;
  const Layout& layout_;
  fs::path directory_;
  StudyProgress& progress_;
  const PointRunner& run_;
  bool measured_ = false;
};

/// The folder of the finest run with the same seed.
fs::path finest_folder(const Layout& layout, const Runs& runs, std::size_t seed) {
  if (!layout.finest) return {};
  const Point& point = layout.points[*layout.finest];
  const auto made = runs.find(point, point.runs[std::min(seed, point.runs.size() - 1)], 1);
  return made && made->outcome.failure.empty() ? made->folder : fs::path();
}

PointResult gather(const Study& study, const Layout& layout, const Point& point, const Runs& runs) {
  PointResult result;
  result.label = point.label;
  result.rungs = point.rungs;
  result.only_reference = point.only_reference;
  result.settings = point.settings;
  std::vector<double> costs, core, wall;
  std::vector<std::vector<double>> errors(study.errors.size());
  for (std::size_t r = 0; r < point.runs.size(); ++r) {
    for (int repeat = 1; repeat <= (point.only_reference ? 1 : study.repeats); ++repeat) {
      const auto made = runs.find(point, point.runs[r], repeat);
      if (!made) continue;
      if (!made->outcome.failure.empty()) {
        if (result.failure.empty()) result.failure = made->outcome.failure;
        continue;
      }
      ++result.runs;
      core.push_back(made->outcome.core_time);
      wall.push_back(made->outcome.wall_time);
      costs.push_back(study.cost == Cost::core_time   ? core.back()
                      : study.cost == Cost::wall_time ? wall.back()
                                                      : made->outcome.parcel_steps());
      result.parcels = made->outcome.parcels;
      result.steps = made->outcome.steps;
      result.commit = made->outcome.commit;
      result.date = std::max(result.date, made->outcome.date);
      if (repeat > 1) continue;  // repeats give the same bits
      const std::vector<double> measured =
          study.experiment == Study::Experiment::shape_integrators
              ? errors_of_numbers(study, made->outcome)
              : measure_errors(study, made->folder, finest_folder(layout, runs, r));
      for (std::size_t n = 0; n < errors.size(); ++n) errors[n].push_back(measured[n]);
    }
  }
  result.cost = median_of(std::move(costs));
  result.core_time = median_of(std::move(core));
  result.wall_time = median_of(std::move(wall));
  for (std::vector<double>& each : errors) result.errors.push_back(mean_of(std::move(each)));
  return result;
}

void draw_pictures(const StudyRequest& request, const Findings& findings, const fs::path& folder) {
  for (std::size_t n = 0; n < findings.study.errors.size(); ++n) {
    const std::string stem =
        fmt::format("{}_{}", findings.study.name, slug_of(findings.study.errors[n].name));
    draw(work_precision_script(findings, n), work_precision_size(findings), folder / stem);
    if (request.pictures.empty()) continue;
    fs::create_directories(request.pictures);
    for (const char* ending : {".svg", ".png"})
      fs::copy_file(folder / (stem + ending), fs::path(request.pictures) / (stem + ending),
                    fs::copy_options::overwrite_existing);
  }
}

void write_files(const StudyRequest& request, const Findings& findings, const fs::path& folder) {
  write_findings_netcdf(folder / "study.nc", findings);
  write_findings_csv(folder / "study.csv", findings);
  write_findings_json(folder / "study.json", findings);
  if (request.keep) {
    const fs::path kept = fs::path(request.path).parent_path() / "results";
    fs::create_directories(kept);
    write_findings_json(kept / (findings.study.name + ".json"), findings);
  }
  if (request.draw) draw_pictures(request, findings, folder);
}

}  // namespace

ExitCode StudyResult::code() const {
  if (stopped) return ExitCode::stopped;
  return std::all_of(verdicts.begin(), verdicts.end(), [](const Verdict& v) { return v.passed; })
             ? ExitCode::done
             : ExitCode::numerical;
}

StudyResult run_study(const StudyRequest& request, const StudyProgress::Options& options,
                      std::ostream& messages, std::ostream& out, const PointRunner& run) {
  scene::Problems problems;
  StudyResult result;
  Findings& findings = result.findings;
  findings.study = read_study(request.path, problems);
  problems.throw_if_any();
  findings.layout = lay_out(findings.study, problems);
  if (findings.study.experiment == Study::Experiment::shape_integrators)
    check_shape_knobs(findings.study, findings.layout, problems);
  problems.throw_if_any();

  result.directory = request.directory.empty()
                         ? fs::path("results") / "studies" / findings.study.name
                         : fs::path(request.directory);
  const output::RunDirectory directory(result.directory, output::RunDirectory::Mode::resume);
  if (request.force) fs::remove_all(directory / "points");
  install_stop_signals();
  StudyProgress progress(messages, options, findings.layout);
  Runs runs(findings.study, findings.layout, result.directory, progress, run);
  if (!runs.make_all()) {
    result.stopped = true;
    progress.message(fmt::format("stopped; the same command continues the study in {}",
                                 result.directory.string()));
    return result;
  }
  for (const Point& point : findings.layout.points)
    findings.points.push_back(gather(findings.study, findings.layout, point, runs));
  result.verdicts = judge(findings);
  out << findings_table(findings, result.verdicts) << std::flush;
  write_files(request, findings, result.directory);
  out << fmt::format("\n{}: study.nc, study.csv, study.json{}\n", result.directory.string(),
                     request.draw ? " and the pictures" : "");
  return result;
}

}  // namespace pileus::study
