// Small operators, linked into the test, that behave in one known way each.
#pragma once
#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "coupling/operator_sequence.hpp"
#include "pileus/numerics.hpp"
#include "pileus/plugin.hpp"

namespace pileus::test {

/// The texts every operator must declare.
inline void introduce(Declaration& d, const char* id) {
  d.op.id = id;
  d.op.kind = "test";
  d.op.version = "1.0.0";
  d.op.title = d.op.summary = d.op.authors = "test";
  d.op.licence = "MIT";
  d.op.form = PILEUS_FLOW;
}

/// An entry of the sequence from an operator class.
template <class Op>
coupling::OperatorEntry entry_of(const std::string& name) {
  std::vector<std::string> complaints;
  auto table = std::make_shared<host::OperatorTable>(host::read_operator(Op::table(), complaints));
  if (!complaints.empty()) throw std::logic_error(complaints.front());
  table->library = "the test";
  return {name, table, host::ParameterValues(*table), 0};
}

/// Explicit Euler for dq/dt = −q that rejects steps above a parcel's own limit, 1 s / (1 + uid %
/// 5).
class FussyEuler : public Operator<FussyEuler> {
 public:
  void describe(Declaration& d) {
    introduce(d, "test.fussy_euler");
    tracer = d.owns("passive_tracer", "1").intensive().range(0, 10).initial(1);
  }
  void apply(const pileus_step& step, Block block) const {
    double* q = block.out(tracer);
    block.each([&](auto p) {
      q[p] -= step.dt * q[p];
      if (step.dt > 1.0 / (1.0 + static_cast<double>(block.uid(p) % 5))) throw Retry("too long");
    });
  }

 private:
  Slot tracer;
};

/// Grows q by a keyed random factor where q > 1.
class RandomGrowth : public Operator<RandomGrowth> {
 public:
  static inline std::atomic<int> parcels_seen = 0;
  void describe(Declaration& d) {
    introduce(d, "test.random_growth");
    d.op.flags = PILEUS_RANDOM;
    tracer = d.owns("passive_tracer", "1").intensive("matter").range(0, 1e6).initial(1);
    matter = d.budget("matter");
    d.active_if(0, "passive_tracer", PILEUS_GT, 1.0);
    volume = d.reads("parcel_volume", "m3");
  }
  void apply(const pileus_step& step, Block block) const {
    double* q = block.out(tracer);
    const double* v = block.in(volume);
    block.each([&](auto p) {
      ++parcels_seen;
      double u;
      draw(step, block.uid(p), 0, 1, &u);
      const double gain = q[p] > 1.0 ? step.dt * u : 0.0;
      q[p] += gain;
      block.book(matter, gain * v[p]);
    });
  }

 private:
  Slot tracer, volume;
  Budget matter;
};

/// Claims to be inactive up to 2 but changes whatever is above 1.5.
class FalselyIdle : public Operator<FalselyIdle> {
 public:
  void describe(Declaration& d) {
    introduce(d, "test.falsely_idle");
    tracer = d.owns("passive_tracer", "1").intensive().range(0, 1e6).initial(1);
    d.active_if(0, "passive_tracer", PILEUS_GT, 2.0);
  }
  void apply(const pileus_step&, Block block) const {
    double* q = block.out(tracer);
    block.each([&](auto p) {
      if (q[p] > 1.5) q[p] += 1;
    });
  }

 private:
  Slot tracer;
};

/// Derives a buoyancy of 1 and, where condensation is on, a liquid water of 0.25.
class Condenser : public Operator<Condenser> {
 public:
  void describe(Declaration& d) {
    introduce(d, "test.condenser");
    d.op.form = PILEUS_CLOSURE;
    d.provides("condensation");
    d.provides("buoyancy");
    buoyancy = d.derives("buoyancy", "m s-2");
    liquid = d.derives("mass_fraction_of_cloud_liquid_water_in_air", "1")
                 .range(0.25, 0.25)
                 .when("effect.condensation == on");
  }
  void diagnose(const pileus_step&, Block block) const {
    std::fill_n(block.out(buoyancy), block.count(), 1.0);
    if (block.has(liquid)) std::fill_n(block.out(liquid), block.count(), 0.25);
  }

 private:
  Slot buoyancy, liquid;
};

/// Derives a buoyancy of the height and, on demand, a temperature of it; counts how often.
class Thermometer : public Operator<Thermometer> {
 public:
  static inline std::atomic<int> buoyancies = 0, temperatures = 0;
  void describe(Declaration& d) {
    introduce(d, "test.thermometer");
    d.op.form = PILEUS_CLOSURE;
    d.provides("buoyancy");
    height = d.reads("height", "m");
    buoyancy = d.derives("buoyancy", "m s-2");
    temperature = d.derives("air_temperature", "K").on_demand();
  }
  void diagnose(const pileus_step&, Block block) const {
    std::copy_n(block.in(height), block.count(), block.out(buoyancy));
    ++buoyancies;
    if (!block.has(temperature)) return;
    std::copy_n(block.in(height), block.count(), block.out(temperature));
    ++temperatures;
  }

