// The parameters of the droplets and what is built from them.
#pragma once
#include <pileus/air_parameters.hpp>
#include <pileus/moist_air.hpp>
#include <pileus/plugin.hpp>

#include <limits>
#include <vector>

#include "aerosol_sampling.hpp"
#include "condensation.hpp"
#include "droplet_quantities.hpp"

namespace pileus::superdroplets {

inline constexpr const char* in_moist_air = "thermodynamics == moist_air";
inline constexpr const char* condensing =
    "thermodynamics == moist_air and condensation == true and effect.condensation == on";
inline constexpr const char* with_condensation =
    "thermodynamics == moist_air and condensation == true";
inline constexpr const char* with_derived_buoyancy =
    "thermodynamics == moist_air and buoyancy == derived";
inline constexpr const char* on_aerosol = "spectrum == aerosol";
inline constexpr const char* of_drops = "spectrum == exponential_drops";
inline constexpr const char* with_peak =
    "thermodynamics == moist_air and condensation == true and largest_supersaturation == kept and "
    "effect.condensation == on";

struct Parameters {
  AirParameters air;
  Param thermodynamics, humidity, buoyancy, condensation, density;
  Param spectrum, number, radius, deviation, kappa, aerosol_density, drop_number, drop_radius;
  Param count, most, sampling, alpha, initial_humidity;
  Param surface_tension, mass_accommodation, heat_accommodation, kinetic, ventilation;
  Param tolerance, most_substeps, peak, rain_radius;

  void describe(Declaration& d) {
    thermodynamics = d.choice("thermodynamics", {"moist_air", "none"})
                         .doc("whether droplets have air to exchange vapour and heat with");
    condensation =
        d.toggle("condensation", true).when(in_moist_air).doc("growth and evaporation of droplets");
    buoyancy = d.choice("buoyancy", {"derived", "carried"})
                   .when(in_moist_air)
                   .doc("from temperature, vapour and loading, or left to the initial state");
    density = d.number("reference_density", "kg m-3", 1.2)
                  .range(1e-3, 10.0)
                  .doc("of the Boussinesq air: turns the volumes of parcels into masses");
    air.describe_constants(d);
    air.describe_real_air(d);
    humidity = d.choice("saturation_humidity", {"specific_humidity", "mixing_ratio"})
                   .doc("what vapour is measured by: per mass of moist or of dry air");
    describe_spectrum(d);
    describe_sampling(d);
    describe_growth(d);
    rain_radius = d.number("rain_radius", "m", 40e-6)
                      .range(1e-6, 1e-3)
                      .doc("droplets larger than this are counted as rain");
  }

  void describe_spectrum(Declaration& d) {
    spectrum = d.choice("spectrum", {"aerosol", "exponential_drops"})
                   .doc("what there is at the start: particles, or drops of pure water");
    number = d.numbers("aerosol_number", "m-3", 1e8)
                 .range(1.0, 1e14)
                 .when(on_aerosol)
                 .doc("particles of each lognormal mode");
    radius = d.numbers("aerosol_radius", "m", 5e-8)
                 .range(1e-9, 1e-5)
                 .when(on_aerosol)
                 .doc("geometric mean dry radius of each mode");
    deviation = d.numbers("aerosol_deviation", "1", 2.0)
                    .range(1.0, 10.0)
                    .when(on_aerosol)
                    .doc("geometric standard deviation of each mode; 1: all alike");
    kappa = d.numbers("aerosol_hygroscopicity", "1", 0.61)
                .range(0.0, 2.0)
                .when(on_aerosol)
                .doc("kappa of each mode");
    aerosol_density = d.number("aerosol_air_density", "kg m-3", 1.2)
                          .range(1e-3, 10.0)
                          .doc("density of the air in which numbers per volume are given");
    drop_number = d.number("drop_number", "m-3", 8388608.0)
                      .range(1e-6, 1e14)
                      .when(of_drops)
                      .doc("drops with exponentially distributed volumes");
    drop_radius = d.number("drop_mean_volume_radius", "m", 30.531e-6)
                      .range(1e-9, 5e-3)
                      .when(of_drops)
                      .doc("radius of a drop of their mean volume");
  }

