#include <cmath>
#include <nlohmann/json.hpp>

#include "planner/plan_text.hpp"
#include "scene/problems.hpp"

namespace pileus::planner {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json effect_json(const Plan& plan, const EffectPlan& effect) {
  Json json{{"verdict", word_of(effect.verdict)},
            {"evidence", word_of(effect.evidence)},
            {"reason", effect.reason},
            {"forced", effect.forced},
            {"against_evidence", effect.against_evidence}};
  json["provided_by"] = Json(Json::array());
  for (const std::size_t i : effect.providers)
    json["provided_by"].push_back(plan.operators[i].name);
  if (effect.verdict == Verdict::watch) json["on_trip"] = effect.stop_on_trip ? "stop" : "activate";
  if (effect.number) {
    json["rule"] = scene::describe(effect.rule_case->where);
    json["number"] = number(*effect.number);
    json["threshold"] = effect.rule_case->threshold;
  }
  json["facts"] = Json(Json::array());
  for (const Fact& fact : effect.facts)
    json["facts"].push_back({{"name", fact.name},
                             {"value", number(fact.value)},
                             {"units", fact.unit},
                             {"evidence", word_of(fact.evidence)},
                             {"source", fact.source}});
  json["would_change_it"] = Json(Json::array());
  for (const Flip& flip : effect.flips)
    json["would_change_it"].push_back(
        {{"what", flip.what}, {"from", number(flip.from)}, {"to", number(flip.to)}});
  return json;
}

Json flow_json(const DataFlow& flow) {
  Json json;
  json["stored"] = Json(Json::array());
  for (const auto& one : flow.stored)
    json["stored"].push_back({{"name", one.name}, {"units", one.units}, {"by", one.by}});
  for (const auto& one : flow.items)
    json["items"].push_back({{"name", one.name}, {"units", one.units}, {"by", one.by}});
  json["deposited"] = flow.deposited;
  json["transformed"] = flow.transformed;
  json["recovered"] = flow.recovered;
  json["stages"] = flow.stages;
  json["parcels"] = flow.parcels;
  json["bytes_per_parcel"] = number(flow.bytes_per_parcel);
  json["core_seconds_per_step"] =
      flow.seconds_per_step ? number(*flow.seconds_per_step) : Json(nullptr);
  json["cost_source"] = flow.cost_source;
  json["bytes_left_out_per_parcel"] = number(flow.bytes_left_out);
  json["core_seconds_left_out_per_parcel_step"] =
      flow.seconds_left_out ? number(*flow.seconds_left_out) : Json(nullptr);
  json["steps"] = flow.steps ? Json(*flow.steps) : Json(nullptr);
  return json;
}

}  // namespace

std::string plan_json(const Plan& plan) {
  Json json;
  json["scene"] = plan.scene;
  json["title"] = plan.title;
  json["effects"] = Json(Json::object());
  for (const EffectPlan& effect : plan.effects)
    if (!effect.silent) json["effects"][effect.effect] = effect_json(plan, effect);
  json["operators"] = Json(Json::object());
  for (const OperatorPlan& op : plan.operators)
    json["operators"][op.name] = {{"id", op.id}, {"version", op.version}, {"present", op.present},
                                  {"on", op.on}, {"watched", op.watched}, {"off", op.off}};
  json["data_flow"] = flow_json(plan.flow);
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace pileus::planner
