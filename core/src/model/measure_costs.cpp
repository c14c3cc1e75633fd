#include "model/measure_costs.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <ctime>
#include <filesystem>
#include <optional>

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

enum class Parts { operators, operators_and_core };

/// Takes some steps of the scene and adds what its parts cost.
void measure(const std::string& scene_path, const std::vector<std::string>& overrides, Parts parts,
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
  if (parts == Parts::operators) return;
  cost.seconds = core;
  costs.set(planner::core_part(scene), cost);
}

/// An override that switches on every effect an operator of the scene provides, whatever the scene
/// says; nothing if the plan leaves none of them out.
std::optional<std::string> everything_on(const planner::Plan& plan) {
  std::vector<std::string> requests;
  bool any_left_out = false;
  for (const planner::EffectPlan& effect : plan.effects) {
    if (effect.providers.empty()) continue;
    requests.push_back(effect.effect + ": on");
    any_left_out = any_left_out || effect.verdict != planner::Verdict::on;
  }
  if (!any_left_out) return std::nullopt;
  return fmt::format("effects={{{}}}", fmt::join(requests, ", "));
}

}  // namespace

void measure_costs(const std::string& scene_path, const std::vector<std::string>& overrides,
                   Progress& progress) {
  const fs::path file = planner::Costs::default_path();
  if (file.empty())
    throw Error(ExitCode::file,
                "There is no place to keep costs: neither XDG_CACHE_HOME nor HOME is set.");
  planner::Costs costs = planner::Costs::read(file);
  const auto keep = [&] {
    fs::create_directories(file.parent_path());
    output::replace_file(file, costs.text());
  };
  measure(scene_path, overrides, Parts::operators_and_core, progress, costs);
  keep();
  const auto all = everything_on(plan_scene(scene_path, overrides));
  if (!all) return;
  std::vector<std::string> with_everything = overrides;
  with_everything.push_back(*all);
  try {
    measure(scene_path, with_everything, Parts::operators, progress, costs);
  } catch (const Error&) {  // the scene does without something for a reason: its price is not known
    return;
  }
  keep();
}

}  // namespace pileus::model