  void describe_sampling(Declaration& d) {
    static constexpr double counts[] = {
        4, 8, 16, 32, 64, 128, std::numeric_limits<double>::quiet_NaN()};
    count =
        d.integer("superdroplets_per_parcel", 8).range(1, 1 << 22).knob(counts).doc("at the start");
    most =
        d.integer("most_per_parcel", 0)
            .range(0, 1e9)
            .doc(
                "lists that mergers or the fall of drops have made longer are shortened to this; "
                "0: twice as many as at the start");
    sampling = d.choice("sampling", {"alpha", "constant_multiplicity", "log_uniform"})
                   .doc("how sizes are chosen");
    alpha = d.number("sampling_alpha", "1", 0.7)
                .range(0.0, 1.0)
                .when("sampling == alpha")
                .doc("from strata of equal number (0) to strata of equal width in ln r (1)");
    initial_humidity = d.number("largest_initial_humidity", "1", 0.95)
                           .range(0.0, 2.0)
                           .when(on_aerosol)
                           .doc(
                               "relative humidity above which particles start with the water they "
                               "have there: nothing is activated by a start");
  }

  void describe_growth(Declaration& d) {
    surface_tension =
        d.number("surface_tension", "N m-1", 0.072).range(0.0, 1.0).doc("of water against air");
    mass_accommodation =
        d.number("mass_accommodation", "1", 1.0)
            .range(1e-3, 1.0)
            .doc("share of the vapour molecules that stay when they hit a droplet");
    heat_accommodation =
        d.number("heat_accommodation", "1", 1.0).range(1e-3, 1.0).doc("the same of heat");
    kinetic = d.toggle("kinetic_corrections", true).doc("free flight of molecules near a droplet");
    ventilation = d.toggle("ventilation", true).doc("faster exchange of falling drops");
    static constexpr double ladder[] = {
        0.1, 0.03, 0.01, 3e-3, 1e-3, 3e-4, std::numeric_limits<double>::quiet_NaN()};
    tolerance = d.number("tolerance", "1", 1e-2)
                    .range(1e-8, 1e3)
                    .knob(ladder)
                    .doc("of a sub-step, relative, of liquid water and supersaturation");
    most_substeps = d.integer("most_condensation_substeps", 1000)
                        .range(1, 1e9)
                        .doc("tried per step; the rest of the step is then taken at once");
    peak = d.choice("largest_supersaturation", {"forgotten", "kept"})
               .doc("whether parcels remember the largest supersaturation they have met");
  }

  template <class Get>
  DropletAir droplet_air(const Get& get) const {
    DropletAir made;
    made.air.constants = air.constants([&](Param p) { return get.number(p); });
    made.air.formula = static_cast<thermo::SaturationFormula>(get.choice(air.saturation_pressure));
    made.air.measure = static_cast<HumidityMeasure>(get.choice(humidity));
    made.accommodation = {get.number(mass_accommodation), get.number(heat_accommodation)};
    made.kinetic = get.number(kinetic) != 0;
    made.surface_tension = get.number(surface_tension);
    return made;
  }

  template <class Get>
  CondensationOptions options(const Get& get) const {
    CondensationOptions made;
    made.tolerance = get.number(tolerance);
    made.most_substeps = static_cast<int>(get.number(most_substeps));
    return made;
  }

  template <class Get>
  std::int64_t most_per_parcel(const Get& get) const {
    const double asked = get.number(most);
    return static_cast<std::int64_t>(asked > 0 ? asked : 2 * get.number(count));
  }

  /// Errors  Failure(PILEUS_E_CONFIG) for lists of different length, or more modes than droplets
  template <class Get>
  AerosolSampler sampler(const Get& get) const {
    SamplingOptions options;
    const int word = get.choice(sampling);
    options.method = word == 0   ? Sampling::alpha
                     : word == 1 ? Sampling::constant_multiplicity
                                 : Sampling::log_uniform;
    options.alpha = get.number(alpha);
    const auto wanted = static_cast<std::size_t>(get.number(count));
    const double per_mass = 1.0 / get.number(aerosol_density);
    if (get.choice(spectrum) == 1) {
      const double r = get.number(drop_radius);
      return {DropSpectrum{get.number(drop_number) * per_mass, volume_of_radius(r)}, wanted,
              options};
    }
    const auto numbers = get.list(number), radii = get.list(radius),
               deviations = get.list(deviation), kappas = get.list(kappa);
    if (radii.size() != numbers.size() || deviations.size() != numbers.size() ||
        kappas.size() != numbers.size()) {
      throw Failure(
          "aerosol_number, aerosol_radius, aerosol_deviation and aerosol_hygroscopicity differ in "
          "their number of values; give one value of each for every mode",
          PILEUS_E_CONFIG);
    }
    if (numbers.size() > wanted) {
      throw Failure(
          "there are more aerosol modes than superdroplets_per_parcel; every mode needs "
          "one at least",
          PILEUS_E_CONFIG);
    }
    std::vector<AerosolMode> modes;
    for (std::size_t i = 0; i < numbers.size(); ++i)
      modes.push_back({numbers[i] * per_mass, radii[i], deviations[i], kappas[i]});
    return {modes, wanted, options};
  }
};

}  // namespace pileus::superdroplets
