// pileus plan SCENE: which effects a scene calls for, and why.
#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "base/nearest_word.hpp"
#include "base/progress.hpp"
#include "model/measure_costs.hpp"
#include "model/plan_run.hpp"
#include "planner/plan_text.hpp"
#include "verb.hpp"

namespace pileus::cli {
namespace {

struct PlanRequest {
  std::string scene, why, other;
  std::vector<std::string> overrides;
  bool as_json = false, measure = false;
};

ExitCode plan(const PlanRequest& request) {
  if (request.measure) {
    SilentProgress progress;
    model::measure_costs(request.scene, request.overrides, progress);
  }
  const planner::Plan plan = model::plan_scene(request.scene, request.overrides);
  if (!request.other.empty()) {
    std::cout << planner::compare_plans(plan, model::plan_scene(request.other, {}));
  } else if (!request.why.empty()) {
    const planner::EffectPlan* effect = plan.find(request.why);
    if (effect == nullptr) {
      std::vector<std::string> names;
      for (const auto& one : plan.effects) names.push_back(one.effect);
      const std::string nearest = nearest_word(request.why, names);
      throw Error(ExitCode::usage,
                  fmt::format("--why: unknown effect '{}'; {}", request.why,
                              nearest.empty() ? "the plan lists them all"
                                              : "did you mean '" + nearest + "'?"));
    }
    std::cout << planner::explain_effect(plan, *effect);
  } else {
    std::cout << (request.as_json ? planner::plan_json(plan) : planner::plan_page(plan));
  }
  return ExitCode::done;
}

}  // namespace

void add_plan(CLI::App& app, Action& action) {
  CLI::App* verb = app.add_subcommand("plan", "Show which effects a scene calls for, and why");
  auto request = std::make_shared<PlanRequest>();
  verb->add_option("scene", request->scene, "YAML file of the scene")
      ->required()
      ->type_name("SCENE");
  auto* why = verb->add_option("--why", request->why,
                               "Rule and numbers of one effect, and what would change its verdict")
                  ->type_name("EFFECT");
  auto* diff = verb->add_option("--diff", request->other, "Show what another scene has otherwise")
                   ->type_name("OTHER");
  auto* json = verb->add_flag("--json", request->as_json, "For programs");
  verb->add_flag("--measure", request->measure,
                 "First measure costs: run a few steps and keep what they took in "
                 "~/.cache/pileus");
  why->excludes(diff)->excludes(json);
  diff->excludes(json);
  verb->add_option("--set", request->overrides, "Replace a value of the scene; repeatable")
      ->type_name("KEY=VALUE")
      ->expected(1)
      ->take_all();
  verb->callback([&action, request] { action = [request] { return plan(*request); }; });
}

}  // namespace pileus::cli
