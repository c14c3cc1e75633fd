// What a scene may say about the forcing.
#pragma once
#include <pileus/plugin.hpp>

namespace pileus::large_scale {

struct Parameters {
  Param subsidence_velocity, subsidence_of;
  Param temperature_tendency, water_tendency, buoyancy_tendency, gravity, reference_temperature;
  Param push_x, push_y, wind_nudging_time, target_x, target_y, geostrophic, geostrophic_x,
      geostrophic_y;
  Param sponge_rate, sponge_of;

  void describe(Declaration& d) {
    describe_scalars(d);
    describe_wind(d);
    sponge_rate = d.profile("sponge_rate", "s-1", 0.0)
                      .range(0.0, 1e3)
                      .doc("at which parcels are relaxed towards the mean of their level");
    sponge_of = d.choice("sponge_of", {"vorticity", "vorticity_and_scalars"})
                    .doc("what the sponge relaxes");
  }

 private:
  void describe_scalars(Declaration& d) {
    subsidence_velocity = d.profile("subsidence_velocity", "m s-1", 0.0)
                              .range(-10.0, 10.0)
                              .doc("large-scale vertical velocity, negative where air sinks");
    subsidence_of = d.choice("subsidence_of", {"scalars", "scalars_and_wind"})
                        .doc("what it carries down: -w times the gradient of the level's mean");
    temperature_tendency = d.profile("potential_temperature_tendency", "K s-1", 0.0)
                               .range(-1.0, 1.0)
                               .doc(
                                   "of the potential temperature that parcels carry; of their "
                                   "buoyancy where they carry none");
    water_tendency = d.profile("total_water_tendency", "s-1", 0.0)
                         .range(-1e-2, 1e-2)
                         .doc("of the total water, or of the vapour where that is carried");
    buoyancy_tendency = d.profile("buoyancy_tendency", "m s-3", 0.0)
                            .range(-1.0, 1.0)
                            .doc("of the buoyancy, where that is carried");
    gravity = d.number("gravity", "m s-2", 9.81)
                  .range(0.0, 100.0)
                  .doc("with reference_temperature, turns heating into buoyancy");
    reference_temperature = d.number("reference_temperature", "K", 300.0)
                                .range(100.0, 1000.0)
                                .doc("of the buoyancy, theta_00");
  }

  void describe_wind(Declaration& d) {
    push_x = push(d, "x_wind_tendency", "of the wind, as by a pressure gradient");
    push_y = push(d, "y_wind_tendency", "the same across");
    wind_nudging_time = d.number("wind_nudging_time", "s", 0.0)
                            .range(0.0, 1e9)
                            .doc("in which the mean wind approaches the target e-fold; 0: never");
    constexpr const char* nudged = "wind_nudging_time != 0";
    target_x =
        wind(d, "target_x_velocity", "wind that the mean wind is nudged to; 0: rest").when(nudged);
    target_y = wind(d, "target_y_velocity", "the same across").when(nudged);
    geostrophic = d.toggle("geostrophic", false)
                      .doc("whether a pressure gradient balances the geostrophic wind");
    geostrophic_x =
        wind(d, "geostrophic_x_velocity", "geostrophic wind").when("geostrophic == true");
    geostrophic_y =
        wind(d, "geostrophic_y_velocity", "the same across").when("geostrophic == true");
  }
  static Declaration::Parameter push(Declaration& d, const char* name, const char* doc) {
    return d.profile(name, "m s-2", 0.0).range(-10.0, 10.0).doc(doc);
  }
  static Declaration::Parameter wind(Declaration& d, const char* name, const char* doc) {
    return d.profile(name, "m s-1", 0.0).range(-500.0, 500.0).doc(doc);
  }
};

}  // namespace pileus::large_scale
