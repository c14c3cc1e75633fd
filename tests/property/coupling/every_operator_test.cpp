// Laws that every operator of this repository keeps, whatever it computes: on random parcels within
// its declared ranges and time steps over ten decades its results are finite and in range, budgets
// close, and a parcel it calls inactive is one it would leave as it is, to the bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <random>

#include "../../unit/coupling/sampled_mesh.hpp"
#include "base/error.hpp"
#include "coupling/operator_sequence.hpp"
#include "host/library.hpp"

namespace pileus::coupling {
namespace {

namespace fs = std::filesystem;
const fs::path plugins = PILEUS_BINARY_DIR "/lib/pileus/plugins";
using Random = std::mt19937_64;

/// One operator with one of its choices taken, and with what that choice needs to mean something;
/// everything else at its default.
struct Case {
  std::string id, parameter, choice;
  std::vector<std::pair<std::string, std::string>> needs;
};

std::ostream& operator<<(std::ostream& out, const Case& c) {
  return out << c.id << (c.parameter.empty() ? "" : " " + c.parameter + " = " + c.choice);
}

/// The choices under which a parameter means something.
std::vector<std::pair<std::string, std::string>> needs_of(const host::OperatorTable& table,
                                                          std::size_t parameter) {
  std::vector<std::pair<std::string, std::string>> needs;
  for (const host::WhenTerm& term : table.parameter_when[parameter]) {
    const pileus_parameter& other = table.parameters[term.index];
    if (other.type != PILEUS_CHOICE) continue;
    const auto wanted = static_cast<std::size_t>(term.value);
    needs.emplace_back(other.name, other.choices[term.equal ? wanted : wanted == 0 ? 1 : 0]);
  }
  return needs;
}

std::vector<Case> every_case() {
  std::vector<Case> cases;
  std::vector<fs::path> libraries;
  for (const auto& entry : fs::directory_iterator(plugins))
    if (entry.path().extension() == ".so") libraries.push_back(entry.path());
  std::sort(libraries.begin(), libraries.end());
  for (const fs::path& path : libraries)
    for (const host::OperatorTable& table : host::load_library(path).operators) {
      cases.push_back({table.op.id, "", "", {}});
      for (std::size_t i = 0; i < table.parameters.size(); ++i) {
        const pileus_parameter& p = table.parameters[i];
        if (p.type != PILEUS_CHOICE) continue;
        for (const char* const* choice = p.choices + 1; *choice != nullptr; ++choice)
          cases.push_back({table.op.id, p.name, *choice, needs_of(table, i)});
      }
    }
  return cases;
}

/// Makes the items that other operators of this repository work on.
constexpr const char* maker_of_items = "org.pileus.superdroplets";

bool works_on_items_of_others(const OperatorEntry& entry) {
  return std::any_of(entry.table->quantities.begin(), entry.table->quantities.end(),
                     [](const pileus_quantity& row) {
                       return row.place == PILEUS_ITEM && (row.access & PILEUS_CREATE) == 0;
                     });
}

std::vector<OperatorEntry> load(const Case& c) {
  scene::Scene scene;
  scene::OperatorBlock block;
  block.use = c.id;
  block.name = "subject";
  const auto set = [&](const std::string& name, const std::string& value) {
    block.parameters.emplace_back(name, scene::RawValue{value, false, {}, {}, {}});
  };
  for (const auto& [name, value] : c.needs) set(name, value);
  if (!c.parameter.empty()) set(c.parameter, c.choice);
  scene.operators.push_back(block);
  scene::Problems problems;
  auto entries = load_operators(scene, {{plugins}}, problems);
  EXPECT_TRUE(problems.empty()) << problems.render();
  if (works_on_items_of_others(entries.front())) {
    scene.operators.push_back({});
    scene.operators.back().use = scene.operators.back().name = maker_of_items;
    // The subject alone is looked at; the maker has cases of its own.
    scene.operators.back().parameters.emplace_back("condensation",
                                                   scene::RawValue{"no", false, {}, {}, {}});
    entries = load_operators(scene, {{plugins}}, problems);
  }
  return entries;
}

/// What the operator takes from parcels without owning it, optional or not: the initial state gives
/// it.
std::vector<std::string> read_quantities(const OperatorEntry& entry) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < entry.table->quantities.size(); ++i) {
    const pileus_quantity& row = entry.table->quantities[i];
    if (row.place == PILEUS_PARCEL && (row.access & PILEUS_CREATE) == 0 &&
        row.nature != PILEUS_DERIVED && !is_core_quantity(row.name) &&
        holds(entry.table->quantity_when[i], entry.values.numbers()))
      names.emplace_back(row.name);
  }
  return names;
}

struct Range {
  double low, high;
};

/// What a quantity of air may be: its declared range, no wider than a million, and of temperatures
/// and water what an atmosphere can hold together. Each quantity alone may be declared wider.
Range range_of(const parcels::Scalar& scalar) {
  Range range{std::max(scalar.low, -1e6), std::min(scalar.high, 1e6)};
  if (scalar.units == "K") range = {std::max(range.low, 200.0), std::min(range.high, 400.0)};
  if (scalar.budget == "water") range.high = std::min(range.high, 0.02);
  return range;
}

