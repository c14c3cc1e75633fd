// Cost of a step: nanoseconds of wall time per parcel-step by phase, for a scene, beside the memory
// bandwidth measured in the same run.
//
//   bench_step SCENE.yaml [--steps N] [--warm-up N] [--threads N] [--repeats N] [--set key=value]…
//
// Prints the repeat with the least total, which is the one least disturbed by other work.
#include <fmt/format.h>
#include <omp.h>

#include <cstdio>
#include <limits>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "memory_bandwidth.hpp"
#include "model/simulation.hpp"
#include "parcels/kernels.hpp"
#include "prepared_scene.hpp"

namespace {

using namespace pileus;

struct Options {
  std::string scene;
  std::vector<std::string> overrides;
  int steps = 10, warm_up = 2, repeats = 3;
};

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto next = [&]() -> std::string {
      if (i + 1 >= argc) throw Error(ExitCode::usage, word + " needs a value");
      return argv[++i];
    };
    if (word == "--steps")
      options.steps = std::stoi(next());
    else if (word == "--warm-up")
      options.warm_up = std::stoi(next());
    else if (word == "--repeats")
      options.repeats = std::stoi(next());
    else if (word == "--threads")
      omp_set_num_threads(std::stoi(next()));
    else if (word == "--set")
      options.overrides.push_back(next());
    else
      options.scene = word;
  }
  if (options.scene.empty())
    throw Error(ExitCode::usage,
                "bench_step SCENE.yaml [--steps N] [--warm-up N] [--threads N] [--repeats N] "
                "[--set key=value]");
  return options;
}

/// Advances one step of the length the flow allows; returns the parcels it moved.
double take_step(model::Simulation& simulation) {
  const auto parcels = static_cast<double>(simulation.store().size());
  simulation.begin_step(simulation.time() + simulation.allowed_step().seconds);
  simulation.finish_step();
  simulation.evaluate();
  return parcels;
}

struct Timing {
  PhaseTimes phases;
  double parcel_steps = 0;
  double seconds() const {
    double total = 0;
    for (int p = 0; p < static_cast<int>(Phase::count_); ++p)
      total += phases[static_cast<Phase>(p)].seconds;
    return total;
  }
};

/// Memory traffic that the two passes over the parcels cannot avoid, against the triad's. A deposit
/// reads position, volume, shape, vorticity and buoyancy; a stage reads and writes position,
/// vorticity, shape and their increments (3, 3 and the 8 of the velocity gradient). Records of the
/// mesh are moved once per pass: the deposited ones read and written, those of the flow read.
void print_traffic(const Timing& best, const model::Simulation& simulation, int stages,
                   double triad) {
  const auto nodes = static_cast<double>(simulation.node_count());
  const double per_node = nodes / static_cast<double>(simulation.store().size());
  const double deposit = 8.0 * ((3 + 1 + 6 + 3 + 1) + 2 * mesh::DepositRecord<3>::width * per_node);
  const double stage =
      8.0 * (2 * (3 + 3 + 6) + 2 * (3 + 3 + 8) + mesh::FlowRecord<3>::width * per_node);
  const auto line = [&](const char* name, Phase phase, double bytes) {
    const double rate = bytes * stages * best.parcel_steps / best.phases[phase].seconds * 1e-9;
    fmt::print(
        "  {:<12} {:>4.0f} bytes per parcel and stage: {:>5.1f} GB/s, {:.0f} % of the triad\n",
        name, bytes, rate, 100 * rate / triad);
  };
  line("deposit", Phase::deposit, deposit);
  line("interpolate", Phase::interpolate, stage);
}

void print(const Options& options, const Timing& best, const model::Simulation& simulation,
           int stages) {
  const double scale = 1e9 / best.parcel_steps;
  fmt::print("{}: {:.0f} parcels, {} threads, {}\n", options.scene,
             best.parcel_steps / options.steps, omp_get_max_threads(),
             parcels::kernels().instruction_set);
  fmt::print("  {:<14} {:>10} {:>8}\n", "phase", "ns", "share");
  for (int p = 0; p < static_cast<int>(Phase::count_); ++p) {
    const auto& entry = best.phases[static_cast<Phase>(p)];
    if (entry.seconds > 0)
      fmt::print("  {:<14} {:>10.1f} {:>7.1f}%\n", phase_names[static_cast<std::size_t>(p)],
                 entry.seconds * scale, 100 * entry.seconds / best.seconds());
  }
  fmt::print("  {:<14} {:>10.1f}\n", "all", best.seconds() * scale);
  fmt::print(
      "  interpolate holds the stage's update of position, vorticity and shape, which runs in\n"
      "  the same pass; stage_update is what follows the last stage (walls, net vorticity).\n");
  const double triad = bench::triad_bandwidth(8);
  fmt::print("  memory: {:.0f} bytes per parcel; triad bandwidth {:.1f} GB/s\n",
             static_cast<double>(simulation.allocated_bytes()) /
                 static_cast<double>(simulation.store().size()),
             triad);
  if (simulation.dimension() == 3) print_traffic(best, simulation, stages, triad);
}

void run(int argc, char** argv) {
  const Options options = parse(argc, argv);
  bench::PreparedScene prepared(options.scene, options.overrides);
  model::Simulation* const simulation = &prepared.simulation();
  for (int n = 0; n < options.warm_up; ++n) take_step(*simulation);

  Timing best;
  for (int r = 0; r < options.repeats; ++r) {
    Timing timing;
    simulation->times().clear();
    for (int n = 0; n < options.steps; ++n) timing.parcel_steps += take_step(*simulation);
    timing.phases = simulation->times();
    if (r == 0 || timing.seconds() / timing.parcel_steps < best.seconds() / best.parcel_steps)
      best = timing;
  }
  print(options, best, *simulation,
        prepared.scene().time.scheme == scene::RungeKutta::order4_stages5 ? 5 : 3);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    run(argc, argv);
  } catch (const Error& error) {
    fmt::print(stderr, "{}\n", error.what());
    return static_cast<int>(error.code());
  }
  return 0;
}
