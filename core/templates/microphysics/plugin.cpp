// Turns cloud water beyond a threshold into rain: what a microphysical scheme looks like at its
// smallest. README.md has the equations.
#include <pileus/plugin.hpp>

#include "rates.hpp"

class MyScheme : public pileus::Operator<MyScheme> {
  pileus::Slot cloud_, rain_;
  pileus::Param threshold_, rate_;

 public:
  void describe(pileus::Declaration& d) {
    d.op.id = "org.example.my_scheme";
    d.op.kind = "microphysics";
    d.op.version = "0.1.0";
    d.op.title = "My scheme";
    d.op.summary = "Turns cloud water beyond a threshold into rain, exactly for any time step.";
    d.op.authors = "Your name";
    d.op.licence = "Apache-2.0";
    d.op.form = PILEUS_FLOW;
    d.provides("autoconversion");
    d.cites("10.1007/978-1-935704-36-2_1", "Kessler 1969: autoconversion");
    d.budget("water");
    cloud_ = d.updates("mass_fraction_of_cloud_liquid_water_in_air", "1")
                 .intensive("water")
                 .range(0.0, 1.0)
                 .doc("from the scene or from a scheme that condenses");
    rain_ = d.owns("mass_fraction_of_rain_in_air", "1").intensive("water").range(0.0, 2.0);
    threshold_ = d.number("threshold", "1", 1e-3).range(0.0, 1.0).doc("cloud that stays cloud, a");
    rate_ = d.number("rate", "s-1", 1e-3).range(0.0, 1.0).doc("inverse time of conversion, k");
    // Where this does not hold, apply changes nothing, so that the core may skip the parcel.
    d.active_if_parameter(0, "mass_fraction_of_cloud_liquid_water_in_air", PILEUS_GT, "threshold");
  }

  void apply(const pileus_step& step, pileus::Block block) const {
    double* cloud = block.out(cloud_);
    double* rain = block.out(rain_);
    block.each([&](auto p) {
      const double left = rates::cloud_left(cloud[p], value(threshold_), value(rate_), step.dt);
      if (left == cloud[p]) return;
      rain[p] += cloud[p] - left;  // what leaves one arrives in the other
      cloud[p] = left;
    });
  }
};
PILEUS_PLUGIN(MyScheme, "org.example.my_scheme", "0.1.0");
