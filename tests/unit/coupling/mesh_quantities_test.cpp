// Quantities on the mesh: what operators get, how often it is made, who pays, and optional ones.
#include <gtest/gtest.h>

#include <cmath>

#include "sampled_mesh.hpp"
#include "toy_operators.hpp"

namespace pileus::test {
namespace {

using testing::SampledMesh;

/// Copies what it is shown of the mesh to tracers of its own.
class Reader : public Operator<Reader> {
 public:
  void describe(Declaration& d) {
    introduce(d, "test.reader");
    mean_ = d.reads_mesh_at_parcel("passive_tracer", "1");
    strain_ = d.reads_mesh_at_parcel("strain_rate_magnitude", "s-1");
    nodes_ = d.reads_mesh("passive_tracer", "1");
    humidity_ = d.owns("specific_humidity", "1").intensive().range(-1e9, 1e9);
    theta_ = d.owns("air_potential_temperature", "K").intensive().range(-1e9, 1e9);
    absent_ = d.updates("mass_fraction_of_rain_in_air", "1").optional();
  }
  void apply(const pileus_step&, Block block) const {
    if (block.has(absent_)) throw Failure("an optional quantity exists that nobody called for");
    const auto nodes = block.strided_in<double>(nodes_);
    const double first = nodes(1);  // level 0 of the first column
    block.each([&](auto p) {
      block.out(humidity_)[p] = block.in(mean_)[p] - first;
      block.out(theta_)[p] = block.in(strain_)[p];
    });
  }

 private:
  Slot mean_, strain_, nodes_, humidity_, theta_, absent_;
};

/// Writes what Reader gathers.
class Writer : public Operator<Writer> {
 public:
  void describe(Declaration& d) {
    introduce(d, "test.writer");
    tracer_ = d.owns("passive_tracer", "1").intensive().range(-1e9, 1e9);
  }
  void apply(const pileus_step&, Block block) const {
    block.each([&](auto p) { block.out(tracer_)[p] += 1; });
  }

 private:
  Slot tracer_;
};

/// Moves every parcel far to the side and above the upper wall.
class Mover : public Operator<Mover> {
 public:
  void describe(Declaration& d) {
    introduce(d, "test.mover");
    x_ = d.updates("x_position", "m");
    z_ = d.updates("z_position", "m");
  }
  void apply(const pileus_step&, Block block) const {
    block.each([&](auto p) {
      block.out(x_)[p] += 17.5;
      block.out(z_)[p] += 0.25;
    });
  }

 private:
  Slot x_, z_;
};

template <class... Ops>
struct MeshToy {
  explicit MeshToy(const std::vector<std::string>& names)
      : sequence(entries_of<Ops...>(names), {}),
        store(3, sequence.required_scalars()),
        mesh(grid, store, [](std::string_view, std::size_t) { return 0.25; }) {
    testing::Random random(3);
    testing::fill_randomly<3>(store, grid, 3000, grid.domain_volume() / 3000, 2, random);
    mesh.reorder();
    sequence.bind(store, coupling::abi_grid(grid), &mesh);
    sequence.init({});
  }
  double* values(const char* name) { return store.scalar(store.find_scalar(name)); }
  void step(std::uint64_t n) { sequence.apply_after_transport({n, 0, 1}); }

