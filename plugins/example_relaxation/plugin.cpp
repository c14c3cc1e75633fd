// Relaxes each parcel's tracer towards one value: the smallest complete plugin.
#include <pileus/numerics.hpp>
#include <pileus/plugin.hpp>

class Relaxation : public pileus::Operator<Relaxation> {
  pileus::Slot tracer_;
  pileus::Param time_scale_, target_;

 public:
  void describe(pileus::Declaration& d) {
    d.op.id = "org.pileus.example_relaxation";
    d.op.kind = "forcing";
    d.op.version = "1.0.0";
    d.op.title = "Relaxation towards a value";
    d.op.summary = "Relaxes a tracer towards a fixed value, exactly for any time step.";
    d.op.authors = "Pileus contributors";
    d.op.licence = "Apache-2.0";
    d.op.form = PILEUS_FLOW;
    d.provides("tracer_relaxation");
    d.cites(nullptr, "no reference: the exact solution of a linear equation");
    tracer_ = d.owns("passive_tracer", "1").intensive().range(-1e6, 1e6).doc("the tracer relaxed");
    time_scale_ = d.number("time_scale", "s", 3600).range(1e-3, 1e9).doc("e-folding time");
    target_ = d.number("target", "1", 0).range(-1e6, 1e6).doc("value relaxed to");
  }

  void apply(const pileus_step& step, pileus::Block block) const {
    const double ratio = step.dt / value(time_scale_), goal = value(target_);
    double* q = block.out(tracer_);
    block.each([&](auto p) { q[p] = pileus::numerics::relaxed(q[p], goal, ratio); });
  }
};
PILEUS_PLUGIN(Relaxation, "org.pileus.example_relaxation", "1.0.0");
