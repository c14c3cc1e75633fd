// A plan for people and for programs.
#pragma once
#include <string>

#include "planner/plan.hpp"

namespace pileus::planner {

/// The page of `pileus plan`: several lines of at most 100 columns where names allow it.
std::string plan_page(const Plan& plan);
/// Rule, numbers and what would change the verdict of one effect.
std::string explain_effect(const Plan& plan, const EffectPlan& effect);
/// What a second plan has otherwise than the first.
std::string compare_plans(const Plan& first, const Plan& second);
/// The same content for programs: plan.json.
std::string plan_json(const Plan& plan);
/// The reason with who provides the effect, one line.
std::string reason_line(const Plan& plan, const EffectPlan& effect);

}  // namespace pileus::planner
