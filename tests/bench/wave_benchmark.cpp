// The internal wave followed for two periods on several meshes with several time schemes: errors of
// frequency, vorticity and energy beside the processor time they cost, and what EPIC and PS3D
// reach.
//
//   bench_wave [--scene FILE] [--cells 48,64,96,128] [--cases NAME,…] [--data FILE]
//              [--threads N] [--again yes]
//
// One line per run is appended to the data file as soon as it is known, and runs that are in it
// already are taken from there, so that a long table can be made in pieces; with --again yes they
// are repeated, and the least disturbed of all repeats is shown. Diagnostics are not timed.
// Energies are those of total_energy (kinetic energy at the parcels, the published definition) and
// of the same with the kinetic energy of the mesh.
#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <limits>
#include <numeric>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "model/diagnostics.hpp"
#include "prepared_scene.hpp"

namespace {

using namespace pileus;

struct Case {
  std::string name;
  std::vector<std::string> overrides;
};

const std::vector<Case>& all_cases() {
  static const std::vector<Case> cases = {
      {"rk4_0.1", {"time.step.alpha=0.1"}},
      {"rk4_0.2", {"time.step.alpha=0.2"}},
      {"rk4_0.4", {"time.step.alpha=0.4"}},
      {"rk4_0.8", {"time.step.alpha=0.8"}},
      {"rk3_0.1", {"time.scheme=rk3", "time.step.alpha=0.1"}},
      {"rk3_0.2", {"time.scheme=rk3", "time.step.alpha=0.2"}},
      {"rk3_0.4", {"time.scheme=rk3", "time.step.alpha=0.4"}},
      {"uncompensated", {"numerics.window_compensation=0"}},
      {"uncompensated_centred",
       {"numerics.window_compensation=0", "numerics.vertical_derivative=centred"}},
      {"centred", {"numerics.vertical_derivative=centred"}},
  };
  return cases;
}

/// What others reach: the figures quoted in docs/accuracy.md, with their sources there. Numbers
/// that were not measured are NaN.
struct Peer {
  const char* code;
  int cells;
  double frequency, vorticity, deviation, change, core;
};
constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr Peer peers[] = {
    {"EPIC RK4 0.2", 48, -2.07e-2, 0.264, 2.28e-4, 0.321, 263},
    {"EPIC RK4 0.4", 48, -2.08e-2, 0.269, 3.38e-4, 0.98, 124},
    {"EPIC RK3 0.2", 48, -2.07e-2, 0.264, 6.61e-4, -2.37, 163},
    {"EPIC RK3 0.4", 48, -2.06e-2, 0.266, 5.31e-3, -19.9, 87},
    {"EPIC RK4 0.2", 64, -1.20e-2, 0.155, 0.90e-4, 0.128, 609.7},
    {"PS3D dt 0.025", 48, -0.18e-2, 0.026, none, -0.695, none},
};

struct Row {
  std::string name;
  int cells = 0;
  double parcels = 0, steps = 0, core = 0, frequency = 0, vorticity = 0, amplitude = 0,
         deviation = 0, grid_deviation = 0, change = 0, grid_change = 0;
  double nanoseconds() const { return core / (parcels * steps) * 1e9; }
};

struct Options {
  std::string scene = "configs/scenes/internal_wave/internal_wave.yaml", data;
  std::vector<int> cells = {48, 64, 96, 128};
  bool again = false;
  std::vector<std::string> cases = {"rk4_0.2", "rk4_0.4", "rk3_0.2", "rk3_0.4"};
};

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts;
  std::stringstream stream(text);
  for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
  return parts;
}

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (i + 1 >= argc) throw Error(ExitCode::usage, word + " needs a value, or is unknown");
    const std::string value = argv[++i];
    if (word == "--scene") {
      options.scene = value;
    } else if (word == "--data") {
      options.data = value;
    } else if (word == "--again") {
      options.again = value == "yes";
    } else if (word == "--threads") {
      omp_set_num_threads(std::stoi(value));
    } else if (word == "--cases") {
      options.cases = split(value);
    } else if (word == "--cells") {
      options.cells.clear();
      for (const std::string& part : split(value)) options.cells.push_back(std::stoi(part));
    } else {
      throw Error(ExitCode::usage,
                  "bench_wave [--scene FILE] [--cells 48,64,96,128] [--cases NAME,…] "
                  "[--data FILE] [--threads N] [--again yes]");
    }
  }
  return options;
}

/// ⟨|1 − E/⟨E⟩|⟩ over the samples of a run, the measure of Frey et al. (2023).
double mean_deviation(const std::vector<double>& energy) {
  const double count = static_cast<double>(energy.size());
  const double mean = std::accumulate(energy.begin(), energy.end(), 0.0) / count;
  double sum = 0;
  for (const double e : energy) sum += std::abs(1 - e / mean);
  return sum / count;
}

double per_mille(const std::vector<double>& energy) {
  return 1e3 * (energy.back() / energy.front() - 1);
}