  mesh::Grid<3> grid{{8, 8, 8}, {0, 0, 0}, {4, 4, 4}};
  coupling::OperatorSequence sequence;
  parcels::Store store;
  SampledMesh<3> mesh;
};

TEST(MeshQuantities, are_the_gathered_means_and_the_flow_at_the_parcels) {
  MeshToy<Writer, Reader> run({"writer", "reader"});
  std::fill_n(run.values("passive_tracer"), run.store.size(), 3.5);
  run.sequence.population_changed();
  run.step(0);
  for (std::size_t p = 0; p < run.store.size(); ++p) {
    EXPECT_NEAR(run.values("specific_humidity")[p], 0.0, 1e-13);
    EXPECT_NEAR(run.values("air_potential_temperature")[p], 0.25, 1e-15);
  }
}

TEST(MeshQuantities, are_made_once_for_each_state_and_charged_to_who_asks) {
  // Applied from the last to the first: reader, second reader of the same state, writer.
  MeshToy<Writer, Reader> run({"writer", "reader"});
  run.step(0);
  EXPECT_EQ(run.mesh.deposits, 1);
  EXPECT_EQ(run.mesh.evaluations, 1);
  run.step(1);  // transport has moved the parcels, the writer has changed the tracer
  EXPECT_EQ(run.mesh.deposits, 2);
  EXPECT_EQ(run.mesh.evaluations, 2);
  const coupling::Ledger ledger = run.sequence.ledger();
  EXPECT_GT(ledger.operators[1].core_seconds, 0.0);
}

TEST(MeshQuantities, follow_what_operators_before_have_written) {
  // The reader comes after the writer within a step: its means are those of the new values.
  MeshToy<Reader, Writer> run({"reader", "writer"});
  run.step(0);
  run.step(1);
  EXPECT_EQ(run.mesh.deposits, 2);
  for (std::size_t p = 0; p < run.store.size(); ++p)
    EXPECT_NEAR(run.values("specific_humidity")[p], 0.0, 1e-12);
}

TEST(MeshQuantities, do_not_exist_when_nobody_declares_them) {
  MeshToy<Writer> run({"writer"});
  run.step(0);
  EXPECT_EQ(run.mesh.deposits, 0);
  EXPECT_EQ(run.mesh.evaluations, 0);
}

TEST(Positions, written_by_an_operator_stay_in_the_domain) {
  MeshToy<Mover> run({"mover"});
  const std::vector<double> x(run.store.position(0), run.store.position(0) + run.store.size());
  const std::vector<double> z(run.store.position(2), run.store.position(2) + run.store.size());
  const std::vector<double> b13(run.store.shape(2), run.store.shape(2) + run.store.size());
  run.step(0);
  for (std::size_t p = 0; p < run.store.size(); ++p) {
    EXPECT_NEAR(run.store.position(0)[p], std::fmod(x[p] + 17.5, 4.0), 1e-14);
    const bool reflected = z[p] + 0.25 > 4;
    EXPECT_NEAR(run.store.position(2)[p], reflected ? 8 - (z[p] + 0.25) : z[p] + 0.25, 1e-14);
    EXPECT_EQ(run.store.shape(2)[p], reflected ? -b13[p] : b13[p]);
  }
}

TEST(OptionalQuantities, exist_when_the_initial_state_sets_them) {
  coupling::SequenceOptions options;
  options.initial = {"mass_fraction_of_rain_in_air", "passive_tracer"};
  const coupling::OperatorSequence with(entries_of<Reader>({"reader"}), options);
  options.initial = {"passive_tracer"};
  const coupling::OperatorSequence without(entries_of<Reader>({"reader"}), options);
  const auto has_rain = [](const coupling::OperatorSequence& sequence) {
    const auto& scalars = sequence.required_scalars();
    return std::any_of(scalars.begin(), scalars.end(), [](const parcels::Scalar& s) {
      return s.name == "mass_fraction_of_rain_in_air";
    });
  };
  EXPECT_TRUE(has_rain(with));
  EXPECT_FALSE(has_rain(without));
}

TEST(MeshQuantities, are_refused_where_a_run_has_no_mesh) {
  coupling::SequenceOptions options;
  options.initial = {"passive_tracer"};
  coupling::OperatorSequence sequence(entries_of<Reader>({"reader"}), options);
  parcels::Store store(3, sequence.required_scalars());
  store.resize(1);
  try {
    sequence.bind(store, {});
    FAIL() << "a mesh was found";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("which the mesh of this run does not have"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace pileus::test
