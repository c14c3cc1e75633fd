// Time of condensation per superdroplet and sub-step, on one core: a large parcel that cools in
// cloud by 0.004 K per step, a medium one through activation, and many small ones.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <vector>

#include "../../plugins/superdroplets/aerosol_sampling.hpp"
#include "../../plugins/superdroplets/condensation.hpp"
#include "machine_limits.hpp"

namespace {

using namespace pileus;
using namespace pileus::superdroplets;

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Level level_of(double pressure) {
  return {pressure, thermo::exner(pressure, thermo::Constants{}.kappa()), 0};
}

/// A kg of air with n superdroplets of a lognormal aerosol of 1000 per cm3, 50 nm, deviation 2.
struct Parcel {
  Level level = level_of(9e4);
  Air air{};
  std::vector<double> water, dry, hygroscopic, scratch;
  std::vector<std::int64_t> multiplicity;

  Parcel(std::size_t count, double humidity) {
    const MoistAir moist;
    const double temperature = 283.15;
    air = {temperature / level.exner, humidity * moist.saturation(temperature, 9e4).humidity};
    const double density = moist.density(temperature, 9e4);
    const AerosolSampler sampler({{1e9 / density, 50e-9, 2.0, 0.61}}, count,
                                 {Sampling::constant_multiplicity});
    std::vector<Superdroplet> sample(count);
    const double kelvin = DropletAir{}.kelvin(temperature);
    sample.resize(sampler.sample(
        1.0, {humidity, kelvin}, [](std::size_t) { return 0.5; }, sample));
    for (const Superdroplet& s : sample) {
      water.push_back(s.water_mass);
      dry.push_back(s.dry_volume);
      hygroscopic.push_back(s.hygroscopic_volume);
      multiplicity.push_back(s.multiplicity);
    }
    scratch.resize(count * Condensation::scratch_per_droplet);
  }

  Outcome rise(const Condensation& scheme, double distance, double dt) {
    const Level to = level_of(level.pressure - 11.0 * distance);
    const Outcome did =
        scheme.advance(air, {water, multiplicity, dry, hygroscopic}, 1.0, level, to, dt, scratch);
    level = to;
    return did;
  }
};

struct Cost {
  double seconds = 0;
  long tried = 0, substeps = 0, fallbacks = 0;
  void add(const Outcome& did) {
    substeps += did.substeps;
    tried += did.substeps + did.rejected;
    fallbacks += did.fallbacks;
  }
  void print(const char* what, std::size_t count) const {
    fmt::print(
        "{:<34}{:>7.0f} ns per droplet and sub-step{:>8.0f} with those rejected{:>6} fallbacks\n",
        what, seconds / static_cast<double>(tried * static_cast<long>(count)) * 1e9,
        seconds / static_cast<double>(substeps * static_cast<long>(count)) * 1e9, fallbacks);
  }
};

/// Best of several windows: the machine may be shared.
void cooling(std::size_t count, const Condensation& scheme) {
  constexpr double rise = 0.41;  // m: 0.004 K
  Parcel parcel(count, 0.98);
  for (int i = 0; i < 200; ++i) parcel.rise(scheme, 1.0, 1.0);
  Cost best;
  best.seconds = 1e9;
  for (int window = 0; window < 8; ++window) {
    Cost cost;
    const double start = cpu_seconds();
    for (int i = 0; i < 4; ++i) cost.add(parcel.rise(scheme, rise, 1.0));
    cost.seconds = cpu_seconds() - start;
    if (cost.seconds < best.seconds) best = cost;
  }
  best.print(fmt::format("cloud, {} droplets", count).c_str(), count);
}

void activation(std::size_t count, const Condensation& scheme, std::size_t parcels) {
  Cost best;
  best.seconds = 1e9;
  for (int window = 0; window < 5; ++window) {
    std::vector<Parcel> all(parcels, Parcel(count, 0.98));
    Cost cost;
    const double start = cpu_seconds();
    for (Parcel& parcel : all)
      for (int i = 0; i < 100; ++i) cost.add(parcel.rise(scheme, 1.0, 1.0));
    cost.seconds = cpu_seconds() - start;
    if (cost.seconds < best.seconds) best = cost;
  }
  best.print(fmt::format("activation, {} x {} droplets", parcels, count).c_str(), count);
}

}  // namespace

int main() {
  const bench::MachineLimits limits = bench::measure_limits();
  fmt::print("core time, best window; triad {:.1f} GB/s, {:.1f} Gflop/s\n", limits.triad,
             limits.arithmetic);
  const Condensation scheme(DropletAir{}, CondensationOptions{});
  cooling(std::size_t{1} << 17, scheme);
  cooling(std::size_t{1} << 12, scheme);
  activation(std::size_t{1} << 12, scheme, 1);
  activation(32, scheme, 64);
  return 0;
}
