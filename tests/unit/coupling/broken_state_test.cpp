// Operators that read the mesh meet a state that has broken down before the model notices: they may
// fail, in a sentence, but no value leads them outside the mesh. The others: property/coupling.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "sampled_mesh.hpp"

namespace pileus::testing {
namespace {

struct Subject {
  const char* id;
  Settings settings;
  std::vector<std::string> initial;
};

const Subject subjects[] = {
    {"org.pileus.grid_nudging",
     {{"reference_height", "[0 m, 2 m, 4 m]"}, {"reference_buoyancy", "[0, 1, 3]"}},
     {"buoyancy", "passive_tracer"}},
    {"org.pileus.overlap_exchange", {{"rate", "2"}}, {"passive_tracer"}},
    {"org.pileus.langevin_mixing", {{"smagorinsky", "1"}}, {}},
    {"org.pileus.langevin_mixing",
     {{"intensity", "profile"},
      {"profile_height", "[0 m, 2 m, 4 m]"},
      {"diffusivity", "[0.1 m2/s, 0.2 m2/s, 0.1 m2/s]"}},
     {}},
    {"org.pileus.stochastic_stretching", {{"coefficient", "2"}}, {}},
    {"org.pileus.coherent_displacement", {{"smagorinsky", "1"}}, {}},
    {"org.pileus.dilution", {}, {}},
    {"org.pileus.large_scale_forcing",
     {{"subsidence_velocity", "{height: [0 m, 4 m], value: [0 m/s, -1 m/s]}"},
      {"subsidence_of", "scalars_and_wind"},
      {"wind_nudging_time", "1 s"},
      {"total_water_tendency", "-1e-3 s-1"},
      {"sponge_rate", "1 s-1"},
      {"sponge_of", "vorticity_and_scalars"}},
     {"passive_tracer", "total_water_mass_fraction"}},
};

class BrokenState : public ::testing::TestWithParam<Subject> {};

TEST_P(BrokenState, EndsInASentence) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const mesh::Grid<3> grid({4, 4, 4}, {0, 0, 0}, {4, 4, 4});
  const auto one = [](std::string_view, std::size_t) { return 1.0; };
  for (int c = 0;; ++c) {
    for (const double broken : {std::nan(""), infinity, -infinity, 1e300}) {
      MeshRun<3> run(grid, GetParam().id, GetParam().settings, GetParam().initial, one);
      run.fill(500, 2, 3);
      run.bind();
      if (c == run.store.column_count()) return;
      for (std::size_t p = 0; p < run.store.size(); p += 100) run.store.column(c)[p] = broken;
      run.sequence->population_changed();
      try {
        run.step(0.1);
      } catch (const Error& error) {
        EXPECT_STRNE(error.what(), "") << run.store.column_name(c) << " = " << broken;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(OnTheMesh, BrokenState, ::testing::ValuesIn(subjects),
                         [](const auto& each) {
                           const std::string id = each.param.id;
                           return id.substr(id.rfind('.') + 1) + std::to_string(each.index);
                         });

}  // namespace
}  // namespace pileus::testing
