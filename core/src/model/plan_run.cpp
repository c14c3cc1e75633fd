#include "model/plan_run.hpp"

#include <algorithm>
#include <filesystem>
#include <set>

#include "base/error.hpp"
#include "coupling/quantity_plan.hpp"
#include "dynamics/runge_kutta.hpp"
#include "host/search.hpp"
#include "model/slab_series.hpp"
#include "parcels/store.hpp"
#include "planner/costs.hpp"
#include "planner/survey.hpp"
#include "scene/read_scene.hpp"

namespace pileus::model {
namespace {

namespace fs = std::filesystem;

std::shared_ptr<const planner::Rules> rules_for(
    const std::vector<coupling::OperatorEntry>& operators) {
  auto rules = std::make_shared<planner::Rules>(planner::built_in_rules());
  std::set<std::string> read;
  for (const coupling::OperatorEntry& entry : operators) {
    const std::string path =
        fs::path(entry.table->library).replace_extension(".effects.yaml").string();
    std::error_code ignored;
    if (fs::is_regular_file(path, ignored) && read.insert(path).second)
      planner::add_rules_of_file(*rules, path);
  }
  return rules;
}

std::vector<planner::ListedOperator> listed(const std::vector<coupling::OperatorEntry>& operators) {
  std::vector<planner::ListedOperator> list;
  for (const coupling::OperatorEntry& entry : operators)
    list.push_back({entry.name, entry.table, &entry.values});
  return list;
}

coupling::EffectState state_of(planner::Verdict verdict) {
  switch (verdict) {
    case planner::Verdict::off:
      return coupling::EffectState::off;
    case planner::Verdict::watch:
      return coupling::EffectState::watched;
    case planner::Verdict::on:
      break;
  }
  return coupling::EffectState::on;
}

/// Tells every operator which of its effects are on, and removes those with nothing to do.
std::vector<coupling::OperatorEntry> keep_called_for(
    const planner::Plan& plan, std::vector<coupling::OperatorEntry> operators) {
  std::vector<coupling::OperatorEntry> kept;
  for (std::size_t i = 0; i < operators.size(); ++i) {
    if (!plan.operators[i].present) continue;
    coupling::OperatorEntry& entry = operators[i];
    for (const pileus_effect& effect : entry.table->effects) {
      const planner::EffectPlan* judged =
          effect.role == PILEUS_PROVIDES ? plan.find(effect.name) : nullptr;
      entry.effects.push_back(judged != nullptr ? state_of(judged->verdict)
                                                : coupling::EffectState::on);
    }
    kept.push_back(std::move(entry));
  }
  return kept;
}

std::vector<std::string> initial_names(const scene::Scene& scene) {
  std::vector<std::string> names;
  for (const auto& [name, field] : scene.initial.scalars) names.push_back(name);
  return names;
}

/// Who declares a quantity: the operator that owns it, or the initial state.
std::string origin_of(const std::string& name,
                      const std::vector<coupling::OperatorEntry>& operators) {
  for (const coupling::OperatorEntry& entry : operators)
    for (const pileus_quantity& row : entry.table->quantities)
      if (name == row.name && (row.access & PILEUS_CREATE) != 0) return entry.name;
  return "initial state";
}

/// A store without parcels, of the quantities that these operators and the initial state bring.
parcels::Store store_of(const scene::Scene& scene,
                        const std::vector<coupling::OperatorEntry>& operators) {
  return parcels::Store(scene.domain.dimension,
                        coupling::plan_quantities(operators, initial_names(scene)).scalars);
}

/// Numbers of a parcel if all of these operators were there with all their effects; 0 where they
/// contradict each other.
int columns_of(const scene::Scene& scene, const std::vector<coupling::OperatorEntry>& operators) {
  try {
    return store_of(scene, operators).column_count();
  } catch (const Error&) {
    return 0;
  }
}

planner::DataFlow flow_of(const scene::Scene& scene,
                          const std::vector<coupling::OperatorEntry>& operators) {
  planner::DataFlow flow;
  const parcels::Store store = store_of(scene, operators);
  for (int c = 0; c < store.column_count(); ++c) {
    const int scalar = c - store.first_scalar();
    const std::string name = store.column_name(c);
    flow.stored.push_back(
        {name, scalar >= 0 ? store.scalars()[static_cast<std::size_t>(scalar)].units : "",
         scalar >= 0 ? origin_of(name, operators) : "parcels"});
  }
  const parcels::ItemDeclaration items =
      coupling::plan_quantities(operators, initial_names(scene)).items;
  const auto add_item = [&](const std::string& name, const std::string& units) {
    flow.items.push_back({name, units, origin_of(name, operators)});
  };
  if (!items.multiplicity.empty()) add_item(items.multiplicity, "1");
  for (const parcels::ItemColumn& column : items.columns) add_item(column.name, column.units);
  const bool three = scene.domain.dimension == 3;
  flow.transformed = three ? std::vector<std::string>{"x_vorticity", "y_vorticity", "z_vorticity"}
                           : std::vector<std::string>{"vorticity"};
  flow.deposited = {"volume"};
  flow.deposited.insert(flow.deposited.end(), flow.transformed.begin(), flow.transformed.end());
  flow.deposited.emplace_back("buoyancy");
  flow.recovered = {"velocity", "velocity gradient"};
  flow.stages = scene.time.scheme == scene::RungeKutta::order4_stages5
                    ? static_cast<int>(dynamics::carpenter_kennedy_4().stages())
                    : static_cast<int>(dynamics::williamson_3().stages());
  flow.parcels = static_cast<std::uint64_t>(scene.parcels.per_cell);
  for (const int n : scene.domain.cells) flow.parcels *= static_cast<std::uint64_t>(n);
  flow.bytes_per_parcel = 8.0 * static_cast<double>(store.column_count()) + sizeof(std::uint64_t);
  flow.cost_source = "no costs have been measured";
  return flow;
}

}  // namespace

PlannedRun plan_run(const scene::Scene& scene, std::vector<coupling::OperatorEntry> operators) {
  PlannedRun run;
  run.plan = planner::make_plan(scene, listed(operators), rules_for(operators),
                                planner::survey_initial_state(scene));
  const int all_columns = columns_of(scene, operators);
  run.operators = keep_called_for(run.plan, std::move(operators));
  SlabSeries::check(scene, store_of(scene, run.operators));
  run.plan.flow = flow_of(scene, run.operators);
  run.plan.flow.bytes_left_out =
      8.0 * std::max(0, all_columns - static_cast<int>(run.plan.flow.stored.size()));
  return run;
}

planner::Plan plan_scene(const std::string& path, const std::vector<std::string>& overrides) {
  scene::Problems problems;
  const scene::Scene scene = scene::read_scene(path, overrides, problems);
  auto operators = coupling::load_operators(
      scene, host::default_search_path(fs::path(path).parent_path()), problems);
  problems.throw_if_any();
  planner::Plan plan = plan_run(scene, std::move(operators)).plan;
  planner::predict_time(scene, planner::Costs::read(planner::Costs::default_path()), plan);
  return plan;
}

}  // namespace pileus::model
