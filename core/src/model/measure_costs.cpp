#include "model/measure_costs.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <ctime>
#include <filesystem>

#include "base/error.hpp"
#include "base/version.hpp"
#include "model/plan_run.hpp"
#include "model/run.hpp"
#include "output/posix_file.hpp"
#include "planner/costs.hpp"
#include "scene/read_scene.hpp"

namespace pileus::model {
namespace {

namespace fs = std::filesystem;

/// A folder of this process that disappears with the object.
class Scratch {
 public:
  Scratch() : path_(fs::temp_directory_path() / fmt::format("pileus-measure-{}", getpid())) {}
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// Takes some steps of the scene and adds what its parts cost.
void measure(const std::string& scene_path, const std::vector<std::string>& overrides,
             Progress& progress, planner::Costs& costs) {
  const Scratch scratch;
  RunRequest request;
  request.scene_path = scene_path;
  request.overrides = overrides;
  request.overrides.push_back(fmt::format("time.max_steps={}", measured_steps));
  for (const char* stream : {"fields", "parcels", "profiles"})
    request.overrides.push_back(fmt::format("output.{}.every=0 s", stream));
  request.output_directory = scratch.path().string();
  const output::Summary summary = run(request, progress).summary;

  const scene::Scene scene = scene::read_scene(scene_path, overrides);
  const planner::Plan plan = plan_scene(scene_path, overrides);
  const double parcel_steps = summary.parcels_mean * static_cast<double>(summary.steps);
  planner::Cost cost;
  cost.scene = scene.name;
  cost.when = fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::time(nullptr)));
  cost.commit = std::string(build_record().commit);
  double core = summary.ns_per_parcel_step * 1e-9;
  for (const output::OperatorSummary& op : summary.operators)
    for (const planner::OperatorPlan& planned : plan.operators) {
      if (planned.name != op.name) continue;
      cost.seconds = op.calls.seconds / parcel_steps;
      core -= cost.seconds;
      costs.set(operator_part(planned), cost);
    }
  cost.seconds = core;
  costs.set(planner::core_part(scene), cost);
}

/// Overrides that switch on every effect an operator of the scene provides and the plan leaves out.
std::vector<std::string> everything_on(const planner::Plan& plan) {
  std::vector<std::string> overrides;
  for (const planner::EffectPlan& effect : plan.effects)
    if (effect.verdict != planner::Verdict::on && !effect.providers.empty())
      overrides.push_back(fmt::format("effects.{}=on", effect.effect));
  return overrides;
}

}  // namespace

void measure_costs(const std::string& scene_path, const std::vector<std::string>& overrides,
                   Progress& progress) {
  const fs::path file = planner::Costs::default_path();
  if (file.empty())
    throw Error(ExitCode::file,
                "There is no place to keep costs: neither XDG_CACHE_HOME nor HOME is set.");
  planner::Costs costs = planner::Costs::read(file);
  std::vector<std::string> all = everything_on(plan_scene(scene_path, overrides));
  if (!all.empty()) {
    all.insert(all.begin(), overrides.begin(), overrides.end());
    measure(scene_path, all, progress, costs);
  }
  measure(scene_path, overrides, progress, costs);
  fs::create_directories(file.parent_path());
  output::replace_file(file, costs.text());
}

}  // namespace pileus::model
