// Operators with memory of their own: it goes through a checkpoint and comes back to the bit.
#include <gtest/gtest.h>

#include <cstring>
#include <span>

#include "base/error.hpp"
#include "toy_operators.hpp"

namespace pileus::test {
namespace {

/// Adds noise that remembers: x ← 0.9 x + a draw, once a step; the parcels move by x dt.
class RedNoise : public Operator<RedNoise> {
 public:
  static constexpr std::uint32_t state_format = 2;
  void describe(Declaration& d) {
    introduce(d, "test.red_noise");
    tracer = d.owns("passive_tracer", "1").intensive().range(-1e6, 1e6);
  }
  double prepare(const pileus_step& step, Block) {
    double u;
    draw(step, 1, 0, 1, &u);
    x = 0.9 * x + u - 0.5;
    return std::numeric_limits<double>::infinity();
  }
  void apply(const pileus_step& step, Block block) const {
    double* q = block.out(tracer);
    block.each([&](auto p) { q[p] += x * step.dt; });
  }
  std::vector<std::byte> save() const {
    std::vector<std::byte> bytes(sizeof x);
    std::memcpy(bytes.data(), &x, sizeof x);
    return bytes;
  }
  void load(std::uint32_t format, std::span<const std::byte> bytes) {
    if (format != state_format || bytes.size() != sizeof x) throw Failure("not my bytes");
    std::memcpy(&x, bytes.data(), sizeof x);
  }

 private:
  Slot tracer;
  double x = 0;
};

/// What a restart does: the state of the parcels stays, instances are made anew.
void restart(ToyRun& run, const coupling::PrivateStates& states) {
  run.sequence.bind(run.store, {});
  run.sequence.resume({}, states);
}

std::vector<double> tracer_after(int steps, int restart_before) {
  ToyRun run(entries_of<RedNoise>({"noise"}), 3);
  for (int n = 0; n < steps; ++n) {
    if (n == restart_before) restart(run, run.sequence.private_states());
    run.step(static_cast<std::uint64_t>(n), 0.5);
  }
  const double* q = run.values("passive_tracer");
  return {q, q + 3};
}

TEST(PrivateState, makes_a_restart_invisible_to_the_bit) {
  const std::vector<double> whole = tracer_after(7, -1);
  EXPECT_NE(whole[0], 0);
  EXPECT_EQ(tracer_after(7, 4), whole);
}

TEST(PrivateState, is_what_the_operator_said) {
  ToyRun run(entries_of<RedNoise, Condenser>({"noise", "condenser"}), 3);
  const coupling::PrivateStates states = run.sequence.private_states();
  ASSERT_EQ(states.size(), 1u);
  EXPECT_EQ(states.at("noise").format, 2u);
  EXPECT_EQ(states.at("noise").bytes, std::vector<std::uint8_t>(sizeof(double)));
}

TEST(PrivateState, of_another_format_is_refused_in_the_words_of_the_plugin) {
  ToyRun run(entries_of<RedNoise>({"noise"}), 3);
  coupling::PrivateStates states = run.sequence.private_states();
  states.at("noise").format = 1;
  try {
    restart(run, states);
    FAIL() << "it was taken";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::plugin);
    EXPECT_NE(std::string(error.what()).find("test.red_noise failed in load: not my bytes"),
              std::string::npos)
        << error.what();
  }
}

/// Answers pileus.state/1 with a table without functions.
class Wordless : public Operator<Wordless> {
 public:
  void describe(Declaration& d) {
    introduce(d, "test.wordless");
    tracer = d.owns("passive_tracer", "1").intensive();
  }
  void apply(const pileus_step&, Block) const {}
  const void* extension(const char* id) const {
    static const pileus_state_ext empty{sizeof empty, 1, nullptr, nullptr};
    return std::strcmp(id, PILEUS_STATE_EXTENSION) == 0 ? &empty : nullptr;
  }

 private:
  Slot tracer;
};

TEST(PrivateState, without_functions_is_refused_when_it_is_configured) {
  try {
    const ToyRun run(entries_of<Wordless>({"wordless"}), 3);
    FAIL() << "it was taken";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::plugin);
    EXPECT_NE(std::string(error.what()).find("test.wordless answers pileus.state/1 with a table"),
              std::string::npos)
        << error.what();
  }
}

}  // namespace
}  // namespace pileus::test
