// Operators that only declare: what the planner sees of a plugin.
#pragma once
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "host/operator_table.hpp"
#include "host/parameter_values.hpp"
#include "pileus/plugin.hpp"
#include "planner/plan.hpp"
#include "scene/read_scene.hpp"

namespace pileus::test {

inline void introduce(Declaration& d, const char* id) {
  d.op.id = id;
  d.op.kind = "test";
  d.op.version = "1.0.0";
  d.op.title = d.op.summary = d.op.authors = "test";
  d.op.licence = "MIT";
}

/// The air of the rules, with their parameter names.
inline void describe_air(Declaration& d) {
  d.number("base_height", "m", 0);
  d.number("gravity", "m s-2", 9.81);
  d.number("heat_capacity", "J kg-1 K-1", 1005);
  d.number("gas_constant_dry_air", "J kg-1 K-1", 287.04);
  d.number("epsilon", "1", 0.622);
  d.number("surface_pressure", "Pa", 1e5);
  d.numbers("reference_height", "m", 0);
  d.numbers("reference_potential_temperature", "K", 300);
}

/// Condensation and buoyancy, ideal or real, with the parameter names of the rules.
class MoistAir : public Operator<MoistAir> {
 public:
  void describe(Declaration& d) {
    introduce(d, "test.moist_air");
    d.op.form = PILEUS_CLOSURE;
    d.provides("condensation");
    d.provides("buoyancy");
    d.choice("thermodynamics", {"ideal", "real"});
    d.number("surface_humidity", "1", 0.015);
    d.number("scale_height", "m", 1000);
    describe_air(d);
    d.reads("total_water_mass_fraction", "1").intensive();
    d.derives("buoyancy", "m s-2");
    d.derives("mass_fraction_of_cloud_liquid_water_in_air", "1").when("effect.condensation == on");
  }
  void diagnose(const pileus_step&, Block) const {}
};

/// Clouds whose drops are carried: what a scheme with rates declares.
class Clouds : public Operator<Clouds> {
 public:
  void describe(Declaration& d) {
    introduce(d, "test.clouds");
    d.op.form = PILEUS_FLOW;
    d.choice("temperature", {"prognostic", "reference_profile"});
    d.choice("collection", {"none", "some"});
    d.choice("saturation_pressure",
             {"bolton", "tetens", "magnus", "buck", "murphy_koop", "wexler"});
    describe_air(d);
    d.provides("condensation");
    d.provides("activation");
    d.provides("collection", "collection != none");
    d.updates("air_potential_temperature", "K").intensive();
    d.updates("specific_humidity", "1").intensive();
    d.owns("mass_fraction_of_cloud_liquid_water_in_air", "1")
        .intensive()
        .when("effect.condensation == on");
    d.owns("number_of_cloud_droplets_per_mass_of_air", "kg-1")
        .intensive()
        .when("effect.condensation == on");
    for (const char* name : {"mass_fraction_of_rain_in_air", "number_of_raindrops_per_mass_of_air"})
      d.owns(name, name[0] == 'm' ? "1" : "kg-1")
          .intensive()
          .when("collection != none and effect.collection == on");
  }
  void apply(const pileus_step&, Block) const {}
};

/// Lets rain fall that others make.
class Fall : public Operator<Fall> {
 public:
  void describe(Declaration& d) {
    introduce(d, "test.fall");
    d.op.form = PILEUS_FLOW;
    d.op.scope = PILEUS_GLOBAL;
    d.provides("sedimentation");
    d.updates("mass_fraction_of_rain_in_air", "1").intensive();
    d.accumulates("rainfall_amount", "kg m-2");
  }
  void apply(const pileus_step&, Block) const {}
};

/// Mixes, by default without a profile.
class Mixer : public Operator<Mixer> {
 public:
  void describe(Declaration& d) {
    introduce(d, "test.mixer");
    d.op.form = PILEUS_FLOW;
    d.number("rate", "1", 1);
    d.numbers("reference_potential_temperature", "K", 0);
    d.provides("small_scale_mixing");
    d.updates("air_potential_temperature", "K").intensive();
    d.updates("specific_humidity", "1").intensive();
  }
  void apply(const pileus_step&, Block) const {}
};

/// Changes total water in a way no rule knows.
class WaterSource : public Operator<WaterSource> {
 public:
  void describe(Declaration& d) {
    introduce(d, "test.water_source");
    d.op.form = PILEUS_FLOW;
    d.provides("irrigation");
    d.updates("total_water_mass_fraction", "1").intensive();
  }
  void apply(const pileus_step&, Block) const {}
};

struct Loaded {
  std::shared_ptr<const host::OperatorTable> table;
  host::ParameterValues values;
};

template <class Op>
Loaded load() {
  std::vector<std::string> complaints;
  auto table = std::make_shared<host::OperatorTable>(host::read_operator(Op::table(), complaints));
  if (!complaints.empty()) throw std::logic_error(complaints.front());
  host::ParameterValues values(*table);
  return {std::move(table), std::move(values)};
}

/// A box of 4 km with total water 0.004 to 0.005.
inline scene::Scene wet_scene(const std::string& more = "") {
  scene::Problems problems;
  scene::Scene scene =
      scene::read_scene_text("wet.yaml",
                             "domain: {extent: [1000 m, 2000 m], cells: [4, 8]}\n"
                             "time: {end: 60 s}\n"
                             "initial:\n"
                             "  total_water_mass_fraction: 0.004 + 1e-3*(z > 1000)\n"
                             "  liquid_water_buoyancy: 0\n" +
                                 more,
                             {}, problems);
  problems.throw_if_any();
  return scene;
}

/// A box of 500 m with air of 290 to 291 K and a humidity of 0.004 to 0.005: it saturates at
/// 0.0096.
inline scene::Scene humid_scene(const std::string& initial = "", const std::string& more = "") {
  scene::Problems problems;
  scene::Scene scene = scene::read_scene_text("humid.yaml",
                                              "domain: {extent: [1000 m, 500 m], cells: [4, 8]}\n"
                                              "time: {end: 60 s}\n"
                                              "initial:\n"
                                              "  specific_humidity: 0.004 + 1e-3*(z > 300)\n"
                                              "  air_potential_temperature: 290 + (z > 200)\n" +
                                                  initial + more,
                                              {}, problems);
  problems.throw_if_any();
  return scene;
}

inline planner::Plan plan_of(const scene::Scene& scene, const std::vector<const Loaded*>& loaded) {
  std::vector<planner::ListedOperator> operators;
  for (const Loaded* one : loaded)
    operators.push_back({"op" + std::to_string(operators.size()), one->table, &one->values});
  return planner::make_plan(scene, operators,
                            std::make_shared<planner::Rules>(planner::built_in_rules()),
                            planner::survey_initial_state(scene));
}

}  // namespace pileus::test
