// Numbers of the whole domain: who may declare them, and what calls, retries and readers see.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sampled_mesh.hpp"
#include "toy_operators.hpp"

namespace pileus::test {
namespace {

using testing::SampledMesh;

/// Accelerates the mean wind by the Coriolis force, ten times the true one across. Rejects steps
/// above 1 s after having taken them.
class Push : public Operator<Push> {
 public:
  void describe(Declaration& d) {
    introduce(d, "test.push");
    d.op.scope = PILEUS_GLOBAL;
    u_ = d.updates_domain("domain_mean_x_velocity", "m s-1").range(-50, 50);
    v_ = d.updates_domain("domain_mean_y_velocity", "m s-1").range(-50, 50);
    f_ = d.reads_domain("coriolis_parameter", "s-1");
  }
  void apply(const pileus_step& step, Block block) const {
    if (!block.has(v_)) {
      block.out(u_)[0] += step.dt;
      return;
    }
    block.out(u_)[0] += step.dt * block.in(f_)[0] * block.in(v_)[0];
    if (step.dt > 1) throw Retry("too long");
  }

 private:
  Slot u_, v_, f_;
};

/// Reads the strain of the flow, which depends on the wind.
class Watch : public Operator<Watch> {
 public:
  void describe(Declaration& d) {
    introduce(d, "test.watch");
    d.op.scope = PILEUS_GLOBAL;
    strain_ = d.reads_mesh("strain_rate_magnitude", "s-1");
    tracer_ = d.owns("passive_tracer", "1").intensive().range(-1e9, 1e9);
  }
  void apply(const pileus_step&, Block) const {}

 private:
  Slot strain_, tracer_;
};

template <class Op, class Change>
std::string complaint(Change&& change) {
  coupling::OperatorEntry entry = entry_of<Op>("push");
  auto table = std::make_shared<host::OperatorTable>(*entry.table);
  change(table->op, table->quantities.front());
  entry.table = table;
  try {
    const coupling::OperatorSequence sequence({entry}, {});
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

void expect_in(const std::string& text, const std::string& phrase) {
  EXPECT_NE(text.find(phrase), std::string::npos) << text;
}

template <int D>
struct DomainRun {
  DomainRun(std::vector<coupling::OperatorEntry> entries, const mesh::Grid<D>& grid)
      : sequence(std::move(entries), {}),
        store(D, sequence.required_scalars()),
        mesh(grid, store, [](std::string_view, std::size_t) { return 0.0; }) {
    testing::Random random(1);
    testing::fill_randomly<D>(store, grid, 64, grid.domain_volume() / 64, 1.0, random);
    mesh.reorder();
    mesh.mean_wind = {3, 4};
    mesh.coriolis_parameter = 0.5;
    sequence.bind(store, coupling::abi_grid(grid), &mesh);
    sequence.init({});
  }
  coupling::OperatorSequence sequence;
  parcels::Store store;
  SampledMesh<D> mesh;
};

const mesh::Grid<3> cube({2, 2, 2}, {0, 0, 0}, {1, 1, 1});

TEST(DomainValues, are_read_and_written) {
  DomainRun<3> run(entries_of<Push>({"push"}), cube);
  run.sequence.apply_after_transport({0, 0, 1.0});
  EXPECT_EQ(run.mesh.mean_wind[0], 5.0);
  EXPECT_EQ(run.mesh.mean_wind[1], 4.0);
}

TEST(DomainValues, are_put_back_before_a_retry) {
  DomainRun<3> run(entries_of<Push>({"push"}), cube);
  run.sequence.apply_after_transport({0, 0, 2.0});
  EXPECT_EQ(run.mesh.mean_wind[0], 3 + 2 * 0.5 * 4);
  EXPECT_GT(run.sequence.ledger().operators.front().retries, 0u);
}

TEST(DomainValues, in_the_plane_there_is_the_wind_in_x_alone) {
  const mesh::Grid<2> square({2, 2}, {0, 0}, {1, 1});
  DomainRun<2> run(entries_of<Push>({"push"}), square);
  run.sequence.apply_after_transport({0, 0, 0.5});
  EXPECT_EQ(run.mesh.mean_wind[0], 3.5);
}

TEST(DomainValues, make_the_flow_stale) {
  DomainRun<3> run(entries_of<Watch, Push>({"watch", "push"}), cube);  // Push is called first
  const int before = run.mesh.evaluations;
  run.sequence.apply_after_transport({0, 0, 1.0});
  EXPECT_EQ(run.mesh.evaluations, before + 1);
  run.sequence.apply_after_transport({1, 1, 1.0});
  EXPECT_EQ(run.mesh.evaluations, before + 2);
}

TEST(DomainValues, out_of_their_range_are_named_and_left_as_they_were) {
  DomainRun<3> run(entries_of<Push>({"push"}), cube);
  run.mesh.mean_wind[1] = 1e6;
  try {
    run.sequence.apply_after_transport({0, 0, 1.0});
    FAIL() << "a value above the range passed";
  } catch (const coupling::OperatorFailure& failure) {
    expect_in(failure.what(), "domain_mean_x_velocity");
  }
  EXPECT_EQ(run.mesh.mean_wind[0], 3.0);
}

TEST(DomainValues, contradictions_are_named) {
  expect_in(complaint<Push>([](pileus_operator& op, auto&) { op.scope = PILEUS_LOCAL; }),
            "its scope has to be global");
  expect_in(complaint<Push>([](auto&, pileus_quantity& row) { row.name = "coriolis_parameter"; }),
            "it is the scene's");
  expect_in(complaint<Push>([](auto&, pileus_quantity& row) { row.name = "x_velocity"; }),
            "there are domain_mean_x_velocity");
}

}  // namespace
}  // namespace pileus::test