/// The ends of the range, zero, and anything between on a linear or logarithmic scale.
double draw(Random& random, const parcels::Scalar& scalar) {
  const auto [low, high] = range_of(scalar);
  const double u = std::uniform_real_distribution<double>(0, 1)(random);
  switch (random() % 8) {
    case 0:
      return low;
    case 1:
      return high;
    case 2:
      return low <= 0 && high >= 0 ? 0 : low;
    case 3:
    case 4:
      return std::clamp(low + (high - low) * std::pow(10.0, -20 * u), low, high);
    default:
      return std::clamp(low + (high - low) * u, low, high);
  }
}

void fill(parcels::Store& store, Random& random) {
  constexpr std::size_t parcels = 777;  // some blocks and a rest
  store.resize(parcels);
  std::uniform_real_distribution<double> unit(0, 1);
  for (std::size_t p = 0; p < parcels; ++p) {
    store.uid()[p] = p + 1;
    store.volume()[p] = 10 * unit(random) + 1e-3;
    for (int d = 0; d < 3; ++d) store.position(d)[p] = 2000 * unit(random);
    for (int c = 0; c < 3; ++c) store.vorticity(c)[p] = 0.2 * unit(random) - 0.1;
    for (int c = 0; c < 6; ++c) store.shape(c)[p] = c == 0 || c == 3 || c == 5 ? 1 : 0;
    for (std::size_t s = 0; s < store.scalars().size(); ++s)
      store.scalar(static_cast<int>(s))[p] = draw(random, store.scalars()[s]);
  }
}

class EveryOperator : public ::testing::TestWithParam<Case> {
 protected:
  struct Run {
    std::unique_ptr<OperatorSequence> sequence;
    std::unique_ptr<parcels::Store> store;
    std::unique_ptr<testing::SampledMesh<3>> mesh;
  };

  /// A flow at the nodes: a third of them at rest, the others with gradients over four decades.
  static double random_flow(std::string_view, std::size_t node) {
    Random random(node * 7919u + 17u);
    const double u = std::uniform_real_distribution<double>(0, 1)(random);
    return u < 0.3 ? 0.0 : 0.02 * std::pow(10.0, -4 * u);
  }

  /// A bound sequence on random parcels, the same for the same seed.
  static Run start(std::uint64_t seed, bool skip_inactive) {
    auto entries = load(GetParam());
    SequenceOptions options;
    for (const OperatorEntry& entry : entries)
      for (const std::string& name : read_quantities(entry)) options.initial.push_back(name);
    options.coupling.skip_inactive = skip_inactive;
    Run run;
    run.sequence = std::make_unique<OperatorSequence>(std::move(entries), std::move(options));
    run.store = std::make_unique<parcels::Store>(3, run.sequence->required_scalars(),
                                                 run.sequence->required_items());
    Random random(seed);
    fill(*run.store, random);
    const mesh::Grid<3> grid({4, 4, 4}, {0, 0, 0}, {2000, 2000, 2000});
    run.mesh = std::make_unique<testing::SampledMesh<3>>(grid, *run.store, random_flow);
    run.mesh->reorder();
    run.sequence->bind(*run.store, abi_grid(grid), run.mesh.get());
    run.sequence->init({0, 0, 0});
    return run;
  }

  static void step(Run& run, std::uint64_t number, double dt) {
    const StepTime at{number, static_cast<double>(number) * dt, dt};
    run.sequence->apply_before_transport(at);
    run.sequence->apply_after_transport(at);
    run.sequence->diagnose(at);
  }

  /// Inside the domain, and shapes finite, positive definite and of their determinant, one unless
  /// they grow: that of an aspect ratio a loses a^4 units of rounding.
  static void expect_sound_parcels(const parcels::Store& store) {
    for (std::size_t p = 0; p < store.size(); ++p) {
      for (int d = 0; d < 3; ++d) {
        ASSERT_GE(store.position(d)[p], 0) << "parcel " << p;
        ASSERT_LE(store.position(d)[p], 2000) << "parcel " << p;
      }
      const Eigen::Matrix3d shape = testing::get_shape<3>(store, p);
      ASSERT_TRUE(shape.allFinite()) << "parcel " << p;
      const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(shape);
      const double longest = axes.eigenvalues()(2), shortest = axes.eigenvalues()(0);
      ASSERT_GT(shortest, 0) << "parcel " << p;
      const double rounding = 64 * 2.2e-16 * (longest / shortest) * (longest / shortest);
      const double growth = store.size_volume()[p] / store.volume()[p];
      ASSERT_NEAR(shape.determinant() / (growth * growth), 1, std::max(rounding, 1e-12))
          << "parcel " << p;
    }
  }

