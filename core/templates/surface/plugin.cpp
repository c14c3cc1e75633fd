// Exchanges a tracer between the ground and the air just above it: what a surface scheme looks like
// at its smallest. README.md has the equations.
#include <pileus/plugin.hpp>

#include "rates.hpp"

class MyScheme : public pileus::Operator<MyScheme> {
  pileus::Slot height_, volume_, tracer_;
  pileus::Param depth_, velocity_, surface_;
  pileus::Budget budget_;

 public:
  void describe(pileus::Declaration& d) {
    d.op.id = "org.example.my_scheme";
    d.op.kind = "surface";
    d.op.version = "0.1.0";
    d.op.title = "My scheme";
    d.op.summary =
        "Exchanges a tracer between the ground and the lowest air by a transfer velocity.";
    d.op.authors = "Your name";
    d.op.licence = "Apache-2.0";
    d.op.form = PILEUS_FLOW;
    d.provides("surface_exchange_of_tracer");
    d.cites("10.1016/S1352-2310(99)00467-7", "Wesely & Hicks 2000: flux by transfer velocity");
    budget_ = d.budget("tracer");
    height_ = d.reads("height", "m").doc("of the parcel's centre, above the ground at 0 m");
    volume_ = d.reads("parcel_volume", "m3").doc("weights what is booked");
    tracer_ = d.owns("passive_tracer", "1").intensive("tracer").range(-1e6, 1e6);
    depth_ = d.number("layer_depth", "m", 100)
                 .range(1e-3, 1e5)
                 .doc("of the air that exchanges with the ground, h");
    velocity_ = d.number("transfer_velocity", "m s-1", 0.01).range(0.0, 10.0).doc("C");
    surface_ = d.number("surface_value", "1", 1).range(-1e5, 1e5).doc("at the ground, q_s");
    // Air above the layer is skipped: apply would leave it as it is.
    d.active_if_parameter(0, "height", PILEUS_LE, "layer_depth");
  }

  void apply(const pileus_step& step, pileus::Block block) const {
    const double* z = block.in(height_);
    const double* volume = block.in(volume_);
    double* q = block.out(tracer_);
    double gained = 0;
    block.each([&](auto p) {
      if (!(z[p] <= value(depth_))) return;
      const double after =
          rates::exchanged(q[p], value(surface_), value(velocity_), value(depth_), step.dt);
      gained += volume[p] * (after - q[p]);
      q[p] = after;
    });
    block.book(budget_, gained);  // from outside: the ground is no part of the air
  }
};
PILEUS_PLUGIN(MyScheme, "org.example.my_scheme", "0.1.0");
