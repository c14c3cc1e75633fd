// The parameters of the two-moment scheme and what is built from them.
#pragma once
#include <pileus/air_parameters.hpp>
#include <pileus/plugin.hpp>

#include <vector>

#include "condensation.hpp"

namespace pileus::two_moment {

enum class Collection { none, khairoutdinov_kogan, seifert_beheng };

inline constexpr const char* with_rain = "collection != none";
inline constexpr const char* condensing = "effect.condensation == on";
inline constexpr const char* collecting = "collection != none and effect.collection == on";
inline constexpr const char* with_twomey = "activation == twomey";
inline constexpr const char* with_modes = "activation != twomey";
inline constexpr const char* with_profile = "temperature == reference_profile";
inline constexpr const char* with_carried_aerosol = "aerosol == carried";
inline constexpr const char* with_derived_buoyancy = "buoyancy == derived";
inline constexpr const char* with_peak =
    "largest_supersaturation == kept and effect.condensation == on";

struct Parameters {
  AirParameters air;
  Param humidity, temperature, profile_theta, buoyancy;
  Param activation, aerosol, aerosol_number, aerosol_radius, aerosol_deviation, aerosol_kappa;
  Param aerosol_density, twomey_coefficient, twomey_exponent, twomey_limit;
  Param surface_tension, embryo_radius, substep_fraction, spectrum, collection, peak;

  void describe(Declaration& d) {
    air.describe_constants(d);
    air.describe_real_air(d);
    humidity = d.choice("saturation_humidity", {"specific_humidity", "mixing_ratio"})
                   .doc("what vapour is measured by: per mass of moist or of dry air");
    temperature = d.choice("temperature", {"prognostic", "reference_profile"})
                      .doc(
                          "from the parcel's potential temperature, or a function of height alone "
                          "without latent heating");
    profile_theta = d.numbers("profile_potential_temperature", "K", 300.0)
                        .range(50.0, 2000.0)
                        .when(with_profile)
                        .doc("potential temperature of that profile at reference_height");
    buoyancy = d.choice("buoyancy", {"derived", "carried"})
                   .doc("from temperature, vapour and loading, or left to the initial state");
    describe_activation(d);
    embryo_radius = d.number("embryo_radius", "m", 1e-6)
                        .range(1e-8, 1e-5)
                        .doc("of a droplet when it is activated; 0.3 um is closer to bin models");
    static constexpr double ladder[] = {2.0,  1.0, 0.5,
                                        0.25, 0.1, std::numeric_limits<double>::quiet_NaN()};
    substep_fraction = d.number("substep_fraction", "1", 0.5)
                           .range(1e-3, 100.0)
                           .knob(ladder)
                           .doc(
                               "sub-steps while supersaturation rises to a peak, in units of the "
                               "relaxation time and of the time to the peak");
    spectrum = d.choice("droplet_spectrum", {"monodisperse", "gamma"})
                   .doc("of droplet sizes about their mean mass");
    collection = d.choice("collection", {"none", "khairoutdinov_kogan", "seifert_beheng"})
                     .doc("collisions of drops; rain is carried only with it");
    peak = d.choice("largest_supersaturation", {"forgotten", "kept"})
               .doc(
                   "whether parcels remember the largest supersaturation they have met, within "
                   "steps too");
  }

  void describe_activation(Declaration& d) {
    activation = d.choice("activation", {"kappa_lognormal", "twomey", "arg2000"})
                     .doc(
                         "nuclei by the parcel's own supersaturation (kappa_lognormal, twomey) or "
                         "by the peak that its forcing implies (arg2000)");
    aerosol = d.choice("aerosol", {"fixed", "carried"})
                  .doc("the same everywhere and never used up, or a number on every parcel");
    aerosol_number = d.numbers("aerosol_number", "m-3", 1e8)
                         .range(0.0, 1e14)
                         .when(with_modes)
                         .doc("particles of each lognormal mode");
    aerosol_radius = d.numbers("aerosol_radius", "m", 5e-8)
                         .range(1e-9, 1e-5)
                         .when(with_modes)
                         .doc("geometric mean dry radius of each mode");
    aerosol_deviation = d.numbers("aerosol_deviation", "1", 2.0)
                            .range(1.01, 10.0)
                            .when(with_modes)
                            .doc("geometric standard deviation of each mode");
    aerosol_kappa = d.numbers("aerosol_hygroscopicity", "1", 0.61)
                        .range(1e-3, 2.0)
                        .when(with_modes)
                        .doc("kappa of each mode");
    aerosol_density = d.number("aerosol_air_density", "kg m-3", 1.2)
                          .range(1e-3, 10.0)
                          .doc("density of the air in which numbers per volume are given");
    twomey_coefficient = d.number("twomey_coefficient", "m-3", 1e8)
                             .range(0.0, 1e14)
                             .when(with_twomey)
                             .doc("C of N = C (100 s)^k");
    twomey_exponent = d.number("twomey_exponent", "1", 0.5)
                          .range(0.0, 5.0)
                          .when(with_twomey)
                          .doc("k; 0 gives C droplets to every cloud");
    twomey_limit = d.number("twomey_limit", "m-3", 1e10)
                       .range(0.0, 1e14)
                       .when(with_twomey)
                       .doc("largest number of nuclei");
    surface_tension = d.number("surface_tension", "N m-1", 0.072)
                          .range(1e-3, 1.0)
                          .when(with_modes)
                          .doc("of water against air");
  }

  template <class Get>
  MoistAir moist_air(const Get& get) const {
    MoistAir made;
    made.constants = air.constants([&](Param p) { return get.number(p); });
    made.formula = static_cast<thermo::SaturationFormula>(get.choice(air.saturation_pressure));
    made.measure = static_cast<HumidityMeasure>(get.choice(humidity));
    made.prescribed_temperature = get.choice(temperature) == 1;
    return made;
  }

  /// Errors  Failure(PILEUS_E_CONFIG) for lists of different length
  template <class Get>
  Aerosol nuclei(const Get& get, double gas_constant) const {
    const double per_mass = 1.0 / get.number(aerosol_density);
    const auto scheme = static_cast<ActivationScheme>(get.choice(activation));
    if (scheme == ActivationScheme::twomey) {
      return {get.number(twomey_coefficient) * per_mass, get.number(twomey_exponent),
              get.number(twomey_limit) * per_mass};
    }
    const auto number = get.list(aerosol_number), radius = get.list(aerosol_radius),
               deviation = get.list(aerosol_deviation), kappa = get.list(aerosol_kappa);
    if (radius.size() != number.size() || deviation.size() != number.size() ||
        kappa.size() != number.size()) {
      throw Failure(
          "aerosol_number, aerosol_radius, aerosol_deviation and aerosol_hygroscopicity differ in "
          "their number of values; give one value of each for every mode",
          PILEUS_E_CONFIG);
    }
    std::vector<AerosolMode> modes;
    for (std::size_t i = 0; i < number.size(); ++i)
      modes.push_back({number[i] * per_mass, radius[i], deviation[i], kappa[i]});
    return {scheme, std::move(modes), get.number(surface_tension), gas_constant};
  }

  template <class Get>
  CondensationOptions condensation(const Get& get) const {
    CondensationOptions options;
    options.embryo_radius = get.number(embryo_radius);
    options.substep_fraction = get.number(substep_fraction);
    options.spectrum = static_cast<Spectrum>(get.choice(spectrum));
    options.aerosol_carried = get.choice(aerosol) == 1;
    options.rain = get.choice(collection) != 0;
    return options;
  }
};

}  // namespace pileus::two_moment