  static void expect_same_items(const parcels::ItemLists& a, const parcels::ItemLists& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) ASSERT_EQ(a.multiplicity()[i], b.multiplicity()[i]);
    for (std::size_t c = 0; c < a.declaration().columns.size(); ++c)
      ASSERT_EQ(std::memcmp(a.column(static_cast<int>(c)), b.column(static_cast<int>(c)),
                            a.size() * sizeof(double)),
                0);
  }

  static double draw_step(Random& random) {
    return std::pow(10.0, std::uniform_real_distribution<double>(-6, 4)(random));
  }
};

TEST_P(EveryOperator, stays_finite_and_in_range) {
  Random random(11);
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const double dt = draw_step(random);
    SCOPED_TRACE(::testing::Message() << "seed " << seed << ", dt = " << dt);
    Run run = start(seed, true);
    for (std::uint64_t number = 0; number < 3; ++number) step(run, number, dt);
    const auto& scalars = run.store->scalars();
    for (std::size_t s = 0; s < scalars.size(); ++s)
      for (std::size_t p = 0; p < run.store->size(); ++p) {
        const double value = run.store->scalar(static_cast<int>(s))[p];
        ASSERT_TRUE(std::isfinite(value)) << scalars[s].name << " of parcel " << p;
        ASSERT_GE(value, scalars[s].low) << scalars[s].name << " of parcel " << p;
        ASSERT_LE(value, scalars[s].high) << scalars[s].name << " of parcel " << p;
      }
    expect_sound_parcels(*run.store);
  }
}

TEST_P(EveryOperator, changes_a_budget_by_its_declared_sources_alone) {
  Random random(12);
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const double dt = draw_step(random);
    SCOPED_TRACE(::testing::Message() << "seed " << seed << ", dt = " << dt);
    Run run = start(seed, true);
    for (std::uint64_t number = 0; number < 3; ++number) step(run, number, dt);
    const Ledger ledger = run.sequence->ledger();
    for (const OperatorBudget& budget : ledger.operators.at(0).budgets) {
      // Every parcel's change rounds by a few units in the last place of what it holds.
      double held = 0;
      for (std::size_t s = 0; s < run.store->scalars().size(); ++s)
        if (run.store->scalars()[s].budget == budget.budget)
          for (std::size_t p = 0; p < run.store->size(); ++p)
            held += run.store->volume()[p] * std::abs(run.store->scalar(static_cast<int>(s))[p]);
      const parcels::ItemLists& items = run.store->items();
      for (std::size_t k = 0; k < items.declaration().columns.size(); ++k)
        if (items.declaration().columns[k].budget == budget.budget)
          for (std::size_t i = 0; i < items.size(); ++i)
            held += static_cast<double>(items.multiplicity()[i]) *
                    items.column(static_cast<int>(k))[i] / items.budget_scale();
      const double allowed =
          64 * 1.1e-16 * (held + std::abs(budget.source) + std::abs(budget.change));
      EXPECT_LE(std::abs(budget.defect()), allowed) << budget.budget;
    }
  }
}

TEST_P(EveryOperator, leaves_inactive_parcels_as_they_are) {
  Random random(13);
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const double dt = draw_step(random);
    SCOPED_TRACE(::testing::Message() << "seed " << seed << ", dt = " << dt);
    Run skipping = start(seed, true), complete = start(seed, false);
    for (std::uint64_t number = 0; number < 3; ++number) {
      step(skipping, number, dt);
      step(complete, number, dt);
    }
    ASSERT_EQ(skipping.store->column_count(), complete.store->column_count());
    for (int c = 0; c < skipping.store->column_count(); ++c)
      EXPECT_EQ(std::memcmp(skipping.store->column(c), complete.store->column(c),
                            skipping.store->size() * sizeof(double)),
                0)
          << skipping.store->column_name(c);
    expect_same_items(skipping.store->items(), complete.store->items());
  }
}

/// A model that blows up meets its operators before it is noticed. They may fail; no value leads
/// them outside their tables or the mesh.
TEST_P(EveryOperator, ends_in_a_sentence_when_the_state_has_broken_down) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const int columns = start(1, true).store->column_count();
  for (int c = 0; c < columns; ++c)
    for (const double broken : {std::nan(""), infinity, -infinity, 1e300}) {
      Run run = start(1, true);
      for (std::size_t p = 0; p < run.store->size(); p += 100) run.store->column(c)[p] = broken;
      run.sequence->population_changed();
      try {
        step(run, 0, 1.0);
      } catch (const Error& error) {
        EXPECT_STRNE(error.what(), "") << run.store->column_name(c) << " = " << broken;
      }
    }
}

INSTANTIATE_TEST_SUITE_P(InTree, EveryOperator, ::testing::ValuesIn(every_case()),
                         [](const ::testing::TestParamInfo<Case>& each) {
                           std::string name = each.param.id + "_" + each.param.choice;
                           name = name.substr(name.rfind('.') + 1);
                           std::erase_if(name, [](char c) { return !std::isalnum(c) && c != '_'; });
                           return name + std::to_string(each.index);
                         });

}  // namespace
}  // namespace pileus::coupling
