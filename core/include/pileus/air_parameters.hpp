// The parameters that plugins for real air share: constants, reference state, saturation formula.
#pragma once
#include <span>

#include "declaration.hpp"
#include "piecewise_linear.hpp"
#include "plugin.hpp"
#include "reference_state.hpp"
#include "thermo.hpp"

namespace pileus {

/// Declares the profile of the hydrostatic reference state and the constants it depends on, so that
/// all plugins name them alike and a scene can state them once with a YAML anchor. The readers take
/// the operator's accessors: `number(Param)` returns a double, `list(Param)` a span.
struct ReferenceParameters {
  Param gravity, heat_capacity, base_height;
  Param surface_pressure, gas_constant, reference_height, reference_theta_v;

  /// What ideal and real air have in common.
  void describe_reference_constants(Declaration& d) {
    gravity = d.number("gravity", "m s-2", 9.81).range(1e-3, 1e3).doc("acceleration of gravity");
    heat_capacity = d.number("heat_capacity", "J kg-1 K-1", 1005.0)
                        .range(1.0, 1e6)
                        .doc("of dry air at constant pressure");
    base_height = d.number("base_height", "m", 0.0)
                      .range(-1e6, 1e6)
                      .doc("height of the surface humidity or surface pressure");
  }

  /// What real air adds. `when` as in Declaration, NULL: always.
  void describe_reference_profile(Declaration& d, const char* when = nullptr) {
    surface_pressure = d.number("surface_pressure", "Pa", 1.0e5)
                           .range(1e3, 2e5)
                           .when(when)
                           .doc("reference pressure at the base height");
    gas_constant = d.number("gas_constant_dry_air", "J kg-1 K-1", 287.04)
                       .range(1.0, 1e4)
                       .when(when)
                       .doc("of dry air");
    reference_height = d.numbers("reference_height", "m", 0.0)
                           .range(-1e6, 1e6)
                           .when(when)
                           .doc("heights of the reference profile, ascending");
    reference_theta_v = d.numbers("reference_potential_temperature", "K", 300.0)
                            .range(50.0, 2000.0)
                            .when(when)
                            .doc(
                                "virtual potential temperature of the hydrostatic reference "
                                "state at those heights; buoyancy is measured from it");
  }

  /// Errors  Failure(PILEUS_E_CONFIG) for lists of different length or heights that do not ascend
  template <class Number, class List>
  thermo::ReferenceState reference_state(Number&& number, List&& list,
                                         const thermo::Constants& constants) const {
    const std::span<const double> heights = list(reference_height);
    const std::span<const double> theta_v = list(reference_theta_v);
    if (heights.size() != theta_v.size()) {
      throw Failure(
          "reference_height and reference_potential_temperature differ in their number of "
          "values; give one temperature for each height",
          PILEUS_E_CONFIG);
    }
    require_ascending("reference_height", heights);
    return {heights, theta_v, number(base_height), number(surface_pressure), constants};
  }
};

/// Declares the constants of moist air and its reference state.
struct AirParameters : ReferenceParameters {
  Param latent_heat, buoyancy_temperature, epsilon, saturation_pressure;

  /// What ideal and real air have in common.
  void describe_constants(Declaration& d) {
    describe_reference_constants(d);
    latent_heat = d.number("latent_heat", "J kg-1", 2.5e6).range(1.0, 1e9).doc("of vaporisation");
    buoyancy_temperature = d.number("buoyancy_temperature", "K", 300.0)
                               .range(1.0, 1e4)
                               .doc("constant temperature that scales the buoyancy, theta_00");
  }

  /// What real air adds. `when` as in Declaration, NULL: always.
  void describe_real_air(Declaration& d, const char* when = nullptr) {
    describe_reference_profile(d, when);
    epsilon = d.number("epsilon", "1", 0.622)
                  .range(0.01, 0.99)
                  .when(when)
                  .doc("ratio of the gas constants of dry air and vapour");
    saturation_pressure =
        d.choice("saturation_pressure", {"bolton", "tetens", "magnus", "buck", "murphy_koop"})
            .when(when)
            .doc("formula of the saturation vapour pressure");
  }

  template <class Number>
  thermo::Constants constants(Number&& number) const {
    return {number(gravity), number(gas_constant), number(heat_capacity), number(latent_heat),
            number(epsilon)};
  }

  /// Errors  as ReferenceParameters::reference_state
  template <class Number, class List>
  thermo::ReferenceState reference_state(Number&& number, List&& list) const {
    return ReferenceParameters::reference_state(number, list, constants(number));
  }
};

}  // namespace pileus
