// The smallest change of a scene that changes a verdict.
#include <algorithm>
#include <boost/math/tools/roots.hpp>
#include <cmath>

#include "planner/plan.hpp"

namespace pileus::planner {
namespace {

constexpr double widest = 1000;  // factor by which a number is changed at most

/// Factor on one input that takes the number to its threshold, the one nearest to 1; 0 for none.
double factor_of(RuleNumber& formula, std::vector<double> extrema, std::size_t input) {
  const double own = input < extrema.size() ? extrema[input] : formula.value(input);
  if (own == 0) return 0;
  const auto excess = [&](double log_factor) {
    const double value = own * std::exp(log_factor);
    if (input < extrema.size())
      extrema[input] = value;
    else
      formula.set_parameter(input, value);
    const double number = formula(extrema.data());
    return std::isnan(number) ? HUGE_VAL : number - formula.threshold();
  };
  const double here = excess(0);
  double best = 0;
  for (const double side : {1.0, -1.0}) {
    double inner = 0;
    for (double outer = 0.01; outer < std::log(widest); inner = outer, outer *= 1.5) {
      const double there = excess(side * outer);
      if (!std::isfinite(there) || (there > 0) == (here > 0)) continue;
      const auto root = boost::math::tools::bisect(excess, std::min(side * inner, side * outer),
                                                   std::max(side * inner, side * outer),
                                                   boost::math::tools::eps_tolerance<double>(40));
      const double found = 0.5 * (root.first + root.second);
      if (best == 0 || std::abs(found) < std::abs(best)) best = found;
      break;
    }
  }
  excess(0);  // back to what it was
  return best == 0 ? 0 : std::exp(best);
}

std::string readable(const std::string& name) {
  if (name == "highest_height") return "height of the lid (m)";
  if (name == "lowest_height") return "height of the ground (m)";
  for (const char* start : {"lowest_", "highest_"})
    if (name.starts_with(start))
      return std::string(start, std::char_traits<char>::length(start) - 1) + " initial " +
             name.substr(std::char_traits<char>::length(start));
  return "parameter " + name;
}

}  // namespace

std::vector<Flip> find_flips(const EffectPlan& effect, const std::vector<std::string>& quantities) {
  std::vector<Flip> flips;
  if (!effect.formula) return flips;
  RuleNumber formula = *effect.formula;
  std::vector<double> extrema;
  for (std::size_t i = 0; i < 2 * quantities.size(); ++i) extrema.push_back(formula.value(i));
  for (std::size_t i = 0; i < formula.input_count(); ++i) {
    if (!formula.uses(i)) continue;
    const double from = i < extrema.size() ? extrema[i] : formula.value(i);
    const double factor = factor_of(formula, extrema, i);
    const bool has_partner = i < extrema.size();  // the other end of the same range
    const double partner = has_partner ? extrema[i ^ 1u] : 0;
    if (has_partner && (i % 2 == 0 ? from * factor > partner : from * factor < partner)) continue;
    if (factor > 0) flips.push_back({readable(formula.name(i)), from, from * factor});
  }
  std::sort(flips.begin(), flips.end(), [](const Flip& a, const Flip& b) {
    return std::abs(std::log(a.to / a.from)) < std::abs(std::log(b.to / b.from));
  });
  return flips;
}

}  // namespace pileus::planner
