// Cost of a step: nanoseconds of wall time per parcel-step by phase, for a scene, beside the memory
// bandwidth measured in the same run.
//
//   bench_step SCENE.yaml [--steps N] [--warm-up N] [--threads N] [--repeats N] [--set key=value]…
//              [--data FILE --label NAME]
//
// Prints the repeat with the least total, which is the one least disturbed by other work. With
// --data it is appended to a table as one line, whose columns the table's first line names.
#include <fmt/format.h>
#include <omp.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "machine_limits.hpp"
#include "model/simulation.hpp"
#include "parcels/kernels.hpp"
#include "prepared_scene.hpp"

namespace {

using namespace pileus;

struct Options {
  std::string scene, data, label = "step";
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
    else if (word == "--data")
      options.data = next();
    else if (word == "--label")
      options.label = next();
    else if (word == "--set")
      options.overrides.push_back(next());
    else
      options.scene = word;
  }
  if (options.scene.empty())
    throw Error(ExitCode::usage,
                "bench_step SCENE.yaml [--steps N] [--warm-up N] [--threads N] [--repeats N] "
                "[--set key=value] [--data FILE --label NAME]");
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

/// What the two passes over the parcels cannot avoid, per parcel and stage.
struct Pass {
  const char* name;
  Phase phase;
  double bytes;       // moved between memory and processor
  double operations;  // on doubles, for a parcel whose support points share one cell
  double rate(const Timing& timing, int stages, double amount) const {  // per second
    return amount * stages * timing.parcel_steps / timing.phases[phase].seconds;
  }
};

/// A deposit reads position, volume, shape, vorticity and buoyancy; a stage reads and writes
/// position, vorticity, shape and their increments (3, 3 and the 8 of the velocity gradient).
/// Records of the mesh are moved once per pass: the deposited ones read and written, those of the
/// flow read. Operations are additions and multiplications, an inverse root 12 of them: principal
/// axes and support offsets 367, indices and weights of four points 4 × 44, the sums of their
/// weights 24; then 8 nodes × 5 values × 2 in the deposit; in the stage 8 × 14 × 2 to interpolate,
/// 354 for the exponential, 75 for the congruence and 40 for increments and updates. (The templates
/// over the number type were run with one that counts.)
std::vector<Pass> passes(const model::Simulation& simulation) {
  const auto nodes = static_cast<double>(simulation.node_count());
  const double per_node = nodes / static_cast<double>(simulation.store().size());
  constexpr double points = 367 + 4 * 44 + 24;
  return {{"deposit", Phase::deposit,
           8.0 * ((3 + 1 + 6 + 3 + 1) + 2 * mesh::DepositRecord<3>::width * per_node),
           points + 8 * 5 * 2},
          {"interpolate", Phase::interpolate,
           8.0 * (2 * (3 + 3 + 6) + 2 * (3 + 3 + 8) + mesh::FlowRecord<3>::width * per_node),
           points + 8 * 14 * 2 + 354 + 75 + 40}};
}

double bytes_per_parcel(const model::Simulation& simulation) {
  return static_cast<double>(simulation.allocated_bytes()) /
         static_cast<double>(simulation.store().size());
}

void print(const Options& options, const Timing& best, const model::Simulation& simulation,
           int stages, const bench::MachineLimits& limits) {
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
  fmt::print("  memory: {:.0f} bytes per parcel; triad {:.1f} GB/s; arithmetic {:.1f} Gflop/s\n",
             bytes_per_parcel(simulation), limits.triad, limits.arithmetic);
  if (simulation.dimension() != 3) return;
  for (const Pass& pass : passes(simulation)) {
    const double traffic = 1e-9 * pass.rate(best, stages, pass.bytes);
    const double work = 1e-9 * pass.rate(best, stages, pass.operations);
    fmt::print(
        "  {:<12} {:>4.0f} bytes, {:>4.0f} operations per parcel and stage: {:>5.1f} GB/s ({:.0f} "
        "% of the triad), {:.1f} Gflop/s ({:.0f} % of the arithmetic)\n",
        pass.name, pass.bytes, pass.operations, traffic, 100 * traffic / limits.triad, work,
        100 * work / limits.arithmetic);
  }
}

/// Appends the run to the table of `options.data`; a new table begins with the columns' names.
void append(const Options& options, const Timing& best, const model::Simulation& simulation,
            int stages, const bench::MachineLimits& limits) {
  const bool fresh = !std::filesystem::exists(options.data);
  std::ofstream table(options.data, std::ios::app);
  if (!table) throw Error(ExitCode::file, "cannot write to " + options.data);
  std::string names = "# label threads instructions parcels bytes triad arithmetic";
  std::string line =
      fmt::format("{} {} {} {:.0f} {:.0f} {:.1f} {:.1f}", options.label, omp_get_max_threads(),
                  parcels::kernels().instruction_set, best.parcel_steps / options.steps,
                  bytes_per_parcel(simulation), limits.triad, limits.arithmetic);
  for (const Pass& pass : passes(simulation)) {
    names += fmt::format(" {0}_intensity {0}_gflops", pass.name);
    line += fmt::format(" {:.3f} {:.2f}", pass.operations / pass.bytes,
                        1e-9 * pass.rate(best, stages, pass.operations));
  }
  names += " all";
  line += fmt::format(" {:.1f}", 1e9 * best.seconds() / best.parcel_steps);
  for (int p = 0; p < static_cast<int>(Phase::count_); ++p) {
    names += fmt::format(" {}", phase_names[static_cast<std::size_t>(p)]);
    line += fmt::format(" {:.1f}",
                        1e9 * best.phases[static_cast<Phase>(p)].seconds / best.parcel_steps);
  }
  if (fresh) table << names << '\n';
  table << line << '\n';
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
  const int stages = prepared.scene().time.scheme == scene::RungeKutta::order4_stages5 ? 5 : 3;
  const bench::MachineLimits limits = bench::measure_limits();
  print(options, best, *simulation, stages, limits);
  if (!options.data.empty()) append(options, best, *simulation, stages, limits);
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