double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Row measure(const Options& options, const Case& which, int cells) {
  std::vector<std::string> overrides = which.overrides;
  overrides.push_back(fmt::format("domain.cells=[{}, {}, {}]", cells, cells, cells / 4));
  bench::PreparedScene prepared(options.scene, overrides);
  model::Simulation& simulation = prepared.simulation();
  model::Diagnostics diagnostics(prepared.scene(), simulation, prepared.sequence().surface(), {},
                                 {});
  const double end = prepared.scene().time.end;

  Row row{.name = which.name, .cells = cells};
  row.parcels = static_cast<double>(simulation.store().size());
  std::vector<double> energy, grid_energy;
  const auto value = [&](const char* name) {
    return diagnostics.values()[static_cast<std::size_t>(diagnostics.index(name))];
  };
  const auto observe_velocity = [&] {
    diagnostics.observe_velocity(simulation);
    energy.push_back(value("total_energy"));
    grid_energy.push_back(value("grid_kinetic_energy") + value("available_potential_energy"));
  };
  const auto timed = [&](auto&& work) {
    const double started = processor_seconds();
    work();
    row.core += processor_seconds() - started;
  };
  for (; simulation.time() < end; ++row.steps) {
    diagnostics.observe_state(simulation);
    const double left = end - simulation.time();
    const double count = std::ceil(left / simulation.allowed_step().seconds * (1 - 1e-12));
    timed([&] { simulation.begin_step(count <= 1 ? end : simulation.time() + left / count); });
    observe_velocity();
    timed([&] {
      simulation.finish_step();
      simulation.evaluate();
    });
  }
  diagnostics.observe_state(simulation);
  simulation.probe();
  observe_velocity();
  row.frequency = value("z_vorticity_frequency_error");
  row.vorticity = value("z_vorticity_rms_error");
  row.amplitude = value("z_vorticity_amplitude");
  row.deviation = mean_deviation(energy);
  row.grid_deviation = mean_deviation(grid_energy);
  row.change = per_mille(energy);
  row.grid_change = per_mille(grid_energy);
  return row;
}

constexpr const char* data_header =
    "# case cells parcels steps core_s frequency_error vorticity_error amplitude energy_deviation "
    "grid_energy_deviation energy_change_per_mille grid_energy_change_per_mille ns_per_parcel_step";

/// The run in the data file; of repeats the one that took least, which was disturbed least.
std::optional<Row> find(const std::string& file, const std::string& name, int cells) {
  std::ifstream in(file);
  std::optional<Row> best;
  for (std::string line; std::getline(in, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::stringstream stream(line);
    Row r;
    stream >> r.name >> r.cells >> r.parcels >> r.steps >> r.core >> r.frequency >> r.vorticity >>
        r.amplitude >> r.deviation >> r.grid_deviation >> r.change >> r.grid_change;
    if (stream && r.name == name && r.cells == cells && (!best || r.core < best->core)) best = r;
  }
  return best;
}

void append(const std::string& file, const Row& r) {
  const bool fresh = !std::ifstream(file).good();
  std::ofstream out(file, std::ios::app);
  if (fresh) out << data_header << '\n';
  out << fmt::format(
      "{} {} {:.0f} {:.0f} {:.2f} {:.4e} {:.4e} {:.6f} {:.4e} {:.4e} {:.4f} {:.4f} "
      "{:.0f}\n",
      r.name, r.cells, r.parcels, r.steps, r.core, r.frequency, r.vorticity, r.amplitude,
      r.deviation, r.grid_deviation, r.change, r.grid_change, r.nanoseconds());
  if (!out) throw Error(ExitCode::file, file + " cannot be written");
}

void print_header() {
  fmt::print(
      "{:<22} {:>9} {:>5} {:>9} {:>9} {:>9} {:>9} {:>8} {:>8} {:>8} {:>6}\n"
      "{:<22} {:>9} {:>5} {:>9} {:>9} {:>9} {:>9} {:>8} {:>8} {:>8} {:>6}\n",
      "run", "mesh", "steps", "frequency", "vorticity", "energy", "energy", "energy", "energy",
      "core", "ns per", "", "", "", "error %", "error %", "deviat.", "(mesh)", "change", "(mesh)",
      "s", "p.-step");
}

void print(const Row& r) {
  fmt::print(
      "{:<22} {:>9} {:>5.0f} {:>9.3f} {:>9.2f} {:>9.2e} {:>9.2e} {:>8.3f} {:>8.3f} {:>8.1f} "
      "{:>6.0f}\n",
      r.name, fmt::format("{}^2x{}", r.cells, r.cells / 4), r.steps, 100 * r.frequency,
      100 * r.vorticity, r.deviation, r.grid_deviation, r.change, r.grid_change, r.core,
      r.nanoseconds());
  std::fflush(stdout);
}

void print_peers(int cells) {
  for (const Peer& p : peers)
    if (p.cells == cells)
      fmt::print("{:<22} {:>9} {:>5} {:>9.3f} {:>9.2f} {:>9.2e} {:>9} {:>8.3f} {:>8} {:>8.1f}\n",
                 p.code, fmt::format("{}^2x{}", cells, cells / 4), "", 100 * p.frequency,
                 100 * p.vorticity, p.deviation, "", p.change, "", p.core);
}

void run(int argc, char** argv) {
  omp_set_num_threads(1);
  const Options options = parse(argc, argv);
  print_header();
  for (const int cells : options.cells) {
    print_peers(cells);
    for (const std::string& name : options.cases) {
      const auto& cases = all_cases();
      const auto which =
          std::find_if(cases.begin(), cases.end(), [&](const Case& c) { return c.name == name; });
      if (which == cases.end()) throw Error(ExitCode::usage, "there is no case " + name);
      auto row = find(options.data, name, cells);
      if (!row || options.again) {
        row = measure(options, *which, cells);
        if (!options.data.empty()) {
          append(options.data, *row);
          row = find(options.data, name, cells);
        }
      }
      print(*row);
    }
  }
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
