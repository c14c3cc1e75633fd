// Time of one call of the two-moment scheme per active parcel, on one core, through the loaded
// library: clouds in steady ascent, with and without rain, and clear air that only diagnoses.
#include <fmt/core.h>
#include <omp.h>

#include <algorithm>
#include <ctime>
#include <vector>

#include "coupling/operator_sequence.hpp"

namespace {

using namespace pileus;
using Settings = std::vector<std::pair<std::string, scene::RawValue>>;

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Layer {
  static constexpr std::size_t parcels = 65536;
  coupling::OperatorSequence sequence;
  parcels::Store store;
  double apply = 0, diagnose = 0;  // s

  explicit Layer(const Settings& settings)
      : sequence(make(settings)), store(3, sequence.required_scalars()) {
    store.resize(parcels);
    for (std::size_t p = 0; p < parcels; ++p) {
      store.uid()[p] = p + 1;
      store.volume()[p] = 1000;
      store.position(2)[p] = 1000 + 200.0 * static_cast<double>(p) / parcels;
      value("air_potential_temperature")[p] = 290;
      value("specific_humidity")[p] = 9e-3;
    }
    sequence.bind(store, {});
    sequence.init({});
  }
  double* value(const char* name) { return store.scalar(store.find_scalar(name)); }

  void rise(double distance, double dt) {
    for (std::size_t p = 0; p < parcels; ++p) store.position(2)[p] += distance;
    const double start = cpu_seconds();
    sequence.diagnose({0, 0, dt});
    const double between = cpu_seconds();
    sequence.apply_after_transport({0, 0, dt});
    apply += cpu_seconds() - between;
    diagnose += between - start;
  }

 private:
  static coupling::OperatorSequence make(const Settings& settings) {
    scene::Scene scene;
    scene::OperatorBlock block;
    block.use = "org.pileus.two_moment";
    block.name = "clouds";
    block.parameters = settings;
    scene.operators.push_back(block);
    scene::Problems problems;
    coupling::SequenceOptions options;
    options.initial = {"air_potential_temperature", "specific_humidity"};
    auto entries =
        coupling::load_operators(scene, {{PILEUS_BINARY_DIR "/lib/pileus/plugins"}}, problems);
    if (!problems.empty()) fmt::print("{}\n", problems.render());
    return {std::move(entries), std::move(options)};
  }
};

/// Best of several windows: the machine may be shared.
void measure(const char* what, const Settings& settings, double rain) {
  constexpr int windows = 12, steps = 4;
  Layer layer(settings);
  for (int i = 0; i < 10; ++i) layer.rise(6, 3);
  if (rain > 0) {
    std::fill_n(layer.value("mass_fraction_of_rain_in_air"), Layer::parcels, rain);
    std::fill_n(layer.value("number_of_raindrops_per_mass_of_air"), Layer::parcels, 1e4);
  }
  double best = 1e9, closure = 1e9;
  for (int w = 0; w < windows; ++w) {
    layer.apply = layer.diagnose = 0;
    for (int i = 0; i < steps; ++i) layer.rise(w % 2 == 0 ? 6 : -6, 3);
    best = std::min(best, layer.apply / steps);
    closure = std::min(closure, layer.diagnose / steps);
  }
  fmt::print("{:<44}{:>9.1f} ns apply{:>9.1f} ns diagnose\n", what, best / Layer::parcels * 1e9,
             closure / Layer::parcels * 1e9);
}

scene::RawValue one(const char* text) {
  return {text, false, {}, {}, {}};
}

}  // namespace

int main() {
  omp_set_num_threads(1);
  fmt::print("core time per parcel and call, best of 12 windows of 4 calls, {} parcels\n",
             Layer::parcels);
  measure("cloud", {}, 0);
  measure("cloud, constant number", {{"activation", one("twomey")}, {"twomey_exponent", one("0")}},
          0);
  measure("cloud and rain, Khairoutdinov & Kogan", {{"collection", one("khairoutdinov_kogan")}},
          1e-4);
  measure("cloud and rain, Seifert & Beheng", {{"collection", one("seifert_beheng")}}, 1e-4);
  return 0;
}