 private:
  Slot height, buoyancy, temperature;
};

/// Derives a humidity from the temperature.
class Hygrometer : public Operator<Hygrometer> {
 public:
  void describe(Declaration& d) {
    introduce(d, "test.hygrometer");
    d.op.form = PILEUS_CLOSURE;
    temperature = d.reads("air_temperature", "K");
    humidity = d.derives("relative_humidity", "1");
  }
  void diagnose(const pileus_step&, Block block) const {
    std::copy_n(block.in(temperature), block.count(), block.out(humidity));
  }

 private:
  Slot temperature, humidity;
};

/// Counts its calls and provides one effect.
class Counter : public Operator<Counter> {
 public:
  static inline std::atomic<int> calls = 0;
  void describe(Declaration& d) {
    introduce(d, "test.counter");
    d.provides("counting");
    tracer = d.owns("passive_tracer", "1").intensive().initial(3);
  }
  void apply(const pileus_step&, Block) const { ++calls; }

 private:
  Slot tracer;
};

/// dx/dt = y, exactly, for x = specific humidity and y = passive tracer.
class Drift : public Operator<Drift> {
 public:
  void describe(Declaration& d) {
    introduce(d, "test.drift");
    x = d.owns("specific_humidity", "1").intensive().range(-10, 10).initial(1);
    y = d.reads("passive_tracer", "1");
  }
  void apply(const pileus_step& step, Block block) const {
    double* out = block.out(x);
    const double* in = block.in(y);
    block.each([&](auto p) { out[p] += step.dt * in[p]; });
  }

 private:
  Slot x, y;
};

/// dy/dt = −x, exactly. Drift and Kick together are the harmonic oscillator x = cos t, y = −sin t.
class Kick : public Operator<Kick> {
 public:
  void describe(Declaration& d) {
    introduce(d, "test.kick");
    y = d.owns("passive_tracer", "1").intensive().range(-10, 10).initial(0);
    x = d.reads("specific_humidity", "1");
  }
  void apply(const pileus_step& step, Block block) const {
    double* out = block.out(y);
    const double* in = block.in(x);
    block.each([&](auto p) { out[p] -= step.dt * in[p]; });
  }

 private:
  Slot x, y;
};

/// A stiff explicit decay that asks for sub-steps of at most 0.1 s.
class Substepped : public Operator<Substepped> {
 public:
  void describe(Declaration& d) {
    introduce(d, "test.substepped");
    tracer = d.owns("passive_tracer", "1").intensive().range(0, 10).initial(1);
  }
  double prepare(const pileus_step&, Block) { return 0.1; }
  void apply(const pileus_step& step, Block block) const {
    double* q = block.out(tracer);
    block.each([&](auto p) { q[p] -= step.dt * q[p]; });
  }

 private:
  Slot tracer;
};

/// A run of parcels of volume 2 at height 100 + p, uid 1 + p.
struct ToyRun {
  ToyRun(std::vector<coupling::OperatorEntry> entries, std::size_t parcels,
         coupling::SequenceOptions options = {}, std::optional<pileus_grid> grid = {})
      : sequence(std::move(entries), std::move(options)),
        store(3, sequence.required_scalars(), sequence.required_items()) {
    store.resize(parcels);
    for (int c = 0; c < store.column_count(); ++c) std::fill_n(store.column(c), parcels, 0.0);
    for (std::size_t p = 0; p < parcels; ++p) {
      store.uid()[p] = 1 + p;
      store.volume()[p] = 2.0;
      store.position(2)[p] = 100.0 + static_cast<double>(p);
    }
    sequence.bind(store, grid);
    sequence.init({});
  }
  double* values(const char* name) { return store.scalar(store.find_scalar(name)); }
  void step(std::uint64_t number, double dt) {
    const coupling::StepTime at{number, static_cast<double>(number) * dt, dt};
    sequence.apply_before_transport(at);
    sequence.apply_after_transport(at);
  }

  coupling::OperatorSequence sequence;
  parcels::Store store;
};

template <class... Ops>
std::vector<coupling::OperatorEntry> entries_of(const std::vector<std::string>& names) {
  std::vector<coupling::OperatorEntry> entries;
  std::size_t i = 0;
  (entries.push_back(entry_of<Ops>(names[i++])), ...);
  return entries;
}

}  // namespace pileus::test
