// Relaxes the buoyancy towards a profile, as radiation does in its simplest form: what a forcing
// looks like at its smallest. README.md has the equations.
#include <pileus/plugin.hpp>

#include "rates.hpp"

class MyScheme : public pileus::Operator<MyScheme> {
  pileus::Slot height_, buoyancy_;
  pileus::Param time_scale_, equilibrium_;
  pileus::PiecewiseLinear profile_;

 public:
  void describe(pileus::Declaration& d) {
    d.op.id = "org.example.my_scheme";
    d.op.kind = "forcing";
    d.op.version = "0.1.0";
    d.op.title = "My scheme";
    d.op.summary = "Relaxes the buoyancy towards a profile, exactly for any time step.";
    d.op.authors = "Your name";
    d.op.licence = "Apache-2.0";
    d.op.form = PILEUS_FLOW;
    d.provides("newtonian_cooling");
    d.cites("10.1175/1520-0477(1994)075<1825:APFTIO>2.0.CO;2",
            "Held & Suarez 1994: Newtonian cooling");
    height_ = d.reads("height", "m").doc("where the profile is taken");
    buoyancy_ = d.updates("buoyancy", "m s-2").intensive().range(-1e4, 1e4);
    time_scale_ = d.number("time_scale", "s", 86400).range(1e-3, 1e9).doc("of relaxation, tau");
    equilibrium_ = d.profile("equilibrium", "m s-2", 0.0)
                       .range(-1e3, 1e3)
                       .doc("buoyancy relaxed to, a function of height, b_eq");
  }

  void configured() { profile_ = profile(equilibrium_); }

  void apply(const pileus_step& step, pileus::Block block) const {
    const double* z = block.in(height_);
    double* b = block.out(buoyancy_);
    block.each(
        [&](auto p) { b[p] = rates::cooled(b[p], profile_(z[p]), step.dt, value(time_scale_)); });
  }
};
PILEUS_PLUGIN(MyScheme, "org.example.my_scheme", "0.1.0");
