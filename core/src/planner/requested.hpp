// What the scene itself says about effects: by name, or by asking for what only they bring about.
#pragma once
#include <string>
#include <vector>

#include "planner/plan.hpp"
#include "scene/scene.hpp"

namespace pileus::planner {

/// Errors  Error(ExitCode::usage) for a request of an effect that is not among `known`
void check_requests(const scene::EffectRequests& requests, const std::vector<std::string>& known);

/// Switches an effect on if the scene wants to see its diagnostics or quantities, or those of an
/// effect that cannot happen without it.
void call_for_requested_output(const scene::Scene& scene,
                               const std::vector<ListedOperator>& operators, const Rules& rules,
                               EffectPlan& effect);

/// Replaces the verdict by the one the scene demands.
/// Errors  Error(ExitCode::usage) if an effect is demanded that no operator provides, or without
///         one that it needs; `plan` holds those judged before
void obey_request(const scene::EffectRequests& requests, const Plan& plan, EffectPlan& effect);

/// Effects forced off whose operator stays for others and has nothing that it could leave out with
/// them: those that a list does not name stay on, those named are refused. True if any stay.
/// Errors  Error(ExitCode::usage) for what would not come true
bool keep_inseparable(const scene::EffectRequests& requests,
                      const std::vector<ListedOperator>& operators, Plan& plan);

}  // namespace pileus::planner
