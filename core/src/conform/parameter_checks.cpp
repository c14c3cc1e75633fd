// C08: every bound and every choice of every parameter is accepted by the plugin; what lies just
// outside is refused by the core.
#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "conform/subject.hpp"
#include "conform/world.hpp"
#include "coupling/parameters.hpp"

namespace pileus::conform {
namespace {

/// Sets the choices, switches and numbers under which a parameter means something.
void satisfy(const host::OperatorTable& table, std::size_t parameter,
             host::ParameterValues& values) {
  for (const host::WhenTerm& term : table.parameter_when[parameter]) {
    if (term.is_effect) continue;
    const pileus_parameter& other = table.parameters[term.index];
    const int index = static_cast<int>(term.index);
    satisfy(table, term.index, values);
    if (other.type == PILEUS_CHOICE) {
      const int wanted = static_cast<int>(term.value);
      const int chosen = term.equal ? wanted : wanted == 0 ? 1 : 0;
      values.set_choice(index, chosen, other.choices[chosen]);
    } else if (other.type == PILEUS_SWITCH) {
      values.set_number(index, term.equal ? term.value : 1 - term.value);
    } else {
      const bool low = other.low < other.high;
      values.set_number(index, term.equal ? term.value : low ? other.high : term.value + 1);
    }
  }
}

void set_value(const pileus_parameter& p, int index, double x, host::ParameterValues& values) {
  if (p.type == PILEUS_NUMBERS) return values.set_list(index, {x});
  if (p.type == PILEUS_PROFILE || p.type == PILEUS_SERIES) return values.set_list(index, {0.0, x});
  values.set_number(index, x);
}

void expect_accepted(const Case& c, const World& world, const host::ParameterValues& values,
                     const std::string& what) {
  try {
    const Subject subject(*c.table, values, world.lent());
  } catch (const Subject::Refused& refused) {
    fail(fmt::format("{} lies within what it declares, but {} {}", what, refused.phase,
                     refused.outcome.describe()));
  }
}

/// The block of a scene with one parameter, as the core reads it.
void expect_refused(const Case& c, const pileus_parameter& p, double x) {
  scene::OperatorBlock block;
  block.use = c.op().id;
  block.parameters.emplace_back(p.name,
                                scene::RawValue{fmt::format("{:.17g}", x), false, {}, {}, {}, {}});
  scene::Problems problems;
  coupling::read_parameters(block, *c.table, scene::Scene{}, problems);
  if (problems.empty())
    fail(fmt::format("{} = {:.17g} lies outside of [{:g}, {:g}], but the core takes it", p.name, x,
                     p.low, p.high));
}

void check_choices(const Case& c, const World& world, std::size_t i) {
  const pileus_parameter& p = c.table->parameters[i];
  for (int k = 0; p.choices[k] != nullptr; ++k) {
    host::ParameterValues values(*c.table);
    satisfy(*c.table, i, values);
    values.set_choice(static_cast<int>(i), k, p.choices[k]);
    expect_accepted(c, world, values, fmt::format("{} = {}", p.name, p.choices[k]));
  }
}

void check_number(const Case& c, const World& world, std::size_t i) {
  const pileus_parameter& p = c.table->parameters[i];
  const bool is_switch = p.type == PILEUS_SWITCH;
  if (!is_switch && !(p.low < p.high)) return;
  for (const double x : {is_switch ? 0.0 : p.low, is_switch ? 1.0 : p.high}) {
    host::ParameterValues values(*c.table);
    satisfy(*c.table, i, values);
    set_value(p, static_cast<int>(i), x, values);
    expect_accepted(c, world, values, fmt::format("{} = {:g}", p.name, x));
  }
  if (is_switch) return;
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const bool whole = p.type == PILEUS_INTEGER;
  const double below = whole ? p.low - 1 : std::nextafter(p.low, -infinity);
  const double above = whole ? p.high + 1 : std::nextafter(p.high, infinity);
  if (std::isfinite(below) && std::abs(below) < 1e300 && below != p.low)
    expect_refused(c, p, below);
  if (std::isfinite(above) && std::abs(above) < 1e300 && above != p.high)
    expect_refused(c, p, above);
}

}  // namespace

std::string check_parameter_bounds(const Case& c) {
  if (c.table->parameters.empty()) throw NotApplicable{"it has no parameters"};
  const World world(c, host::ParameterValues(*c.table),
                    c.seed);  // lends what configure may ask for
  for (std::size_t i = 0; i < c.table->parameters.size(); ++i) {
    if (c.table->parameters[i].type == PILEUS_TEXT) continue;
    if (c.table->parameters[i].type == PILEUS_CHOICE) {
      check_choices(c, world, i);
    } else {
      check_number(c, world, i);
    }
  }
  return {};
}

}  // namespace pileus::conform
