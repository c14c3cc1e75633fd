// What a scene may say about the ground.
#pragma once
#include <pileus/plugin.hpp>

#include <limits>

#include "air_exchange.hpp"

namespace pileus::surface {

struct Parameters {
  Param scalar_flux, heat_flux, moisture_flux, buoyancy_flux, theta, humidity;
  Param momentum, friction_velocity, stress, stress_depth;
  Param roughness, roughness_length, heat_roughness_length, charnock, viscosity;
  Param momentum_coefficient, heat_coefficient, moisture_coefficient, coefficient_height;
  Param functions, von_karman, gravity, reference_temperature, gustiness, gust_depth;
  Param step_limit;

  void describe(Declaration& d) {
    describe_fluxes(d);
    describe_stress(d);
    describe_roughness(d);
    describe_coefficients(d);
    describe_similarity(d);
    static constexpr double ladder[] = {1.0, 0.5, 0.25, std::numeric_limits<double>::quiet_NaN()};
    step_limit = d.number("step_limit_factor", "1", 0.5)
                     .range(1e-3, 100.0)
                     .knob(ladder)
                     .doc("time step over the time in which the ground heats or drags a cell");
  }

  /// `number` is the operator's accessor of a parameter, `word` that of a choice.
  template <class Number, class Word>
  ExchangeSettings settings(Number&& number, Word&& word) const {
    ExchangeSettings s;
    s.scalar_flux = static_cast<ScalarFlux>(word(scalar_flux));
    s.momentum = static_cast<Momentum>(word(momentum));
    s.similarity = {static_cast<StabilityFunctions>(word(functions)),
                    number(von_karman),
                    number(gravity),
                    number(reference_temperature),
                    number(gustiness),
                    number(gust_depth)};
    s.waves = word(roughness) == 1;
    s.sea = {number(charnock), number(viscosity), number(gravity)};
    const double z0 = number(roughness_length), z0h = number(heat_roughness_length);
    s.layer = {0.0, z0, z0h > 0 ? z0h : z0};
    s.bulk = {number(momentum_coefficient), number(heat_coefficient), number(moisture_coefficient),
              number(coefficient_height)};
    return s;
  }

 private:
  void describe_fluxes(Declaration& d) {
    constexpr const char* given = "scalar_flux == prescribed";
    constexpr const char* interactive = "scalar_flux != prescribed";
    scalar_flux = d.choice("scalar_flux", {"prescribed", "bulk", "monin_obukhov"})
                      .doc(
                          "how heat and moisture leave the ground: as stated, by coefficients, or "
                          "by similarity theory");
    heat_flux = d.series("heat_flux", "K m s-1", 0.0)
                    .range(-100.0, 100.0)
                    .when(given)
                    .doc("of potential temperature, upward");
    moisture_flux = d.series("moisture_flux", "m s-1", 0.0)
                        .range(-1.0, 1.0)
                        .when(given)
                        .doc("of the mass fraction of water, upward");
    buoyancy_flux = d.series("buoyancy_flux", "m2 s-3", 0.0)
                        .range(-10.0, 10.0)
                        .when(given)
                        .doc("for parcels that carry buoyancy, beside what heat_flux is in it");
    theta = d.series("surface_potential_temperature", "K", 300.0)
                .range(100.0, 1000.0)
                .when(interactive)
                .doc("of the ground");
    humidity = d.series("surface_humidity", "1", 0.0)
                   .range(0.0, 1.0)
                   .when(interactive)
                   .doc("mass fraction of water at the ground; over the sea 0.98 of saturation");
  }
  void describe_stress(Declaration& d) {
    momentum = d.choice("momentum", {"none", "friction_velocity", "bulk", "monin_obukhov"})
                   .doc("how the ground drags the wind; none: free slip");
    friction_velocity = d.series("friction_velocity", "m s-1", 0.0)
                            .range(0.0, 10.0)
                            .when("momentum == friction_velocity")
                            .doc("u*: the stress is u*² against the wind");
    stress = d.choice("stress", {"local", "plane_mean"})
                 .doc(
                     "exchange with the air of each point, or that of the mean over the plane, "
                     "distributed as Moeng 1984 does");
    static constexpr double ladder[] = {1.0, 2.0, 3.0, 4.0,
                                        std::numeric_limits<double>::quiet_NaN()};
    stress_depth =
        d.integer("stress_depth_in_cells", 1)
            .range(1, 32)
            .knob(ladder)
            .when("momentum != none")
            .doc(
                "height, in cells, up to which eddies that the mesh does not resolve hand "
                "on a part of the stress");
  }
  void describe_roughness(Declaration& d) {
    roughness = d.choice("roughness", {"given", "charnock"})
                    .doc("as stated, or that of the sea under the stress");
    roughness_length = d.number("roughness_length", "m", 1e-4)
                           .range(1e-8, 100.0)
                           .doc(
                               "z_0, below half the height of a cell, and below "
                               "coefficient_height where a bulk coefficient is used");
    heat_roughness_length = d.number("heat_roughness_length", "m", 0.0)
                                .range(0.0, 100.0)
                                .doc("z_0h of heat and water; 0: that of the wind");
    charnock = d.number("charnock_parameter", "1", 0.011)
                   .range(0.0, 1.0)
                   .when("roughness == charnock")
                   .doc("α: 0.011 below 10 m/s to 0.018 above 18 m/s");
    viscosity = d.number("air_viscosity", "m2 s-1", 1.5e-5)
                    .range(1e-6, 1e-3)
                    .when("roughness == charnock")
                    .doc("ν: smooth flow has the roughness 0.11 ν/u*");
  }
  void describe_coefficients(Declaration& d) {
    momentum_coefficient =
        d.number("momentum_coefficient", "1", 0.001229).range(0.0, 1.0).doc("C_m of bulk formulas");
    heat_coefficient =
        d.number("heat_coefficient", "1", 0.001094).range(0.0, 1.0).doc("C_h of bulk formulas");
    moisture_coefficient =
        d.number("moisture_coefficient", "1", 0.001133).range(0.0, 1.0).doc("C_q of bulk formulas");
    coefficient_height =
        d.number("coefficient_height", "m", 20.0)
            .range(0.1, 1e3)
            .doc("the coefficients are those of this height; adjusted to the first level");
  }
  void describe_similarity(Declaration& d) {
    functions = d.choice("stability_functions", {"businger_dyer", "wilson"})
                    .doc("of similarity theory: Dyer 1974, or Wilson 2001 and the IFS");
    von_karman = d.number("von_karman_constant", "1", 0.4).range(0.3, 0.5).doc("κ");
    gravity = d.number("gravity", "m s-2", 9.81).range(1e-3, 1e3).doc("acceleration of gravity");
    reference_temperature = d.number("reference_temperature", "K", 300.0)
                                .range(1.0, 1e4)
                                .doc("constant temperature that scales the buoyancy, theta_00");
    gustiness = d.number("gustiness", "1", 1.2)
                    .range(0.0, 10.0)
                    .doc("β: gusts have β times the convective velocity scale; 0: none");
    gust_depth = d.number("gust_depth", "m", 1000.0)
                     .range(0.0, 1e4)
                     .doc("depth of the convective layer in that scale");
  }
};

}  // namespace pileus::surface
