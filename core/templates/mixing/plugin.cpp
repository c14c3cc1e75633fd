// Mixes a tracer between parcels through the mean of their surroundings: what a mixing scheme looks
// like at its smallest. README.md has the equations.
#include <pileus/mesh.hpp>

#include "rates.hpp"

class MyScheme : public pileus::Operator<MyScheme> {
  pileus::Slot tracer_;
  pileus::Param time_scale_;
  pileus::Mesh mesh_;

 public:
  void describe(pileus::Declaration& d) {
    d.op.id = "org.example.my_scheme";
    d.op.kind = "mixing";
    d.op.version = "0.1.0";
    d.op.title = "My scheme";
    d.op.summary =
        "Relaxes a tracer towards the mean of its surroundings, conserving and without new "
        "extrema.";
    d.op.authors = "Your name";
    d.op.licence = "Apache-2.0";
    d.op.form = PILEUS_FLOW;
    d.op.scope = PILEUS_GLOBAL;  // one call sees all parcels
    d.op.repeatability = PILEUS_REPEAT_THREADS;
    d.provides("small_scale_mixing");
    d.cites("10.1016/0094-5765(74)90050-2", "Dopazo & O'Brien 1974: interaction with the mean");
    d.budget("tracer");
    tracer_ = d.owns("passive_tracer", "1").intensive("tracer");
    time_scale_ = d.number("time_scale", "s", 600).range(1e-3, 1e9).doc("of the exchange, tau");
  }

  void configured() { mesh_ = pileus::Mesh(host()); }

  void apply(const pileus_step& step, pileus::Block block) const {
    const double share = rates::share_exchanged(step.dt, value(time_scale_));
    if (share == 0) return;
    const std::int64_t parcels = block.count();
    double* q = block.out(tracer_);
    double* field = block.scratch(mesh_.field_size()).data();
    double* mean = block.scratch(static_cast<std::size_t>(parcels)).data();

    const double* gathered[] = {q};
    mesh_.deposit(parcels, gathered, field);
    // Record by record: [0] the volume at the node, [1] the mean of the tracer there. The first
    // value is what comes back to the parcels.
    const std::size_t width = mesh_.width();
    for (std::size_t node = 0; node < mesh_.nodes(); ++node) {
      field[node * width] = field[node * width + 1];
    }
    double* at_parcels[] = {mean};
    mesh_.interpolate(parcels, field, at_parcels);
    // The weights of both ways are the same, so that the sum over the parcels stays (pileus/abi.h).
    parallel_for(parcels, [&](std::int64_t p) { q[p] += share * (mean[p] - q[p]); });
  }
};
PILEUS_PLUGIN(MyScheme, "org.example.my_scheme", "0.1.0");
